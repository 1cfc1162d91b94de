/* SPDX-License-Identifier: MIT */
/* Telnet options are agreed after RFC 1143: what is agreed already gets no answer, or two ends might answer one another without
 * end. Data are eight bits wide whether or not BINARY has been agreed, since clients send them so (pyserial does). */
#include "rfc2217.h"

#include <string.h>

enum telnet {
    SE = 240,
    NOP = 241,
    BRK = 243,
    AYT = 246,
    SB = 250,
    WILL = 251,
    WONT = 252,
    DO = 253,
    DONT = 254,
    IAC = 255
};

enum { AT_DATA, AT_COMMAND, AT_OPTION, AT_SUB, AT_SUB_COMMAND };

#define COM_PORT 44
#define OPTIONS 3
static const uint8_t options[OPTIONS] = {0 /* BINARY */, 3 /* SUPPRESS-GO-AHEAD */, COM_PORT};
#define COM_PORT_AT 2
enum { OFF, ASKED, ON };

/* Commands of the client; the server's answer is 100 higher. */
enum {
    SIGNATURE,
    SET_BAUDRATE,
    SET_DATASIZE,
    SET_PARITY,
    SET_STOPSIZE,
    SET_CONTROL,
    NOTIFY_LINESTATE,
    NOTIFY_MODEMSTATE,
    SUSPEND,
    RESUME,
    SET_LINESTATE_MASK,
    SET_MODEMSTATE_MASK,
    PURGE_DATA
};
#define ANSWER 100

/* Values of SET_CONTROL. */
enum {
    ASK_FLOW_OUT = 0,
    FLOW_NONE = 1,
    FLOW_HARDWARE = 3,
    ASK_BREAK = 4,
    BREAK_ON,
    BREAK_OFF,
    ASK_DTR = 7,
    DTR_ON,
    DTR_OFF,
    ASK_RTS = 10,
    RTS_ON,
    RTS_OFF,
    ASK_FLOW_IN = 13,
    FLOW_IN_NONE = 14,
    FLOW_IN_HARDWARE = 16,
    FLOW_DCD = 17,
    FLOW_DTR = 18, /* inbound */
    FLOW_DSR = 19
};

#define LINE_STATE 0x60  /* nothing is waiting to be sent */
#define MODEM_STATE 0xB0 /* carrier, DSR, CTS */

static const char parities[] = "NOEMS";
static const char signature[] = "rkm04";

/* ---- Replies -------------------------------------------------------------------------------------------------------- */

size_t rfc2217_escape(const uint8_t *data, size_t length, uint8_t *out)
{
    size_t n = 0;
    for (size_t i = 0; i < length; i++) {
        out[n++] = data[i];
        if (data[i] == IAC)
            out[n++] = IAC;
    }
    return n;
}

static void put_reply(struct rfc2217 *port, const uint8_t *bytes, size_t length)
{
    memcpy(port->reply + port->reply_length, bytes, length);
    port->reply_length += length;
}

static void reply_option(struct rfc2217 *port, uint8_t verb, uint8_t option)
{
    put_reply(port, (const uint8_t[]){IAC, verb, option}, 3);
}

static void put_answer(struct rfc2217 *port, uint8_t command, const void *value, size_t length)
{
    put_reply(port, (const uint8_t[]){IAC, SB, COM_PORT, (uint8_t)(command + ANSWER)}, 4);
    port->reply_length += rfc2217_escape(value, length, port->reply + port->reply_length);
    put_reply(port, (const uint8_t[]){IAC, SE}, 2);
}

static void answer_byte(struct rfc2217 *port, uint8_t command, uint8_t value)
{
    put_answer(port, command, &value, 1);
}

/* ---- Telnet options ------------------------------------------------------------------------------------------------- */

static void handle_option(struct rfc2217 *port, uint8_t verb, uint8_t option)
{
    bool theirs = verb == WILL || verb == WONT, on = verb == WILL || verb == DO;
    uint8_t yes = theirs ? DO : WILL, no = theirs ? DONT : WONT;
    const uint8_t *known = memchr(options, option, OPTIONS);
    if (known == NULL) {
        if (on)
            reply_option(port, no, option);
        return;
    }
    uint8_t *state = (theirs ? port->theirs : port->ours) + (known - options), before = *state;
    *state = on ? ON : OFF;
    if (before == (on ? OFF : ON))
        reply_option(port, on ? yes : no, option);
    if (on && option == COM_PORT && !port->reported_lines) {
        port->reported_lines = true; /* pyserial does not know the lines before they are reported */
        answer_byte(port, NOTIFY_MODEMSTATE, MODEM_STATE);
    }
}

/* ---- Commands of RFC 2217 ------------------------------------------------------------------------------------------- */

/* In each, 0 or nothing asks for the value in force; so does what has no name. */

static enum rfc2217_event set_baud(struct rfc2217 *port, const uint8_t *value, size_t length)
{
    uint32_t baud = 0;
    for (size_t i = 0; length >= 4 && i < 4; i++)
        baud = baud << 8 | value[i];
    bool changed = baud != 0 && baud != port->baud;
    if (changed)
        port->baud = baud;
    uint8_t now[4];
    for (unsigned i = 0; i < 4; i++)
        now[i] = (uint8_t)(port->baud >> (24 - 8 * i));
    put_answer(port, SET_BAUDRATE, now, sizeof now);
    return changed ? RFC2217_SETTINGS : RFC2217_NOTHING;
}

static enum rfc2217_event set_data_bits(struct rfc2217 *port, uint8_t value)
{
    bool changed = value >= 5 && value <= 8 && value != port->data_bits;
    if (changed)
        port->data_bits = value;
    answer_byte(port, SET_DATASIZE, port->data_bits);
    return changed ? RFC2217_SETTINGS : RFC2217_NOTHING;
}

static enum rfc2217_event set_parity(struct rfc2217 *port, uint8_t value)
{
    bool changed = value >= 1 && value <= strlen(parities) && parities[value - 1] != port->parity;
    if (changed)
        port->parity = parities[value - 1];
    answer_byte(port, SET_PARITY, (uint8_t)(strchr(parities, port->parity) - parities + 1));
    return changed ? RFC2217_SETTINGS : RFC2217_NOTHING;
}

static enum rfc2217_event set_stop_bits(struct rfc2217 *port, uint8_t value)
{
    bool changed = value >= 1 && value <= 3 && value != port->stop_bits;
    if (changed)
        port->stop_bits = value;
    answer_byte(port, SET_STOPSIZE, port->stop_bits);
    return changed ? RFC2217_SETTINGS : RFC2217_NOTHING;
}

/* One line, whose three values are `ask`, then on, then off. Returns `event` if it has changed. */
static enum rfc2217_event set_line(struct rfc2217 *port, bool *line, uint8_t ask, uint8_t value, enum rfc2217_event event)
{
    bool wanted = value == ask ? *line : value == ask + 1, changed = wanted != *line;
    *line = wanted;
    answer_byte(port, SET_CONTROL, (uint8_t)(ask + (wanted ? 1 : 2)));
    return changed ? event : RFC2217_NOTHING;
}

/* Flow control is remembered and has no effect: on two wires there is none. */
static enum rfc2217_event set_control(struct rfc2217 *port, uint8_t value)
{
    if (value >= ASK_BREAK && value <= BREAK_OFF)
        return set_line(port, &port->breaking, ASK_BREAK, value, RFC2217_BREAK);
    if (value >= ASK_DTR && value <= DTR_OFF)
        return set_line(port, &port->dtr, ASK_DTR, value, RFC2217_LINES);
    if (value >= ASK_RTS && value <= RTS_OFF)
        return set_line(port, &port->rts, ASK_RTS, value, RFC2217_LINES);
    if (value > FLOW_DSR)
        return RFC2217_NOTHING; /* reserved: there is no value to report */
    bool inbound = (value >= ASK_FLOW_IN && value <= FLOW_IN_HARDWARE) || value == FLOW_DTR;
    uint8_t *flow = inbound ? &port->flow_in : &port->flow_out;
    if (value != ASK_FLOW_OUT && value != ASK_FLOW_IN)
        *flow = value;
    answer_byte(port, SET_CONTROL, *flow);
    return RFC2217_NOTHING;
}

static enum rfc2217_event set_flow(struct rfc2217 *port, bool suspended)
{
    port->suspended = suspended;
    return RFC2217_FLOW;
}

static void set_mask(struct rfc2217 *port, uint8_t command, uint8_t *mask, const uint8_t *value, size_t length)
{
    if (length > 0)
        *mask = *value;
    answer_byte(port, command, *mask);
}

static enum rfc2217_event purge(struct rfc2217 *port, uint8_t value)
{
    if (value < 1 || value > (RFC2217_PURGE_TO_CLIENT | RFC2217_PURGE_TO_LINE))
        return RFC2217_NOTHING;
    port->purge = value;
    answer_byte(port, PURGE_DATA, value);
    return RFC2217_PURGE;
}

/* A signature with a text is the client's, which is not needed. */
static void answer_signature(struct rfc2217 *port, size_t length)
{
    if (length == 0)
        put_answer(port, SIGNATURE, signature, strlen(signature));
}

static enum rfc2217_event handle_command(struct rfc2217 *port)
{
    size_t kept = port->command_length < RFC2217_COMMAND_MAX ? port->command_length : RFC2217_COMMAND_MAX;
    if (kept < 2 || port->command[0] != COM_PORT || (port->theirs[COM_PORT_AT] == OFF && port->ours[COM_PORT_AT] == OFF))
        return RFC2217_NOTHING;
    const uint8_t *value = port->command + 2;
    size_t length = kept - 2;
    uint8_t first = length > 0 ? *value : 0;
    switch (port->command[1]) {
    case SIGNATURE:
        answer_signature(port, length);
        return RFC2217_NOTHING;
    case SET_BAUDRATE:
        return set_baud(port, value, length);
    case SET_DATASIZE:
        return set_data_bits(port, first);
    case SET_PARITY:
        return set_parity(port, first);
    case SET_STOPSIZE:
        return set_stop_bits(port, first);
    case SET_CONTROL:
        return set_control(port, first);
    case NOTIFY_LINESTATE:
        answer_byte(port, NOTIFY_LINESTATE, LINE_STATE);
        return RFC2217_NOTHING;
    case NOTIFY_MODEMSTATE:
        answer_byte(port, NOTIFY_MODEMSTATE, MODEM_STATE);
        return RFC2217_NOTHING;
    case SUSPEND:
        return set_flow(port, true);
    case RESUME:
        return set_flow(port, false);
    case SET_LINESTATE_MASK:
        set_mask(port, SET_LINESTATE_MASK, &port->line_mask, value, length);
        return RFC2217_NOTHING;
    case SET_MODEMSTATE_MASK:
        set_mask(port, SET_MODEMSTATE_MASK, &port->modem_mask, value, length);
        return RFC2217_NOTHING;
    case PURGE_DATA:
        return purge(port, first);
    default:
        return RFC2217_NOTHING;
    }
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

void rfc2217_begin(struct rfc2217 *port)
{
    *port = (struct rfc2217){
        .baud = 19200,
        .data_bits = 8,
        .parity = 'N',
        .stop_bits = 1,
        .dtr = true,
        .rts = true,
        .flow_out = FLOW_NONE,
        .flow_in = FLOW_IN_NONE,
        .modem_mask = 0xFF,
        .ours = {ASKED, ASKED, OFF},
        .theirs = {ASKED, OFF, ASKED},
    };
    for (unsigned i = 0; i < OPTIONS; i++) {
        if (port->ours[i] == ASKED)
            reply_option(port, WILL, options[i]);
        if (port->theirs[i] == ASKED)
            reply_option(port, DO, options[i]);
    }
}

static enum rfc2217_event handle_data(struct rfc2217 *port, uint8_t byte)
{
    port->state = AT_DATA;
    port->data = byte;
    return RFC2217_DATA;
}

static void store_command_byte(struct rfc2217 *port, uint8_t byte)
{
    port->state = AT_SUB;
    if (port->command_length < RFC2217_COMMAND_MAX)
        port->command[port->command_length++] = byte;
}

/* The byte after IAC, outside of a subnegotiation. */
static enum rfc2217_event handle_verb(struct rfc2217 *port, uint8_t byte)
{
    port->state = AT_DATA;
    switch (byte) {
    case IAC:
        return handle_data(port, byte);
    case SB:
        port->state = AT_SUB;
        port->command_length = 0;
        return RFC2217_NOTHING;
    case WILL:
    case WONT:
    case DO:
    case DONT:
        port->state = AT_OPTION;
        port->verb = byte;
        return RFC2217_NOTHING;
    case BRK:
        return RFC2217_BREAK_PULSE;
    case AYT:
        put_reply(port, (const uint8_t[]){IAC, NOP}, 2); /* a text would get among the data */
        return RFC2217_NOTHING;
    default:
        return RFC2217_NOTHING;
    }
}

/* The byte after IAC in a subnegotiation. */
static enum rfc2217_event handle_sub_verb(struct rfc2217 *port, uint8_t byte)
{
    if (byte == IAC) {
        store_command_byte(port, byte);
        return RFC2217_NOTHING;
    }
    if (byte != SE)
        return handle_verb(port, byte); /* its end is missing: discard it */
    port->state = AT_DATA;
    return handle_command(port);
}

enum rfc2217_event rfc2217_receive(struct rfc2217 *port, uint8_t byte)
{
    port->reply_length = 0;
    switch (port->state) {
    case AT_COMMAND:
        return handle_verb(port, byte);
    case AT_OPTION:
        port->state = AT_DATA;
        handle_option(port, port->verb, byte);
        return RFC2217_NOTHING;
    case AT_SUB:
        if (byte == IAC)
            port->state = AT_SUB_COMMAND;
        else
            store_command_byte(port, byte);
        return RFC2217_NOTHING;
    case AT_SUB_COMMAND:
        return handle_sub_verb(port, byte);
    default:
        if (byte != IAC)
            return handle_data(port, byte);
        port->state = AT_COMMAND;
        return RFC2217_NOTHING;
    }
}
