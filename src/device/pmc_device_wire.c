/* SPDX-License-Identifier: MIT */
/* Messages of a PMC on the wires: their bytes, and what they mean, for people. */
#include <string.h>

#include "modbus/modbus.h"
#include "modbus_framing.h"
#include "pmc_device.h"
#include "text/text.h"

#define ADDRESS 1 /* lines have none: they are for the unit, whatever its address */
#define END '\r'

/* ---- Lines -------------------------------------------------------------------------------------------------------------- */

/* Control characters are no part of a line (AS1). */
static bool receive_character(struct rkm04_receiver *receiver, uint8_t byte, uint64_t now, uint8_t *buffer, size_t room)
{
    receiver->last = now;
    if (receiver->phase == 0)
        receiver->length = 0;
    receiver->phase = byte != END;
    receiver->dnode = ADDRESS;
    if (byte == END)
        return receiver->length > 0;
    if (byte >= ' ' && receiver->length < room)
        buffer[receiver->length++] = byte;
    return false;
}

static size_t begin_line(struct rkm04_sender *sender, uint8_t dnode, uint8_t snode, size_t length, bool answer, uint8_t *out)
{
    (void)sender;
    (void)dnode;
    (void)snode;
    (void)length;
    (void)answer;
    (void)out;
    return 0;
}

static size_t put_character(struct rkm04_sender *sender, uint8_t byte, uint8_t *out)
{
    (void)sender;
    out[0] = byte;
    return 1;
}

static size_t end_line(struct rkm04_sender *sender, uint8_t *out)
{
    return put_character(sender, END, out);
}

static const struct rkm04_framing line_link = {
    .name = "ascii", .receive = receive_character, .begin = begin_line, .put = put_character, .end = end_line};

#define MODBUS(us) {.link = &modbus_link, .flag = -1, .escape = -1, .silence = (us), .end = modbus_end}

const struct device_framing *pmc_framing(const struct device_config *config)
{
    static const struct device_framing lines = {.link = &line_link, .flag = -1, .escape = -1};
    static const struct device_framing modbus_9600 = MODBUS(3646), modbus_19200 = MODBUS(1823), modbus_fast = MODBUS(1750);
    const struct pmc_own own = pmc_own_of(config);
    if (!own.is_modbus)
        return &lines;
    if (own.baud <= PMC_BAUD)
        return &modbus_9600;
    return own.baud <= 19200u ? &modbus_19200 : &modbus_fast;
}

/* ---- Words -------------------------------------------------------------------------------------------------------------- */

static void put_hex_word(struct wire_text *out, uint16_t word)
{
    for (unsigned shift = 16; shift > 0;) {
        shift -= 4;
        wire_text_put(out, "0123456789ABCDEF"[(unsigned)word >> shift & 15u]);
    }
}

static void put_words(struct wire_text *out, const uint8_t *bytes, size_t length)
{
    for (size_t at = 0; at + 1 < length; at += 2) {
        wire_text_put(out, ' ');
        put_hex_word(out, modbus_word(bytes + at));
    }
}

/* What a write of the command register asks for. */
static void put_command(struct wire_text *out, uint8_t code)
{
    static const char *const names[] = {[0x01] = "continuous move", [0x04] = "choose a speed", [0x05] = "stop",
                                        [0x06] = "home search", [0x07] = "run the program", [0x08] = "end the program",
                                        [0x09] = "clear errors", [0x0A] = "clear counters", [0x0B] = "store", [0x0C] = "reset"};
    if (code < sizeof names / sizeof *names && names[code]) {
        wire_text_string(out, ": ");
        wire_text_string(out, names[code]);
    }
}

static void put_block(struct wire_text *out, uint8_t code)
{
    wire_text_string(out, code == 0x71 ? ": move to" : code == 0x72 ? ": move by" : code == 0x61 ? ": speeds" : "");
}

static void put_read(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    wire_text_string(out, message[0] == MODBUS_READ_INPUT ? "input registers" : "holding registers");
    if (is_answer) {
        put_words(out, message + 2, length > 2 ? length - 2 : 0);
        return;
    }
    wire_text_put(out, ' ');
    put_hex_word(out, modbus_word(message + 1));
    wire_text_string(out, " x ");
    wire_text_number(out, modbus_word(message + 3), 0);
}

static void put_write(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    bool is_block = message[0] == MODBUS_WRITE_REGISTERS;
    uint16_t address = modbus_word(message + 1);
    size_t head = is_block ? 6 : 3;
    wire_text_string(out, is_answer ? "written " : "write ");
    put_hex_word(out, address);
    if (is_answer && is_block)
        return;
    put_words(out, message + head, length > head ? length - head : 0);
    if (length > head && address == 0)
        put_command(out, message[head]);
    else if (length > head && address == 1)
        put_block(out, message[head]);
}

static void put_modbus(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    static const char *const exceptions[] = {"", "function", "address", "value", "device failure", "", "busy"};
    uint8_t function = message[0];
    if ((function & MODBUS_IS_EXCEPTION) != 0 && length >= 2) {
        wire_text_string(out, "exception ");
        wire_text_number(out, message[1], 0);
        wire_text_put(out, ' ');
        wire_text_string(out, message[1] < sizeof exceptions / sizeof *exceptions ? exceptions[message[1]] : "");
        return;
    }
    bool is_read = function == MODBUS_READ_HOLDING || function == MODBUS_READ_INPUT;
    bool is_write = function == MODBUS_WRITE_HOLDING || function == MODBUS_WRITE_REGISTERS;
    if (is_read && length >= (is_answer ? 2u : 5u))
        put_read(out, message, length, is_answer);
    else if (is_write && length >= 5)
        put_write(out, message, length, is_answer);
    else
        wire_text_hex(out, message, length);
}

/* Lines begin with a capital letter, Modbus messages with the code of a function. */
static bool is_line(const uint8_t *message)
{
    return message[0] >= ' ' && message[0] < MODBUS_IS_EXCEPTION;
}

static void put_message(struct wire_text *out, const uint8_t *message, size_t length, bool is_answer)
{
    if (length == 0)
        return;
    if (is_line(message))
        wire_text_bytes(out, message, length);
    else
        put_modbus(out, message, length, is_answer);
}

static void put_refusal(struct wire_text *out, const uint8_t *message, size_t length)
{
    if (length >= 2 && (message[0] & MODBUS_IS_EXCEPTION) != 0)
        put_modbus(out, message, length, true);
}

const struct device_words pmc_words = {.message = put_message, .refusal = put_refusal};
