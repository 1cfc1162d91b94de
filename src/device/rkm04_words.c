/* SPDX-License-Identifier: MIT */
/* Messages of an RKM04 (specification section 3) in words, for people. */
#include <string.h>

#include "rkm04_device.h"
#include "text/text.h"

#define HEAD 2 /* bytes before what is particular to a message with a motor */
#define UNKNOWN 255
#define ERROR_TEXT "ERROR COMMAND! "

static const char *const message_names[] = {
    "",
    "Version",
    "Set Command",
    "Store Flash",
    "Get Position",
    "Get Command",
    "Get Tabul Run",
    "Get Pozic Run",
};
enum { VERSION = 1, SET_COMMAND, STORE_FLASH, GET_POSITION, GET_COMMAND, GET_TABLE, GET_PROGRESS, MESSAGES };

/* A character as it would be typed, for messages about it: 'a', or <0A>. */
static void put_character(struct wire_text *out, uint8_t character)
{
    wire_text_put(out, '\'');
    wire_text_bytes(out, &character, 1);
    wire_text_put(out, '\'');
}

static void put_quoted(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    wire_text_put(out, '"');
    wire_text_bytes(out, bytes, length);
    wire_text_put(out, '"');
}

/* Bytes that should not be there. */
static void put_rest(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    if (length == 0)
        return;
    wire_text_string(out, ", and ");
    wire_text_hex(out, bytes, length);
}

static void put_name(struct wire_text *out, const uint8_t *message, size_t length)
{
    wire_text_number(out, message[0], 0);
    wire_text_put(out, ' ');
    wire_text_string(out, message_names[message[0]]);
    if (message[0] == VERSION)
        return;
    wire_text_string(out, length < HEAD ? " without motor" : " m");
    wire_text_bytes(out, message + 1, length < HEAD ? 0 : 1);
}

static void put_unknown(struct wire_text *out, const uint8_t *message, size_t length)
{
    wire_text_number(out, message[0], 0);
    wire_text_string(out, " unknown message");
    put_rest(out, message + 1, length - 1);
}

static void put_request(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (message[0] == 0 || message[0] >= MESSAGES) {
        put_unknown(out, message, length);
        return;
    }
    size_t head = message[0] == VERSION || length < HEAD ? 1 : HEAD;
    put_name(out, message, length);
    if (message[0] != SET_COMMAND) {
        put_rest(out, message + head, length - head);
    } else if (length >= HEAD) {
        wire_text_put(out, ' ');
        put_quoted(out, message + HEAD, length - HEAD);
    }
}

/* Fields of a length byte and a number, right-aligned: the numbers. */
static void put_fields(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    for (size_t at = 0; at < length;) {
        size_t end = at + 1u + bytes[at];
        if (end > length) {
            put_rest(out, bytes + at, length - at);
            return;
        }
        if (at > 0)
            wire_text_put(out, ' ');
        at++;
        while (at < end && bytes[at] == ' ')
            at++;
        wire_text_bytes(out, bytes + at, end - at);
        at = end;
    }
}

static bool is_error_text(const uint8_t *bytes, size_t length)
{
    return length == strlen(ERROR_TEXT) && memcmp(bytes, ERROR_TEXT, length) == 0;
}

/* What follows the head of an answer. */
static void put_content(struct wire_text *out, uint8_t number, const uint8_t *bytes, size_t length)
{
    if (number == SET_COMMAND && length == 2) {
        wire_text_string(out, "flag ");
        wire_text_number(out, bytes[0], 0);
        if (bytes[0] == 1 || bytes[0] == 2) {
            wire_text_put(out, ' ');
            put_character(out, bytes[1]);
        }
    } else if (number == STORE_FLASH && length == 1) {
        wire_text_string(out, bytes[0] == 0 ? "written" : "error ");
        if (bytes[0] != 0)
            wire_text_number(out, bytes[0], 0);
    } else if (number == SET_COMMAND || number == STORE_FLASH) {
        wire_text_hex(out, bytes, length);
    } else if (is_error_text(bytes, length)) {
        wire_text_bytes(out, bytes, length - 1);
    } else if (number == GET_POSITION) {
        put_fields(out, bytes, length);
    } else if (number == GET_COMMAND) {
        put_quoted(out, bytes, length);
    } else {
        size_t blanks = length > 0 && bytes[0] == ' ' ? 1 : 0;
        wire_text_bytes(out, bytes + blanks, length - blanks);
    }
}

static void put_answer(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (message[0] == UNKNOWN && length >= 2) {
        wire_text_number(out, UNKNOWN, 0);
        wire_text_string(out, " unknown message ");
        wire_text_number(out, message[1], 0);
        return;
    }
    if (message[0] == 0 || message[0] >= MESSAGES) {
        put_unknown(out, message, length);
        return;
    }
    put_name(out, message, length);
    wire_text_string(out, " -> ");
    if (message[0] == VERSION && length >= HEAD && length == HEAD + (size_t)message[1])
        put_quoted(out, message + HEAD, length - HEAD);
    else if (message[0] == VERSION)
        wire_text_hex(out, message + 1, length - 1);
    else if (length >= HEAD)
        put_content(out, message[0], message + HEAD, length - HEAD);
}

static void put_message(struct wire_text *out, const uint8_t *message, size_t length, bool answer)
{
    if (answer)
        put_answer(out, message, length);
    else
        put_request(out, message, length);
}

/* ---- Refusals ------------------------------------------------------------------------------------------------------- */

/* Returns whether it was the motor. */
static bool refuse_motor(struct wire_text *out, uint8_t motor)
{
    if (motor >= '0' && motor <= '0' + RKM04_MOTORS)
        return false;
    wire_text_string(out, "there is no motor ");
    put_character(out, motor);
    return true;
}

static void refuse_command(struct wire_text *out, uint8_t motor, uint8_t flag, uint8_t character)
{
    if (flag == 1 && character == 0) {
        wire_text_string(out, "no motor was given");
    } else if (flag == 1 && !refuse_motor(out, motor)) {
        wire_text_string(out, "bad value after ");
        put_character(out, character);
    } else if (flag == 2) {
        wire_text_string(out, "unknown command ");
        put_character(out, character);
    } else if (flag == 3) {
        wire_text_string(out, "program memory overflowed");
    } else if (flag > 3) {
        wire_text_string(out, "flag ");
        wire_text_number(out, flag, 0);
    }
}

static void put_refusal(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (length >= 2 && message[0] == UNKNOWN) {
        wire_text_string(out, "there is no message ");
        wire_text_number(out, message[1], 0);
    } else if (length == HEAD + 2 && message[0] == SET_COMMAND) {
        refuse_command(out, message[1], message[HEAD], message[HEAD + 1]);
    } else if (length == HEAD + 1 && message[0] == STORE_FLASH && message[HEAD] != 0) {
        if (!refuse_motor(out, message[1]))
            wire_text_string(out, "the program could not be written to flash");
    } else if (length >= HEAD && message[0] >= GET_POSITION && message[0] <= GET_PROGRESS &&
               is_error_text(message + HEAD, length - HEAD)) {
        if (!refuse_motor(out, message[1]))
            wire_text_string(out, "expected one motor, 1 to 4");
    }
}

static void put_ignored(struct wire_text *out, uint8_t dnode, uint8_t snode, const uint8_t *message, size_t length)
{
    (void)length;
    if (snode >= 1 && snode <= RKM04_NODE_MAX)
        wire_text_string(out, "by its sender's address it is the answer of a unit (L1)");
    else if (dnode == 0 && message[0] != SET_COMMAND && message[0] != STORE_FLASH)
        wire_text_string(out, "a request to all units is not answered (P10)");
}

const struct device_words rkm04_device_words = {.message = put_message, .refusal = put_refusal, .ignored = put_ignored};
