/* SPDX-License-Identifier: MIT */
#include "modbus_framing.h"

#include <string.h>

#include "modbus/modbus.h"

#define HEAD 1u /* bytes before the message: the address */
#define CRC 2u  /* bytes after it */

/* The silence ends the frame, not a byte. */
static bool gather_byte(struct rkm04_receiver *receiver, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    receiver->last = now;
    if (receiver->length < room && receiver->length < MODBUS_FRAME_MAX)
        buffer[receiver->length++] = byte;
    else
        receiver->too_long++;
    return false;
}

bool modbus_end(struct rkm04_receiver *receiver, uint8_t *buffer, bool answer)
{
    uint32_t length = receiver->length;
    bool is_short = length < MODBUS_FRAME_MIN, is_frame = receiver->too_long == 0 && modbus_is_frame(buffer, length);
    (void)answer; /* both begin with the address of the unit */
    receiver->malformed += is_short;
    receiver->bad_check += !is_short && !is_frame && receiver->too_long == 0;
    if (!is_frame)
        return false;
    receiver->dnode = buffer[0];
    receiver->length = length - HEAD - CRC;
    memmove(buffer, buffer + HEAD, receiver->length);
    return true;
}

size_t modbus_begin_frame(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out)
{
    (void)length;
    out[0] = answer ? snode : dnode;
    sender->check = modbus_crc_update(MODBUS_CRC_START, out[0]);
    return HEAD;
}

size_t modbus_put_byte(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    sender->check = modbus_crc_update(sender->check, byte);
    out[0] = byte;
    return 1;
}

size_t modbus_end_frame(struct rkm04_sender *sender, uint8_t *out)
{
    out[0] = (uint8_t)sender->check;
    out[1] = (uint8_t)(sender->check >> 8);
    return CRC;
}

const struct rkm04_framing modbus_link = {
    .name = "modbus", .receive = gather_byte, .begin = modbus_begin_frame, .put = modbus_put_byte, .end = modbus_end_frame};
