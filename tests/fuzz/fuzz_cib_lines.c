/* SPDX-License-Identifier: MIT */
/* fuzz_cib_lines.c: any bytes of a PLCComS client to two CIB modules. Every line of an answer has one of the known heads and ends
 * with CR LF; what comes in pieces is answered as what comes at once. First byte: the size of the pieces. */
#include <string.h>

#include "cib/cib.h"
#include "cib_faces/cib_faces.h"
#include "fuzz.h"

#define OUT_MAX (1u << 20)

struct server {
    struct cib_unit unit[2];
    struct cib_modules modules;
    struct cib_lines lines;
    size_t length;
    char out[OUT_MAX];
};

static const struct cib_port nobody;
static struct server whole, pieces;

static void power_up(struct server *server)
{
    memset(&server->lines, 0, sizeof server->lines);
    server->length = 0;
    server->modules = (struct cib_modules){.count = 2, .unit = {&server->unit[0], &server->unit[1]}, .address = {1, 247}};
    for (unsigned i = 0; i < 2; i++)
        cib_begin(&server->unit[i], &cib_default_config, &nobody, NULL);
}

static void hear(void *context, const char *text, size_t length)
{
    struct server *server = context;
    length = server->length + length < OUT_MAX ? length : 0;
    memcpy(server->out + server->length, text, length);
    server->length += length;
}

static void receive(struct server *server, const uint8_t *bytes, size_t length)
{
    const struct cib_lines_out out = {.put = hear, .context = server};
    cib_lines_receive(&server->lines, &server->modules, bytes, length, &out);
}

/* Ticks go by, and changes are reported at their end. */
static void advance(struct server *server)
{
    for (unsigned i = 0; i < 2; i++)
        cib_advance(&server->unit[i], CIB_LINES_PERIOD);
    cib_lines_report_changes(&server->lines, &server->modules, &(struct cib_lines_out){.put = hear, .context = server});
}

static void check_heads(const struct server *server)
{
    static const char *const heads[] = {"GET:", "LIST:", "DIFF:", "GETINFO:", "WARNING:252 ", "ERROR:"};
    for (size_t at = 0, end; at < server->length; at = end + 1) {
        const char *line = server->out + at;
        const char *stop = memchr(line, '\n', server->length - at);
        bool known = false;
        FUZZ_CHECK(stop && stop[-1] == '\r', "a line without its end");
        end = at + (size_t)(stop - line);
        for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
            known = known || strncmp(line, heads[i], strlen(heads[i])) == 0;
        FUZZ_CHECK(known, "%.40s", line);
    }
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
    advance(&whole);
    advance(&pieces);
    FUZZ_CHECK(whole.length == pieces.length && memcmp(whole.out, pieces.out, whole.length) == 0, "pieces of %zu", piece);
    if (whole.length + CIB_LINE_MAX < OUT_MAX)
        check_heads(&whole);
    return 0;
}
