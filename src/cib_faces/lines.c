/* SPDX-License-Identifier: MIT */
#include "lines.h"

#include <rkm04/limits.h>

#define NUMBER_SIZE 12u /* characters of a value, with its end */
#define DIGITS_MAX 10u  /* of a number that is read */

enum command { NONE, GET, SET, LIST, ENABLE, DISABLE, INFO, FILE_INFO, FILE_GET, FILE_WRITE, FILE_WRITE_INFO, MEMORY };

enum error {
    SEND_FAILED = 21,
    BAD_REQUEST = 30,
    INCOMPLETE = 31,
    UNKNOWN_COMMAND = 32,
    UNKNOWN_NAME = 33,
    WRONG_VALUE = 35,
    NO_FILE_INFO = 40,
    NO_FILE = 41,
    NO_FILE_WRITE = 42,
    NO_FILE_WRITE_INFO = 43,
    UNKNOWN_INFO = 60,
    NO_MEMORY = 80
};

/* A piece of the line. */
struct piece {
    const char *text;
    size_t length;
};

/* A line that is being executed. */
struct work {
    struct cib_lines *lines;
    const struct cib_modules *modules;
    const struct cib_lines_out *out;
    struct piece whole; /* as the client sent it, without blanks around */
};

/* ---- Text out ----------------------------------------------------------------------------------------------------------- */

static void put_piece(const struct cib_lines_out *out, struct piece piece)
{
    out->put(out->context, piece.text, piece.length);
}

static size_t length_of(const char *text)
{
    size_t length = 0;
    while (text[length] != '\0')
        length++;
    return length;
}

static void put(const struct cib_lines_out *out, const char *text)
{
    out->put(out->context, text, length_of(text));
}

static void put_number(const struct cib_lines_out *out, int64_t value)
{
    char text[NUMBER_SIZE];
    size_t at = sizeof text;
    uint64_t rest = value < 0 ? (uint64_t)-value : (uint64_t)value;
    do {
        text[--at] = (char)('0' + rest % 10u);
        rest /= 10u;
    } while (rest > 0);
    if (value < 0)
        text[--at] = '-';
    out->put(out->context, text + at, sizeof text - at);
}

static void put_name(const struct work *work, const char *command, unsigned variable)
{
    char name[CIB_VARIABLE_NAME_SIZE];
    size_t length = cib_variable_name(work->modules, variable, name);
    put(work->out, command);
    put_piece(work->out, (struct piece){name, length});
}

static void put_value(const struct work *work, const char *command, unsigned variable)
{
    put_name(work, command, variable);
    put(work->out, ",");
    put_number(work->out, cib_variable_value(work->modules, variable));
    put(work->out, "\r\n");
}

static void refuse(const struct work *work, enum error error)
{
    static const struct {
        enum error error;
        bool quotes; /* the line follows in quotes */
        const char *text;
    } texts[] = {
        {SEND_FAILED, false, " Unable to send data to PLC."},
        {BAD_REQUEST, true, " Bad client request: "},
        {INCOMPLETE, false, " Incomplete client request."},
        {UNKNOWN_COMMAND, true, " Unknown command name in request: "},
        {UNKNOWN_NAME, true, " Unknown variable name in request: "},
        {WRONG_VALUE, true, " Wrong parameter value in request: "},
        {UNKNOWN_INFO, true, " Unknown parameter name in request: "},
    };
    put(work->out, "ERROR:");
    put_number(work->out, error);
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        if (texts[i].error != error)
            continue;
        put(work->out, texts[i].text);
        if (!texts[i].quotes)
            break;
        put(work->out, "'");
        put_piece(work->out, work->whole);
        put(work->out, "'");
    }
    put(work->out, error >= NO_FILE_INFO && error != UNKNOWN_INFO ? " Not supported.\r\n" : "\r\n");
}

/* ---- Text in ------------------------------------------------------------------------------------------------------------ */

static char upper(char character)
{
    return character >= 'a' && character <= 'z' ? (char)(character - 'a' + 'A') : character;
}

static bool is_blank(char character)
{
    return character == ' ' || character == '\t' || character == '\r';
}

static struct piece trim(struct piece piece)
{
    while (piece.length > 0 && is_blank(piece.text[0])) {
        piece.text++;
        piece.length--;
    }
    while (piece.length > 0 && is_blank(piece.text[piece.length - 1u]))
        piece.length--;
    return piece;
}

/* Cut off what is before the first of `marks`. Returns false, *rest empty, if there is none. */
static bool split(struct piece piece, const char *marks, struct piece *first, struct piece *rest)
{
    for (size_t at = 0; at < piece.length; at++) {
        for (const char *mark = marks; *mark != '\0'; mark++) {
            if (piece.text[at] != *mark)
                continue;
            *first = trim((struct piece){piece.text, at});
            *rest = trim((struct piece){piece.text + at + 1u, piece.length - at - 1u});
            return true;
        }
    }
    *first = trim(piece);
    *rest = (struct piece){piece.text + piece.length, 0};
    return false;
}

static bool is(struct piece piece, const char *word)
{
    size_t at = 0;
    while (at < piece.length && word[at] != '\0' && upper(piece.text[at]) == upper(word[at]))
        at++;
    return at == piece.length && word[at] == '\0';
}

static bool has_star(struct piece piece)
{
    for (size_t at = 0; at < piece.length; at++)
        if (piece.text[at] == '*')
            return true;
    return false;
}

/* Does a name fit a pattern in which * stands for any characters? Goes back to the last * alone: no pattern takes long. */
static bool fits(struct piece pattern, const char *name, size_t length)
{
    size_t at = 0, in = 0, star = SIZE_MAX, mark = 0;
    while (in < length) {
        if (at < pattern.length && pattern.text[at] == '*') {
            star = at++;
            mark = in;
        } else if (at < pattern.length && upper(pattern.text[at]) == upper(name[in])) {
            at++;
            in++;
        } else if (star != SIZE_MAX) {
            at = star + 1u;
            in = ++mark;
        } else {
            return false;
        }
    }
    while (at < pattern.length && pattern.text[at] == '*')
        at++;
    return at == pattern.length;
}

/* A decimal number with a sign. */
static bool read_number(struct piece piece, int64_t *value)
{
    bool negative = piece.length > 0 && piece.text[0] == '-';
    size_t at = negative || (piece.length > 0 && piece.text[0] == '+');
    if (at == piece.length || piece.length - at > DIGITS_MAX)
        return false;
    *value = 0;
    for (; at < piece.length; at++) {
        if (piece.text[at] < '0' || piece.text[at] > '9')
            return false;
        *value = *value * 10 + (piece.text[at] - '0');
    }
    *value = negative ? -*value : *value;
    return true;
}

/* ---- Commands ----------------------------------------------------------------------------------------------------------- */

static bool is_enabled(const struct cib_lines *lines, unsigned variable)
{
    return variable == 0 || ((unsigned)lines->enabled[variable / 8u] >> variable % 8u & 1u) != 0; /* __PLC_RUN always is */
}

static void enable(struct work *work, unsigned variable, bool on, uint32_t delta)
{
    struct cib_lines *lines = work->lines;
    unsigned bit = 1u << variable % 8u, bits = lines->enabled[variable / 8u];
    lines->enabled[variable / 8u] = (uint8_t)(on ? bits | bit : bits & ~bit);
    lines->told[variable] = cib_variable_value(work->modules, variable);
    lines->delta[variable] = delta;
}

static void put_active(const struct work *work)
{
    unsigned count = 0, all = cib_variables(work->modules);
    for (unsigned variable = 0; variable < all; variable++)
        count += is_enabled(work->lines, variable);
    put(work->out, "WARNING:252 Changed active variables in public file: '[");
    put_number(work->out, count);
    put(work->out, "/");
    put_number(work->out, all);
    put(work->out, "]'\r\n");
}

static void list(const struct work *work, unsigned variable)
{
    put_name(work, "LIST:", variable);
    put(work->out, ",");
    put(work->out, cib_variable_type(variable));
    put(work->out, is_enabled(work->lines, variable) ? "\r\n" : "*\r\n");
}

static void execute_for(struct work *work, enum command command, unsigned variable, uint32_t delta)
{
    if (command == GET)
        put_value(work, "GET:", variable);
    else if (command == LIST)
        list(work, variable);
    else
        enable(work, variable, command == ENABLE, delta);
}

/* GET, LIST, EN, DI: a name, or a pattern; nothing is all. */
static void execute_for_names(struct work *work, enum command command, struct piece name, uint32_t delta)
{
    bool single = name.length > 0 && !has_star(name), found = false;
    char text[CIB_VARIABLE_NAME_SIZE];
    for (unsigned variable = 0; variable < cib_variables(work->modules); variable++) {
        size_t length = cib_variable_name(work->modules, variable, text);
        if (name.length > 0 && !fits(name, text, length))
            continue;
        found = true;
        execute_for(work, command, variable, delta);
    }
    if (single && !found)
        refuse(work, UNKNOWN_NAME);
    else if (command == LIST)
        put(work->out, "LIST:\r\n");
    else if (command == GET && !single)
        put(work->out, "GET:\r\n");
    else if (command != GET)
        put_active(work);
}

static bool find_variable(const struct work *work, struct piece name, unsigned *variable)
{
    char text[CIB_VARIABLE_NAME_SIZE];
    for (*variable = 0; *variable < cib_variables(work->modules); ++*variable) {
        (void)cib_variable_name(work->modules, *variable, text);
        if (is(name, text))
            return true;
    }
    return false;
}

static bool read_value(unsigned variable, struct piece piece, int64_t *value)
{
    if (cib_variable_is_bit(variable) && (is(piece, "true") || is(piece, "false"))) {
        *value = is(piece, "true");
        return true;
    }
    return read_number(piece, value);
}

static void set(struct work *work, struct piece rest)
{
    struct piece name, text;
    unsigned variable;
    int64_t value;
    (void)split(rest, ",", &name, &text);
    if (!find_variable(work, name, &variable)) {
        refuse(work, UNKNOWN_NAME);
    } else if (!cib_variable_is_open(work->modules, variable)) {
        refuse(work, SEND_FAILED);
    } else if (!read_value(variable, text, &value) || cib_variable_set(work->modules, variable, value) != CIB_SET_DONE) {
        refuse(work, WRONG_VALUE);
    } else {
        put_value(work, "DIFF:", variable);
        work->lines->told[variable] = cib_variable_value(work->modules, variable);
    }
}

static void set_enabled(struct work *work, struct piece rest)
{
    struct piece name, text;
    int64_t delta = 0;
    (void)split(rest, " \t", &name, &text);
    if (text.length > 0 && (!read_number(text, &delta) || delta < 0 || delta > UINT32_MAX))
        refuse(work, WRONG_VALUE);
    else
        execute_for_names(work, ENABLE, name, (uint32_t)delta);
}

static void put_info(struct work *work, struct piece name)
{
    bool all = name.length == 0, version = all || is(name, "VERSION"), plc = all || is(name, "VERSION_PLC");
    if (!version && !plc)
        refuse(work, UNKNOWN_INFO);
    if (version)
        put(work->out, "GETINFO:VERSION,RKM04 " RKM04_VERSION "\r\n");
    if (plc)
        put(work->out, "GETINFO:VERSION_PLC,C-OS-0808M 1.2\r\n");
    if (all)
        put(work->out, "GETINFO:\r\n");
}

static enum command command_named(struct piece name)
{
    static const char *const names[] = {
        [GET] = "GET", [SET] = "SET", [LIST] = "LIST", [ENABLE] = "EN", [DISABLE] = "DI", [INFO] = "GETINFO",
        [FILE_INFO] = "GETFILEINFO", [FILE_GET] = "GETFILE", [FILE_WRITE] = "WRITEFILE", [FILE_WRITE_INFO] = "WRITEFILEINFO",
        [MEMORY] = "GETMEM",
    };
    for (unsigned command = GET; command <= MEMORY; command++)
        if (is(name, names[command]))
            return (enum command)command;
    return NONE;
}

static void execute_command(struct work *work, enum command command, struct piece rest)
{
    static const enum error missing[] = {[FILE_INFO] = NO_FILE_INFO,
                                         [FILE_GET] = NO_FILE,
                                         [FILE_WRITE] = NO_FILE_WRITE,
                                         [FILE_WRITE_INFO] = NO_FILE_WRITE_INFO,
                                         [MEMORY] = NO_MEMORY};
    if (command >= GET && command <= DISABLE)
        work->lines->command = (uint8_t)command;
    if (command == NONE)
        refuse(work, UNKNOWN_COMMAND);
    else if (command == SET)
        set(work, rest);
    else if (command == ENABLE)
        set_enabled(work, rest);
    else if (command <= DISABLE)
        execute_for_names(work, command, rest, 0);
    else if (command == INFO)
        put_info(work, rest);
    else
        refuse(work, missing[command]);
}

static void execute_line(struct cib_lines *lines, const struct cib_modules *modules, const struct cib_lines_out *out)
{
    struct work work = {.lines = lines, .modules = modules, .out = out};
    struct piece name, rest;
    work.whole = trim((struct piece){lines->line, lines->length});
    for (unsigned i = 0; i < modules->count; i++)
        if (modules->unit[i])
            cib_note_request(modules->unit[i]);
    if (lines->too_long || work.whole.length > CIB_LINE_MAX)
        refuse(&work, INCOMPLETE);
    else if (work.whole.length == 0)
        return;
    else if (split(work.whole, ":", &name, &rest))
        execute_command(&work, command_named(name), rest);
    else if (lines->command == NONE)
        refuse(&work, BAD_REQUEST);
    else
        execute_command(&work, (enum command)lines->command, work.whole);
}

/* ---- Public ------------------------------------------------------------------------------------------------------------- */

void cib_lines_receive(struct cib_lines *lines, const struct cib_modules *modules, const uint8_t *bytes, size_t length,
                       const struct cib_lines_out *out)
{
    for (size_t i = 0; i < length; i++) {
        if (bytes[i] == '\n') {
            execute_line(lines, modules, out);
            lines->length = 0;
            lines->too_long = false;
        } else if (lines->length < sizeof lines->line) {
            lines->line[lines->length++] = (char)bytes[i];
        } else {
            lines->too_long = true;
        }
    }
}

bool cib_lines_watches(const struct cib_lines *lines, const struct cib_modules *modules)
{
    for (unsigned variable = 1; variable < cib_variables(modules); variable++)
        if (is_enabled(lines, variable))
            return true;
    return false;
}

void cib_lines_report_changes(struct cib_lines *lines, const struct cib_modules *modules, const struct cib_lines_out *out)
{
    const struct work work = {.lines = lines, .modules = modules, .out = out};
    for (unsigned variable = 1; variable < cib_variables(modules); variable++) {
        if (!is_enabled(lines, variable))
            continue;
        int64_t value = cib_variable_value(modules, variable), step = value - lines->told[variable];
        if ((step < 0 ? -step : step) <= (int64_t)lines->delta[variable])
            continue;
        lines->told[variable] = (int32_t)value;
        put_value(&work, "DIFF:", variable);
    }
}
