/* SPDX-License-Identifier: MIT */
#include "modbus.h"

#define PROTOCOL 2u /* where it is in the head */
#define LENGTH 4u

/* Can what has come so far be the begin of a request? */
static bool is_plausible(const struct modbus_tcp *tcp)
{
    unsigned length = tcp->length >= MODBUS_TCP_UNIT ? modbus_word(tcp->frame + LENGTH) : 2u;
    return (tcp->length < LENGTH || modbus_word(tcp->frame + PROTOCOL) == 0) && length >= 2u && length <= MODBUS_PDU_MAX + 1u;
}

enum modbus_tcp_result modbus_tcp_take(struct modbus_tcp *tcp, uint8_t byte)
{
    tcp->frame[tcp->length++] = byte;
    if (!is_plausible(tcp))
        return MODBUS_TCP_WRONG;
    if (tcp->length < MODBUS_TCP_HEAD || tcp->length < MODBUS_TCP_UNIT + modbus_word(tcp->frame + LENGTH))
        return MODBUS_TCP_MORE;
    return MODBUS_TCP_WHOLE;
}

size_t modbus_tcp_answer(struct modbus_tcp *tcp, uint8_t answer[MODBUS_TCP_MAX], size_t length)
{
    for (unsigned i = 0; i < MODBUS_TCP_HEAD; i++)
        answer[i] = tcp->frame[i];
    modbus_put_word(answer + LENGTH, (uint16_t)(length + 1u));
    tcp->length = 0;
    return length + MODBUS_TCP_HEAD;
}
