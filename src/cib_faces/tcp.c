/* SPDX-License-Identifier: MIT */
#include "tcp.h"

#define PROTOCOL 2u /* where it is in the head */
#define LENGTH 4u
#define UNIT 6u
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

static void execute(const struct cib_tcp *tcp, const struct cib_modules *modules, cib_tcp_out *out, void *context)
{
    uint8_t answer[CIB_TCP_MAX];
    const uint8_t *request = tcp->frame + CIB_TCP_HEAD;
    struct cib_unit *unit = find_module(modules, tcp->frame[UNIT]);
    size_t length;
    if (unit) {
        cib_note_request(unit);
        length = cib_modbus(unit, request, tcp->length - CIB_TCP_HEAD, answer + CIB_TCP_HEAD);
    } else {
        length = modbus_put_exception(answer + CIB_TCP_HEAD, request[0], MODBUS_NO_TARGET);
    }
    for (unsigned i = 0; i < CIB_TCP_HEAD; i++)
        answer[i] = tcp->frame[i];
    modbus_put_word(answer + LENGTH, (uint16_t)(length + 1u));
    out(context, answer, length + CIB_TCP_HEAD);
}

/* Can what has come so far be the begin of a request? */
static bool is_plausible(const struct cib_tcp *tcp)
{
    unsigned length = tcp->length >= UNIT ? modbus_word(tcp->frame + LENGTH) : 2u;
    return (tcp->length < LENGTH || modbus_word(tcp->frame + PROTOCOL) == 0) && length >= 2u && length <= CIB_PDU_MAX + 1u;
}

bool cib_tcp_receive(struct cib_tcp *tcp, const struct cib_modules *modules, const uint8_t *bytes, size_t length,
                     cib_tcp_out *out, void *context)
{
    for (size_t i = 0; i < length; i++) {
        tcp->frame[tcp->length++] = bytes[i];
        if (!is_plausible(tcp))
            return false;
        if (tcp->length < CIB_TCP_HEAD || tcp->length < UNIT + modbus_word(tcp->frame + LENGTH))
            continue;
        execute(tcp, modules, out, context);
        tcp->length = 0;
    }
    return true;
}
