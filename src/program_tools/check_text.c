/* SPDX-License-Identifier: MIT */
/* check_text.c: what a unit refuses in a text, with what may have been meant; K, C75 and apostrophes. */
#include <stdio.h>
#include <string.h>

#include "check_inside.h"
#include "text/text.h"

#define HINT_SIZE 160

/* ---- What may have been meant --------------------------------------------------------------------------------------- */

static bool is_digit(int character)
{
    return '0' <= character && character <= '9';
}

/* The byte at `at`, 0 outside of the text. */
static uint8_t byte_at(const struct rkm04_reader *reader, size_t at)
{
    return at < reader->length ? reader->text[at] : 0;
}

static bool is_one_of(uint8_t character, const char *list)
{
    return character != '\0' && strchr(list, character) != NULL;
}

/* O and l where a digit is meant: F1O00, FlO, R1o. */
static bool hint_digit(const struct rkm04_reader *reader, enum rkm04_read found, char *hint)
{
    size_t letter = reader->start;
    if (letter == 0 || !is_digit(reader->text[letter - 1]) || !is_one_of(reader->text[letter], "Ool")) {
        letter = reader->wrong; /* directly after its command */
        if (found != RKM04_READ_BAD_VALUE || letter != reader->start + 1 || !is_one_of(byte_at(reader, letter), "OolI"))
            return false;
    }
    const char character = (char)reader->text[letter];
    snprintf(hint, HINT_SIZE, "%c is a letter; did you mean the digit %c?", character,
             character == 'O' || character == 'o' ? '0' : '1');
    return true;
}

static bool takes_no_number(uint8_t op)
{
    enum rkm04_form form;
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    return rkm04_form_of(op, &form, ranges) >= 0 && form == RKM04_FORM_NONE;
}

static const char *stray_number_hint(uint8_t op)
{
    switch (op) {
    case 'R':
        return "R takes no number; F or B set the steps: F1000 R";
    case 'H':
        return "H takes no number: it moves to position 0; G moves to another one";
    case 'E':
        return "E takes no number; L sets the number of passes: L3 ... E";
    case 'D':
    case 'Y':
        return "F or B before it sets the steps";
    case '.':
        return "only whole numbers are possible";
    default:
        return "this command takes no number";
    }
}

/* A number where a command is expected: R1000, F1.5. */
static const char *hint_number(const struct rkm04_reader *reader)
{
    size_t at = reader->start;
    while (at > 0 && reader->text[at - 1] <= 0x20)
        at--;
    if (at == 0)
        return "a command begins with its letter: F1000";
    const uint8_t before = byte_at(reader, at - 1);
    if (takes_no_number(before))
        return stray_number_hint(before);
    return is_digit(before) ? "a number has no blanks in it" : NULL;
}

static const char *hint_unknown(const struct rkm04_reader *reader)
{
    const uint8_t c = byte_at(reader, reader->start), next = byte_at(reader, reader->start + 1);
    if (is_digit(c))
        return hint_number(reader);
    switch (c) {
    case 0x91: /* code page 1250 */
    case 0x92:
        return "a typographic apostrophe of code page 1250; the call is '";
    case '`':
        return "did you mean the apostrophe ' of a call?";
    case ';':
    case ',':
    case ':':
        return "no separator is needed between commands; a blank is possible";
    case '#':
    case '/':
    case '*':
        return "comments are written in braces: { text }";
    case '-':
    case '+':
        return is_digit(next) ? "a number of steps has no sign: F moves forward, B back" : NULL;
    case '<':
    case '>':
        return "a move to an input is ) forward or ( back";
    case 'P':
        return "the position counter is set by C100 or =n";
    case '{':
        return "everything after it is a comment";
    default:
        return NULL;
    }
}

static const char *hint_bad_value(const struct rkm04_reader *reader)
{
    const uint8_t op = byte_at(reader, reader->start), wrong = byte_at(reader, reader->wrong);
    if (wrong == '-' && op == 'F')
        return "did you mean B, which moves back?";
    if (wrong == '-' && op == 'B')
        return "did you mean F, which moves forward?";
    if (wrong == '-' && op == 'G')
        return "positions below 0 are reached by B, or by H and =n";
    if (wrong == '@' && (op == 'J' || op == '\'' || op == 'I'))
        return "write the number alone: J5 jumps to @5";
    if ((op == 'T' || op == 'C' || op == 'O' || op == 'Z') && is_digit(wrong))
        return op == 'T' || op == 'C' ? "01..08 are outputs, 40..58 functions, 80..95 variables"
                                      : "01..08 are inputs, 80..95 variables";
    if (op == 'I' && wrong == ',')
        return "an I has H or L between its numbers: I01H20";
    return NULL;
}

static bool find_hint(const struct rkm04_reader *reader, enum rkm04_read found, char hint[HINT_SIZE])
{
    if (hint_digit(reader, found, hint))
        return true;
    const char *text = found == RKM04_READ_UNKNOWN ? hint_unknown(reader) : hint_bad_value(reader);
    if (text == NULL)
        return false;
    snprintf(hint, HINT_SIZE, "%s", text);
    return true;
}

/* ---- Errors --------------------------------------------------------------------------------------------------------- */

struct reading {
    struct check *check;
    size_t requests, request_offset; /* K and C75 of this source; where the first one is */
};

/* The bytes an error is about: from the command to what does not fit. */
static size_t error_length(const struct rkm04_reader *reader, enum rkm04_read found)
{
    const char *text = (const char *)reader->text;
    size_t end = reader->start + text_character_length(text, reader->length, reader->start);
    if (found == RKM04_READ_BAD_VALUE && reader->wrong < reader->length) {
        size_t wrong = reader->wrong;
        while (is_digit(byte_at(reader, wrong)) || (wrong == reader->wrong && is_one_of(byte_at(reader, wrong), "+-")))
            wrong++;
        end = wrong > end ? wrong : end;
    }
    return end > reader->length ? reader->length - reader->start : end - reader->start;
}

static void add_error(struct check *check, size_t source, const struct rkm04_reader *reader, enum rkm04_read found)
{
    char message[256] = "", hint[HINT_SIZE];
    const bool open = found == RKM04_READ_UNKNOWN && byte_at(reader, reader->start) == '{';
    const struct diagnostic what = {.source = source,
                                    .offset = reader->start,
                                    .length = error_length(reader, found),
                                    .severity = DIAGNOSTIC_ERROR,
                                    .name = found == RKM04_READ_BAD_VALUE ? "bad-value"
                                            : open                        ? "open-comment"
                                                                          : "unknown-command"};
    FILE *out = fmemopen(message, sizeof message, "w");
    if (out == NULL) {
        check->found->no_memory = true;
        return;
    }
    diagnose_error(reader, found, out);
    fclose(out);
    message[sizeof message - 1] = '\0';
    diagnostics_add(check->found, &what, find_hint(reader, found, hint) ? hint : NULL, "%s", message);
}

static void notice(void *context, size_t source, const struct rkm04_reader *reader, enum rkm04_read found,
                   struct rkm04_command command)
{
    struct reading *reading = context;
    if (found != RKM04_READ_COMMAND) {
        if (reading->check->found->errors < DIAGNOSTICS_MAX)
            add_error(reading->check, source, reader, found);
        else
            reading->check->found->errors++;
        return;
    }
    struct diagnostic place = {.source = source, .offset = reader->start, .length = reader->at - reader->start};
    if (reading->requests++ == 0) {
        reading->request_offset = reader->start;
        return; /* it may be the sole command */
    }
    check_warn_at(reading->check, place, CHECK_STAND_ALONE, "send it alone, in a message of its own",
                  "%s inside a program is ignored", command.op == 'K' ? "K" : "C75");
}

static void report_first_request(struct reading *reading, size_t source)
{
    const char op = reading->check->texts[source][reading->request_offset];
    const struct diagnostic place = {.source = source, .offset = reading->request_offset, .length = op == 'K' ? 1 : 3};
    check_warn_at(reading->check, place, CHECK_STAND_ALONE, "send it alone, in a message of its own",
                  "%s inside a program is ignored", op == 'K' ? "K" : "C75");
}

/* What the unit with these readings refuses besides. */
static void check_negative(struct check *check, const struct check_motor *motor, size_t from)
{
    for (size_t i = from; i < motor->code.count; i++) {
        const struct rkm04_command command = motor->code.commands[i].command;
        if (check->options->readings.negative_position == RKM04_NEGATIVE_POSITION_YES || command.op != '=' ||
            command.argument <= INT32_MAX)
            continue;
        struct diagnostic place = code_place(&motor->code, i, i);
        place.severity = DIAGNOSTIC_ERROR;
        place.name = "bad-value";
        diagnostics_add(check->found, &place, NULL,
                        "expected a number from 0 on after =, found %d (reading negative-position=no)",
                        (int)(int32_t)command.argument);
    }
}

/* A typographic apostrophe in UTF-8 that is a call: rkm04 and rkmctl map it, other programs do not. */
static void check_apostrophes(struct check *check, const struct check_motor *motor, size_t from)
{
    for (size_t i = from; i < motor->code.count; i++) {
        const struct code_command *command = &motor->code.commands[i];
        const unsigned char *text = (const unsigned char *)check->sources[command->source].text + command->offset;
        if (command->command.op != '\'' || text[0] < 0xC2)
            continue;
        check_warn(check, motor, CHECK_APOSTROPHE, i, i, "rkm04 fmt writes the plain one",
                   "a typographic apostrophe; rkm04 and rkmctl send ' for it, other programs may not");
    }
}

bool check_read(struct check *check, struct check_motor *motor, size_t source)
{
    struct reading reading = {.check = check};
    const size_t from = motor->code.count;
    if (!code_read(&motor->code, source, check->texts[source], notice, &reading))
        return false;
    if (reading.requests > 0 && (reading.requests > 1 || motor->code.count > from))
        report_first_request(&reading, source);
    check_negative(check, motor, from);
    check_apostrophes(check, motor, from);
    return true;
}
