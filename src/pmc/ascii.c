/* SPDX-License-Identifier: MIT */
#include <string.h>

#include "line.h"
#include "reply.h"

#define CR "\r"
#define LF_CR "\n\r"
#define END '\r'

/* An answer that is being written. */
struct text {
    uint8_t *at;
    size_t length;
};

static void put_text(struct text *to, const char *text)
{
    for (; *text != '\0'; text++)
        to->at[to->length++] = (uint8_t)*text;
}

static void put_hex(struct text *to, uint32_t number, unsigned digits)
{
    while (digits-- > 0)
        to->at[to->length++] = (uint8_t)"0123456789ABCDEF"[number >> 4u * digits & 15u];
}

static void put_decimal(struct text *to, uint32_t number)
{
    uint32_t unit = 1;
    while (number / unit >= 10)
        unit *= 10;
    for (; unit > 0; unit /= 10)
        to->at[to->length++] = (uint8_t)('0' + number / unit % 10u);
}

/* ---- Commands ----------------------------------------------------------------------------------------------------------- */

/* A line that is being executed. */
struct line {
    struct pmc_unit *unit;
    struct pmc_line_operands operands;
    struct text answer;
};

typedef enum pmc_answer execute(struct line *line);

/* Ask the unit for something that concerns the axes of the line, with its numbers. */
static enum pmc_answer ask(struct line *line, enum pmc_request_kind kind)
{
    const struct pmc_request request = {
        .kind = (uint8_t)kind, .axes = line->operands.axes, .value = {line->operands.number[0], line->operands.number[1]}};
    return pmc_request(line->unit, &request);
}

static enum pmc_answer run_program(struct line *line)
{
    line->operands.number[0] = line->operands.number[1] = line->operands.reg;
    return ask(line, PMC_RUN);
}

static enum pmc_answer jog(struct line *line)
{
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        bool is_forward = (line->operands.forward & 1u << axis) != 0;
        line->operands.number[axis] = is_forward ? 1 : -1;
    }
    return ask(line, PMC_JOG);
}

static enum pmc_answer move_to(struct line *line)
{
    return ask(line, PMC_MOVE_TO);
}

static enum pmc_answer move_by(struct line *line)
{
    return ask(line, PMC_MOVE_BY);
}

static enum pmc_answer set_speeds(struct line *line)
{
    if (!line->operands.is_empty)
        return ask(line, PMC_SET_SPEED);
    put_text(&line->answer, "SPD ");
    for (unsigned axis = 0; axis < line->unit->config.axes; axis++) {
        put_text(&line->answer, axis > 0 ? "," : "");
        put_decimal(&line->answer, line->unit->axis[axis].speed);
    }
    put_text(&line->answer, LF_CR);
    return PMC_OK;
}

static enum pmc_answer stop(struct line *line)
{
    return ask(line, PMC_STOP);
}

static enum pmc_answer clear_commanded(struct line *line)
{
    return ask(line, PMC_CLEAR_COMMANDED);
}

static enum pmc_answer clear_actual(struct line *line)
{
    return ask(line, PMC_CLEAR_ACTUAL);
}

static enum pmc_answer home(struct line *line)
{
    return ask(line, PMC_SEARCH);
}

static enum pmc_answer reset(struct line *line)
{
    return ask(line, PMC_RESET);
}

static enum pmc_answer read_positions(struct line *line)
{
    put_text(&line->answer, "POS ");
    for (unsigned axis = 0; axis < line->unit->config.axes; axis++) {
        struct pmc_axis_state state;
        pmc_axis_state(line->unit, axis, &state);
        put_text(&line->answer, axis > 0 ? "," : "");
        put_hex(&line->answer, (uint32_t)state.commanded, 8);
    }
    put_text(&line->answer, CR);
    return PMC_OK;
}

/* The state of the one axis that is named. */
static unsigned read_state(const struct line *line, struct pmc_axis_state *state)
{
    unsigned axis = line->operands.axes >> 1;
    pmc_axis_state(line->unit, axis, state);
    return axis;
}

static enum pmc_answer read_driving(struct line *line)
{
    struct pmc_axis_state state;
    unsigned axis = read_state(line, &state);
    put_text(&line->answer, axis == 0 ? "INR X " : "INR Y ");
    put_decimal(&line->answer, state.driving);
    put_text(&line->answer, CR);
    return PMC_OK;
}

static enum pmc_answer read_errors(struct line *line)
{
    struct pmc_axis_state state;
    (void)read_state(line, &state);
    put_text(&line->answer, "ERD ");
    put_hex(&line->answer, state.errors, 2);
    put_text(&line->answer, LF_CR);
    return PMC_OK;
}

static enum pmc_answer read_version(struct line *line)
{
    put_text(&line->answer, line->unit->config.axes == 1 ? "VER PMC-1HS 1.00" LF_CR : "VER PMC-2HS 1.00" LF_CR);
    return PMC_OK;
}

/* SCI: the speed of the line, or that which it has from the next RST on. */
static enum pmc_answer set_baud(struct line *line)
{
    if (line->operands.is_empty) {
        put_text(&line->answer, "SCI ");
        put_decimal(&line->answer, pmc_baud(line->unit));
        put_text(&line->answer, LF_CR);
        return PMC_OK;
    }
    for (const uint32_t *baud = pmc_bauds; *baud != 0; baud++) {
        if (line->operands.number[0] == (int32_t)*baud) {
            line->unit->face.ascii.next_baud = *baud;
            return PMC_OK;
        }
    }
    return PMC_RANGE;
}

enum { ASKS = 1, ASKS_IF_EMPTY = 2 };

/* Commands by name. */
static const struct {
    char name[3];
    uint8_t operand; /* enum pmc_line_operand */
    uint8_t asks;    /* has an answer */
    execute *execute;
} commands[] = {
    {"PRG", PMC_LINE_START, 0, run_program},
    {"JOG", PMC_LINE_SIGNED, 0, jog},
    {"PAB", PMC_LINE_NUMBERS, 0, move_to},
    {"PIC", PMC_LINE_NUMBERS, 0, move_by},
    {"SPD", PMC_LINE_VALUES, ASKS_IF_EMPTY, set_speeds},
    {"STO", PMC_LINE_AXES, 0, stop},
    {"CLL", PMC_LINE_AXES, 0, clear_commanded},
    {"CLR", PMC_LINE_AXES, 0, clear_actual},
    {"POS", PMC_LINE_NONE, ASKS, read_positions},
    {"HOM", PMC_LINE_AXES, 0, home},
    {"RST", PMC_LINE_NONE, 0, reset},
    {"INR", PMC_LINE_ONE, ASKS, read_driving},
    {"ERD", PMC_LINE_ONE, ASKS, read_errors},
    {"VER", PMC_LINE_NONE, ASKS, read_version},
    {"SCI", PMC_LINE_VALUE, ASKS_IF_EMPTY, set_baud},
};

#define COMMANDS (sizeof commands / sizeof commands[0])
#define NAME 3u /* letters */

/* The row of the line's command; COMMANDS: it has none. */
static size_t find_command(const char *line, size_t length)
{
    size_t row = 0;
    if (length < NAME || (length > NAME && line[NAME] != ' '))
        return COMMANDS;
    while (row < COMMANDS && memcmp(commands[row].name, line, NAME) != 0)
        row++;
    return row;
}

static bool is_blank(const char *text, size_t length)
{
    while (length > 0 && *text == ' ') {
        text++;
        length--;
    }
    return length == 0;
}

/* Does the line have an answer, if it is right? */
static bool is_question(const char *line, size_t length)
{
    size_t row = find_command(line, length);
    if (row == COMMANDS)
        return false;
    return commands[row].asks == ASKS || (commands[row].asks == ASKS_IF_EMPTY && is_blank(line + NAME, length - NAME));
}

/* Execute a line. One that is ignored is counted (AS4). Returns the length of the answer that is written; 0: none. */
static size_t execute_line(struct pmc_unit *unit, const char *text, size_t length, uint8_t *answer)
{
    struct line line = {.unit = unit, .answer = {.at = answer}};
    struct pmc_ignored *ignored = &unit->face.ascii.ignored;
    if (length == 0)
        return 0;
    size_t row = find_command(text, length);
    if (row == COMMANDS) {
        ignored->unknown++;
        return 0;
    }
    enum pmc_line_operand form = (enum pmc_line_operand)commands[row].operand;
    if (!pmc_line_read(form, text + NAME, length - NAME, unit->config.axes, &line.operands)) {
        ignored->operand++;
        return 0;
    }
    switch (commands[row].execute(&line)) {
    case PMC_OK:
        return line.answer.length;
    case PMC_BUSY:
        ignored->busy++;
        return 0;
    default:
        ignored->range++;
        return 0;
    }
}

/* ---- The line ----------------------------------------------------------------------------------------------------------- */

static uint32_t ignored_lines(const struct pmc_ignored *ignored)
{
    return ignored->unknown + ignored->operand + ignored->range + ignored->busy + ignored->too_long + ignored->line;
}

static void end_line(struct pmc_unit *unit)
{
    struct pmc_ascii *ascii = &unit->face.ascii;
    size_t answer = 0;
    uint32_t ignored = ignored_lines(&ascii->ignored);
    if (ascii->is_spoilt)
        ascii->ignored.line++;
    else if (ascii->length > PMC_LINE_MAX)
        ascii->ignored.too_long++;
    else
        answer = execute_line(unit, ascii->line, ascii->length, ascii->answer);
    if (ignored_lines(&ascii->ignored) != ignored)
        ascii->reply.counters.dropped++;
    else
        ascii->reply.counters.requests++;
    ascii->length = 0;
    ascii->is_spoilt = ascii->is_waiting = false;
    pmc_reply_begin(unit, answer);
}

/* A line that asks while an answer goes out is executed after it (AS1). */
static bool has_to_wait(const struct pmc_ascii *ascii)
{
    bool is_right = !ascii->is_spoilt && ascii->length <= PMC_LINE_MAX;
    return ascii->reply.length > 0 && is_right && is_question(ascii->line, ascii->length);
}

static void take_character(struct pmc_unit *unit, uint8_t byte)
{
    struct pmc_ascii *ascii = &unit->face.ascii;
    if (byte == END && has_to_wait(ascii))
        ascii->is_waiting = true;
    else if (byte == END)
        end_line(unit);
    else if (byte < ' ' || byte == 0x7F)
        return; /* another control character */
    else if (ascii->length < PMC_LINE_MAX)
        ascii->line[ascii->length++] = (char)byte;
    else
        ascii->length = PMC_LINE_MAX + 1;
}

static size_t receive(struct pmc_unit *unit, const uint8_t *bytes, size_t length)
{
    size_t taken = 0;
    for (; taken < length && !unit->face.ascii.is_waiting; taken++)
        take_character(unit, bytes[taken]);
    return taken;
}

static size_t send(struct pmc_unit *unit, uint8_t *bytes, size_t room)
{
    struct pmc_ascii *ascii = &unit->face.ascii;
    size_t sent = pmc_reply_take(unit, ascii->answer, bytes, room);
    if (ascii->is_waiting && ascii->reply.length == 0)
        end_line(unit);
    return sent;
}

static bool has_answer(const struct pmc_unit *unit)
{
    return unit->face.ascii.reply.length > 0;
}

static void take_baud(struct pmc_unit *unit)
{
    if (unit->face.ascii.next_baud != 0)
        unit->config.baud = unit->face.ascii.next_baud;
}

const struct pmc_face pmc_ascii_face = {
    .name = "ascii", .receive = receive, .send = send, .has_answer = has_answer, .reset = take_baud};

void pmc_ascii_lose_byte(struct pmc_unit *unit)
{
    unit->face.ascii.is_spoilt = true;
}

size_t pmc_ascii_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room)
{
    const struct pmc_ignored ignored = unit->face.ascii.ignored;
    uint8_t text[PMC_ANSWER_MAX];
    size_t made = length <= PMC_LINE_MAX ? execute_line(unit, (const char *)message, length, text) : 0;
    unit->face.ascii.ignored = ignored;
    memcpy(answer, text, made < room ? made : room);
    return made;
}
