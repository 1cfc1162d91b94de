/* SPDX-License-Identifier: MIT */
#include "rtu.h"

#define CHARACTER 520u  /* us that a byte takes at least */
#define OVERHEAD 3u     /* bytes of a frame around function and data */

static void end_frame(struct cib_rtu *rtu)
{
    rtu->length = 0;
    rtu->check = MODBUS_CRC_START;
    rtu->untimed = false;
}

static void drop_until_silence(struct cib_rtu *rtu)
{
    rtu->counters.dropped++;
    rtu->skipping = true;
}

static bool is_own(const struct cib_rtu *rtu)
{
    return rtu->frame[0] == 0 || rtu->frame[0] == rtu->address;
}

/* Has the function of the frame, of which there are two bytes or more, no length of its own? */
static bool ends_in_silence(const struct cib_rtu *rtu)
{
    return modbus_request_length(rtu->frame, 2) == MODBUS_NO_LENGTH;
}

/* ---- Requests ----------------------------------------------------------------------------------------------------------- */

static void put_answer(struct cib_rtu *rtu, size_t length)
{
    rtu->answer[0] = rtu->address;
    rtu->answer_length = (uint16_t)modbus_append_crc(rtu->answer, length + 1u);
    rtu->answer_sent = 0;
}

/* The frame is a request for this unit. */
static void execute(struct cib_rtu *rtu, struct cib_unit *unit)
{
    const uint8_t *request = rtu->frame + 1;
    uint8_t unheard[MODBUS_PDU_MAX];
    size_t length = rtu->length - OVERHEAD;
    rtu->counters.requests++;
    rtu->waiting = false;
    cib_note_request(unit);
    if (rtu->frame[0] != 0)
        put_answer(rtu, cib_modbus(unit, request, length, rtu->answer + 1));
    else if (cib_modbus_writes(request[0]))
        (void)cib_modbus(unit, request, length, unheard);
    end_frame(rtu);
}

/* The frame is whole, and its check value right. */
static void take_request(struct cib_rtu *rtu, struct cib_unit *unit)
{
    if (rtu->answer_length > 0)
        rtu->waiting = true;
    else
        execute(rtu, unit);
}

/* As many bytes have come as the function says. Where bytes take time, units receive the answers of others, which must not be
 * taken for requests: frames for others end in silence there. */
static void end_by_length(struct cib_rtu *rtu, struct cib_unit *unit)
{
    if (!is_own(rtu) && !rtu->untimed)
        return;
    if (rtu->check != 0) {
        drop_until_silence(rtu);
    } else if (is_own(rtu)) {
        take_request(rtu, unit);
    } else {
        rtu->counters.others++;
        end_frame(rtu);
    }
}

static void end_by_silence(struct cib_rtu *rtu, struct cib_unit *unit)
{
    size_t length = rtu->length;
    bool is_right = length >= MODBUS_FRAME_MIN && rtu->check == 0;
    if (is_right && is_own(rtu) && ends_in_silence(rtu)) {
        take_request(rtu, unit);
        return;
    }
    if (is_right && !is_own(rtu))
        rtu->counters.others++;
    else
        rtu->counters.dropped++;
    end_frame(rtu);
}

uint64_t cib_rtu_due(const struct cib_rtu *rtu)
{
    return rtu->length > 0 && !rtu->waiting ? rtu->last + rtu->silence : CIB_NEVER;
}

void cib_rtu_check_silence(struct cib_rtu *rtu, struct cib_unit *unit)
{
    if (cib_rtu_due(rtu) > cib_now(unit))
        return;
    if (!rtu->skipping)
        end_by_silence(rtu, unit);
    else
        end_frame(rtu);
    rtu->skipping = false;
}

/* ---- Bytes -------------------------------------------------------------------------------------------------------------- */

static void append(struct cib_rtu *rtu, uint8_t byte, uint64_t now)
{
    if (rtu->length == 0)
        end_frame(rtu);
    else if (now - rtu->last < CHARACTER)
        rtu->untimed = true;
    rtu->frame[rtu->length++] = byte;
    rtu->check = modbus_crc_update(rtu->check, byte);
}

bool cib_rtu_receive(struct cib_rtu *rtu, struct cib_unit *unit, uint8_t byte)
{
    uint64_t now = cib_now(unit);
    cib_rtu_check_silence(rtu, unit);
    if (rtu->waiting)
        return false;
    if (!rtu->skipping && rtu->length == MODBUS_FRAME_MAX) {
        drop_until_silence(rtu);
    } else if (!rtu->skipping) {
        append(rtu, byte, now);
        size_t whole = modbus_request_length(rtu->frame, rtu->length);
        if (whole == rtu->length)
            end_by_length(rtu, unit);
        else if (whole == MODBUS_NO_LENGTH && !ends_in_silence(rtu))
            drop_until_silence(rtu);
    }
    rtu->last = now;
    return true;
}

bool cib_rtu_send(struct cib_rtu *rtu, struct cib_unit *unit, uint8_t *byte)
{
    cib_rtu_check_silence(rtu, unit);
    if (rtu->answer_length == 0)
        return false;
    *byte = rtu->answer[rtu->answer_sent++];
    if (rtu->answer_sent < rtu->answer_length)
        return true;
    rtu->answer_length = 0;
    rtu->counters.answers++;
    if (rtu->waiting)
        execute(rtu, unit);
    return true;
}
