/* SPDX-License-Identifier: MIT */
/* Set Command, the RKM04's message with a program (P1, P2). */
#include <stdio.h>

#include "rkm04_device.h"

#define SET_COMMAND 2
#define HEAD 2           /* bytes: the message, and the motor as a digit */
#define ANSWER_LENGTH 4u /* bytes: the same two, the flag, the character */

enum { OK, BAD_VALUE, UNKNOWN_COMMAND, OVERFLOWED };

static void begin(uint8_t *message, unsigned motor)
{
    message[0] = SET_COMMAND;
    message[1] = (uint8_t)('0' + motor);
}

static int flag_of(const uint8_t *message, const uint8_t *answer, size_t length)
{
    return length == ANSWER_LENGTH && answer[0] == SET_COMMAND && answer[1] == message[1] ? answer[HEAD] : -1;
}

static bool explain(const uint8_t *answer, char text[DEVICE_ERROR_SIZE])
{
    static const char *const meanings[] = {"ok", "bad value", "unknown command", "memory has overflowed"};
    const unsigned flag = answer[HEAD], character = answer[HEAD + 1];
    const char *meaning = flag <= OVERFLOWED ? meanings[flag] : "?";
    if (flag != BAD_VALUE && flag != UNKNOWN_COMMAND)
        snprintf(text, DEVICE_ERROR_SIZE, "%s", meaning);
    else if (character >= 0x20 && character < 0x7F)
        snprintf(text, DEVICE_ERROR_SIZE, "%s '%c'", meaning, (int)character);
    else
        snprintf(text, DEVICE_ERROR_SIZE, "%s, character %02X", meaning, character);
    return flag == BAD_VALUE || flag == UNKNOWN_COMMAND;
}

const struct device_program_message rkm04_program_message = {
    .head = HEAD, .flags = OVERFLOWED, .begin = begin, .flag = flag_of, .explain = explain};
