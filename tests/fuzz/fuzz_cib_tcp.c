/* SPDX-License-Identifier: MIT */
/* fuzz_cib_tcp.c: any bytes of a Modbus TCP client to two CIB modules. Each answer has the head of its request and its own
 * length; what comes in pieces is answered as what comes at once. First byte: the size of the pieces. */
#include <string.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "fuzz.h"

#define OUT_MAX (1u << 20)

struct server {
    struct cib_unit unit[2];
    struct cib_modules modules;
    struct cib_tcp tcp;
    bool open;
    size_t length;
    uint8_t out[OUT_MAX];
};

static const struct cib_port nobody;
static struct server whole, pieces;

static void power_up(struct server *server)
{
    memset(&server->tcp, 0, sizeof server->tcp);
    server->open = true;
    server->length = 0;
    server->modules = (struct cib_modules){.count = 2, .unit = {&server->unit[0], &server->unit[1]}, .address = {1, 2}};
    for (unsigned i = 0; i < 2; i++)
        cib_begin(&server->unit[i], &cib_default_config, &nobody, NULL);
}

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    struct server *server = context;
    FUZZ_CHECK(length > MODBUS_TCP_HEAD && length <= MODBUS_TCP_MAX, "%zu bytes", length);
    FUZZ_CHECK(modbus_word(bytes + 2) == 0 && modbus_word(bytes + 4) == length - 6u, "a wrong head");
    const uint8_t *head = server->tcp.request.frame;
    FUZZ_CHECK(memcmp(bytes, head, 4) == 0 && bytes[6] == head[6], "another request's head");
    length = server->length + length <= OUT_MAX ? length : 0;
    memcpy(server->out + server->length, bytes, length);
    server->length += length;
}

static void receive(struct server *server, const uint8_t *bytes, size_t length)
{
    if (server->open)
        server->open = cib_tcp_receive(&server->tcp, &server->modules, bytes, length, hear, server);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz fuzz = {data, size};
    size_t piece = fuzz_byte(&fuzz) + 1u;
    power_up(&whole);
    power_up(&pieces);
    receive(&whole, fuzz.at, fuzz.left);
    while (fuzz.left > 0) {
        size_t length;
        const uint8_t *bytes = fuzz_take(&fuzz, piece, &length);
        receive(&pieces, bytes, length);
    }
    FUZZ_CHECK(whole.open == pieces.open && whole.length == pieces.length && memcmp(whole.out, pieces.out, whole.length) == 0,
               "pieces of %zu", piece);
    return 0;
}
