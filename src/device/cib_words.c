/* SPDX-License-Identifier: MIT */
/* Messages of a CIB module, which are Modbus, in words; and where they begin and end on the bus. */
#include "cib_device.h"
#include "text/text.h"

#define EXCEPTION_LENGTH 2u

static const char *function_name(uint8_t function)
{
    switch (function) {
    case MODBUS_READ_COILS:
        return "read coils";
    case MODBUS_READ_DISCRETE:
        return "read discrete inputs";
    case MODBUS_READ_HOLDING:
        return "read holding registers";
    case MODBUS_READ_INPUT:
        return "read input registers";
    case MODBUS_WRITE_COIL:
        return "write coil";
    case MODBUS_WRITE_HOLDING:
        return "write register";
    case MODBUS_WRITE_COILS:
        return "write coils";
    case MODBUS_WRITE_REGISTERS:
        return "write registers";
    default:
        return "unknown function";
    }
}

static void put_hex_word(struct wire_text *out, const uint8_t *word)
{
    static const char digits[] = "0123456789ABCDEF";
    unsigned value = modbus_word(word);
    bool begun = false;
    for (int shift = 12; shift >= 0; shift -= 4) {
        unsigned digit = value >> shift & 15u;
        begun = begun || digit != 0 || shift == 0;
        if (begun)
            wire_text_put(out, digits[digit]);
    }
    wire_text_put(out, 'H');
}

/* Words, decimal: " 1 102 0 3000". */
static void put_words(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    for (size_t at = 0; at + 1u < length; at += 2) {
        wire_text_put(out, ' ');
        wire_text_number(out, modbus_word(bytes + at), 0);
    }
}

static void put_request(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (length < 5)
        return;
    wire_text_put(out, ' ');
    put_hex_word(out, message + 1);
    if (message[0] <= MODBUS_READ_INPUT || message[0] >= MODBUS_WRITE_COILS) {
        wire_text_string(out, ", ");
        wire_text_number(out, modbus_word(message + 3), 0);
    }
    if (message[0] == MODBUS_WRITE_COIL || message[0] == MODBUS_WRITE_HOLDING || message[0] >= MODBUS_WRITE_COILS)
        wire_text_put(out, ':');
    if (message[0] == MODBUS_WRITE_COIL || message[0] == MODBUS_WRITE_HOLDING)
        put_words(out, message + 3, 2);
    else if (message[0] == MODBUS_WRITE_REGISTERS && length > 6)
        put_words(out, message + 6, length - 6);
    else if (message[0] == MODBUS_WRITE_COILS && length > 6) {
        wire_text_put(out, ' ');
        wire_text_hex(out, message + 6, length - 6);
    }
}

static void put_message(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    uint8_t function = message[0] & 0x7fu;
    bool is_refusal = is_answer && (message[0] & MODBUS_IS_EXCEPTION) != 0;
    wire_text_number(out, is_refusal ? function : message[0], 0);
    wire_text_put(out, ' ');
    wire_text_string(out, function_name(is_refusal ? function : message[0]));
    if (is_refusal && length == EXCEPTION_LENGTH) {
        wire_text_string(out, ", exception ");
        wire_text_number(out, message[1], 0);
    } else if (!is_answer) {
        put_request(out, message, length);
    } else if (message[0] == MODBUS_READ_HOLDING || message[0] == MODBUS_READ_INPUT) {
        put_words(out, message + 2, length < 2 ? 0 : length - 2);
    } else if (message[0] == MODBUS_READ_COILS || message[0] == MODBUS_READ_DISCRETE) {
        wire_text_put(out, ' ');
        wire_text_hex(out, message + 2, length < 2 ? 0 : length - 2);
    }
}

static void put_refusal(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (length != EXCEPTION_LENGTH || (message[0] & MODBUS_IS_EXCEPTION) == 0)
        return;
    if (message[1] == MODBUS_ILLEGAL_FUNCTION)
        wire_text_string(out, "the module has no such function");
    else if (message[1] == MODBUS_ILLEGAL_ADDRESS)
        wire_text_string(out, "the module has no such register");
    else if (message[1] == MODBUS_ILLEGAL_VALUE)
        wire_text_string(out, "a number or value is out of range");
}

static void put_ignored(struct wire_text *out, uint8_t dnode, uint8_t snode, const uint8_t *message, size_t length)
{
    (void)snode;
    (void)length;
    if (dnode == 0 && !cib_modbus_writes(message[0]))
        wire_text_string(out, "a read to all modules, which none answers");
}

const struct device_words cib_words = {.message = put_message, .refusal = put_refusal, .ignored = put_ignored};
