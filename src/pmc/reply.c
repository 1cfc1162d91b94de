/* SPDX-License-Identifier: MIT */
#include "reply.h"

#define MS PMC_SLOT_TICKS

const uint32_t pmc_bauds[] = {9600, 19200, 38400, 57600, 115200, 0};

uint32_t pmc_baud(const struct pmc_unit *unit)
{
    return unit->config.baud != 0 ? unit->config.baud : PMC_BAUD;
}

void pmc_reply_begin(struct pmc_unit *unit, size_t length)
{
    struct pmc_reply *reply = &unit->face.reply;
    if (length == 0)
        return;
    reply->from = pmc_now(unit) + (reply->has_answered ? 0 : (uint64_t)unit->config.first_answer_late * MS); /* AS6 */
    reply->has_answered = true;
    reply->length = (uint16_t)length;
    reply->sent = 0;
}

size_t pmc_reply_take(struct pmc_unit *unit, const uint8_t *answer, uint8_t *bytes, size_t room)
{
    struct pmc_reply *reply = &unit->face.reply;
    size_t taken = 0;
    if (pmc_now(unit) < reply->from)
        return 0;
    while (taken < room && reply->sent < reply->length)
        bytes[taken++] = answer[reply->sent++];
    if (reply->length > 0 && reply->sent == reply->length) {
        reply->length = reply->sent = 0;
        reply->counters.answers++;
    }
    return taken;
}

static bool is_modbus(const struct pmc_unit *unit)
{
    return unit->config.face == &pmc_modbus_face;
}

size_t pmc_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    return is_modbus(unit) ? pmc_modbus_exchange(unit, message, length, answer, room)
                           : pmc_ascii_exchange(unit, message, length, answer, room);
}

void pmc_lose_byte(struct pmc_unit *unit)
{
    if (is_modbus(unit))
        pmc_modbus_lose_byte(unit);
    else
        pmc_ascii_lose_byte(unit);
}
