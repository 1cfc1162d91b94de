/* SPDX-License-Identifier: MIT */
#include "tcp.h"

#define ANY_UNIT 255u

/* The module that is meant. NULL: there is none, or it has no power. */
static struct cib_unit *find_module(const struct cib_modules *modules, uint8_t address)
{
    if ((address == 0 || address == ANY_UNIT) && modules->count == 1)
        return modules->unit[0];
    for (unsigned i = 0; i < modules->count; i++)
        if (modules->address[i] == address && modules->unit[i])
            return modules->unit[i];
    return NULL;
}

static void execute(struct cib_tcp *tcp, const struct cib_modules *modules, cib_tcp_out *out, void *context)
{
    uint8_t answer[MODBUS_TCP_MAX];
    const uint8_t *request = tcp->request.frame + MODBUS_TCP_HEAD;
    struct cib_unit *unit = find_module(modules, tcp->request.frame[MODBUS_TCP_UNIT]);
    size_t length;
    if (unit) {
        cib_note_request(unit);
        length = cib_modbus(unit, request, tcp->request.length - MODBUS_TCP_HEAD, answer + MODBUS_TCP_HEAD);
    } else {
        length = modbus_put_exception(answer + MODBUS_TCP_HEAD, request[0], MODBUS_NO_TARGET);
    }
    out(context, answer, modbus_tcp_answer(&tcp->request, answer, length));
}

bool cib_tcp_receive(struct cib_tcp *tcp, const struct cib_modules *modules, const uint8_t *bytes, size_t length,
                     cib_tcp_out *out, void *context)
{
    for (size_t i = 0; i < length; i++) {
        const enum modbus_tcp_result result = modbus_tcp_take(&tcp->request, bytes[i]);
        if (result == MODBUS_TCP_WRONG)
            return false;
        if (result == MODBUS_TCP_WHOLE)
            execute(tcp, modules, out, context);
    }
    return true;
}
