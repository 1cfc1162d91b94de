/* SPDX-License-Identifier: MIT */
/* Frames of Modbus RTU as a host or a monitor finds and makes them: each is over as soon as its check value is right and its
 * length is one that its function has, as a request or as an answer, or its function is unknown; so it is found where time is
 * stopped, too. */
#include <string.h>

#include "cib_device.h"
#include "modbus_framing.h"

static bool is_whole(const uint8_t *frame, size_t length)
{
    size_t request = modbus_request_length(frame, length), answer = modbus_answer_length(frame, length);
    return length == request || length == answer || (request == MODBUS_NO_LENGTH && answer == MODBUS_NO_LENGTH);
}

/* Leave the content of the frame in the buffer. */
static void unpack(struct rkm04_receiver *receiver, uint8_t *buffer)
{
    receiver->dnode = buffer[0];
    receiver->snode = 0;
    receiver->length -= 3u; /* address, check value */
    memmove(buffer, buffer + 1, receiver->length);
    receiver->phase = 0;
}

static bool receive(struct rkm04_receiver *receiver, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    if (receiver->phase != 0 && now - receiver->last >= CIB_SILENCE) {
        receiver->malformed++;
        receiver->phase = 0;
    }
    receiver->last = now;
    if (receiver->phase == 0) {
        receiver->length = 0;
        receiver->check = MODBUS_CRC_START;
        receiver->phase = 1;
    }
    if (receiver->length == room) {
        receiver->too_long++;
        receiver->phase = 0;
        return false;
    }
    buffer[receiver->length++] = byte;
    receiver->check = modbus_crc_update(receiver->check, byte);
    if (receiver->check != 0 || receiver->length < MODBUS_FRAME_MIN || !is_whole(buffer, receiver->length))
        return false;
    unpack(receiver, buffer);
    return true;
}

static const struct rkm04_framing link = {.name = "modbus-rtu",
                                          .receive = receive,
                                          .begin = modbus_begin_frame,
                                          .put = modbus_put_byte,
                                          .end = modbus_end_frame};

const struct device_framing cib_framing = {.link = &link, .flag = -1, .escape = -1, .silence = CIB_SILENCE};
