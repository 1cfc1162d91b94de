/* SPDX-License-Identifier: MIT */
/* The servers of CIB modules for clients on TCP: modbus-tcp and plccoms. */
#include <string.h>

#include "cib_device.h"

#define OUT_SIZE 32768u /* bytes for one line of a client: a list of the variables of 16 modules */

/* What waits to be sent. */
struct out {
    size_t length, sent;
    uint8_t bytes[OUT_SIZE];
};

static void put_bytes(struct out *out, const void *bytes, size_t length)
{
    size_t room = sizeof out->bytes - out->length;
    length = length < room ? length : room;
    memcpy(out->bytes + out->length, bytes, length);
    out->length += length;
}

static size_t send_part(struct out *out, uint8_t *bytes, size_t room)
{
    size_t length = out->length - out->sent;
    length = length < room ? length : room;
    memcpy(bytes, out->bytes + out->sent, length);
    out->sent += length;
    if (out->sent == out->length)
        out->sent = out->length = 0;
    return length;
}

static struct cib_modules modules_of(const struct device_bus *bus)
{
    struct cib_modules modules = {.count = bus->units};
    for (unsigned i = 0; i < bus->units; i++) {
        modules.unit[i] = bus->unit[i] ? &cib_device_of(bus->unit[i])->unit : NULL;
        modules.address[i] = bus->node[i];
    }
    return modules;
}

/* ---- Modbus TCP --------------------------------------------------------------------------------------------------------- */

struct tcp_client {
    struct cib_tcp tcp;
    struct out out;
    bool is_over;
};

static void on_answer(void *context, const uint8_t *bytes, size_t length)
{
    put_bytes(context, bytes, length);
}

/* A byte at a time, so that each answer goes out before the next request is executed. */
static size_t receive_tcp(struct device_client *state, const struct device_bus *bus, const uint8_t *bytes, size_t length)
{
    struct tcp_client *client = (struct tcp_client *)state;
    const struct cib_modules modules = modules_of(bus);
    size_t taken = 0;
    while (taken < length && !client->is_over && client->out.length == 0)
        client->is_over = !cib_tcp_receive(&client->tcp, &modules, &bytes[taken++], 1, on_answer, &client->out);
    return taken;
}

static size_t send_tcp(struct device_client *state, const struct device_bus *bus, uint8_t *bytes, size_t room)
{
    (void)bus;
    return send_part(&((struct tcp_client *)state)->out, bytes, room);
}

static bool is_tcp_over(const struct device_client *state)
{
    return ((const struct tcp_client *)state)->is_over;
}

/* ---- PLCComS ------------------------------------------------------------------------------------------------------------ */

struct lines_client {
    struct cib_lines lines;
    struct out out;
    bool watches; /* cib_lines_watches() */
};

static void on_text(void *context, const char *text, size_t length)
{
    put_bytes(context, text, length);
}

/* A line at a time. */
static size_t receive_lines(struct device_client *state, const struct device_bus *bus, const uint8_t *bytes, size_t length)
{
    struct lines_client *client = (struct lines_client *)state;
    const struct cib_modules modules = modules_of(bus);
    const struct cib_lines_out out = {.put = on_text, .context = &client->out};
    const uint8_t *end = memchr(bytes, '\n', length);
    size_t taken = end ? (size_t)(end - bytes) + 1u : length;
    cib_lines_receive(&client->lines, &modules, bytes, taken, &out);
    if (end)
        client->watches = cib_lines_watches(&client->lines, &modules);
    return taken;
}

/* The end of tick 100 000 k is the beginning of the next one. */
static size_t send_lines(struct device_client *state, const struct device_bus *bus, uint8_t *bytes, size_t room)
{
    struct lines_client *client = (struct lines_client *)state;
    if (client->watches && client->out.length == 0 && bus->now % CIB_LINES_PERIOD == 1) {
        const struct cib_modules modules = modules_of(bus);
        cib_lines_report_changes(&client->lines, &modules, &(struct cib_lines_out){.put = on_text, .context = &client->out});
    }
    return send_part(&client->out, bytes, room);
}

static uint64_t next_of_lines(const struct device_client *state, const struct device_bus *bus)
{
    if (!((const struct lines_client *)state)->watches)
        return DEVICE_NEVER;
    return (bus->now + CIB_LINES_PERIOD - 1u) / CIB_LINES_PERIOD * CIB_LINES_PERIOD + 1u;
}

const struct device_service cib_services[] = {
    {.name = "modbus-tcp",
     .description = "Modbus TCP; the unit of a request is the module's address",
     .size = sizeof(struct tcp_client),
     .clients = DEVICE_CLIENTS_MAX,
     .receive = receive_tcp,
     .send = send_tcp,
     .is_over = is_tcp_over},
    {.name = "plccoms",
     .description = "lines of text as PLCComS has them: LIST, GET, SET, EN, DI, GETINFO",
     .size = sizeof(struct lines_client),
     .clients = DEVICE_CLIENTS_MAX,
     .refusal = "ERROR:11 Maximum connections reached.\r\n",
     .receive = receive_lines,
     .send = send_lines,
     .next = next_of_lines},
    {.name = NULL},
};
