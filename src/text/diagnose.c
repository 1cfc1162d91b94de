/* SPDX-License-Identifier: MIT */
#include "diagnose.h"

#include <inttypes.h>
#include <limits.h>
#include <stdbool.h>
#include <string.h>

#include <rkm04/text.h>

#include "error_lines.h"
#include "invisible.h"

/* ---- Characters and places ---------------------------------------------------------------------------------------- */

size_t text_character_length(const char *text, size_t length, size_t at)
{
    const unsigned char *c = (const unsigned char *)text + at;
    size_t bytes = c[0] >= 0xF0 && c[0] <= 0xF4 ? 4 : c[0] >= 0xE0 && c[0] < 0xF0 ? 3 : c[0] >= 0xC2 && c[0] < 0xE0 ? 2 : 1;
    if (bytes > length - at)
        return 1;
    for (size_t i = 1; i < bytes; i++)
        if ((c[i] & 0xC0) != 0x80)
            return 1;
    return bytes;
}

struct text_place text_place_begin(const char *text, size_t length)
{
    return (struct text_place){.text = text, .length = length, .line = 1, .column = 1};
}

void text_place_move(struct text_place *place, size_t offset)
{
    while (place->at < offset && place->at < place->length) {
        if (place->text[place->at] == '\n') {
            place->line++;
            place->column = 1;
        } else {
            place->column++;
        }
        place->at += text_character_length(place->text, place->length, place->at);
    }
}

/* ---- Words -------------------------------------------------------------------------------------------------------- */

/* "1..8, 40..58 or 100" */
static void print_ranges(const struct rkm04_range *ranges, int count, FILE *out)
{
    for (int i = 0; i < count; i++) {
        fputs(i == 0 ? "" : i == count - 1 ? " or " : ", ", out);
        fprintf(out, "%" PRId32, ranges[i].low);
        if (ranges[i].high != ranges[i].low)
            fprintf(out, "..%" PRId32, ranges[i].high);
    }
}

static bool is_digit(char character)
{
    return '0' <= character && character <= '9';
}

/* "99999", "'x'", "the end of the text": what was found where something else was expected. */
static void print_found(const struct rkm04_reader *reader, FILE *out)
{
    const char *text = (const char *)reader->text;
    size_t at = reader->wrong;
    while (at < reader->length && reader->text[at] <= 0x20)
        at++;
    if (at >= reader->length) {
        fputs("the end of the text", out);
        return;
    }
    size_t end = at + ((text[at] == '-' || text[at] == '+') && at + 1 < reader->length);
    if (is_digit(text[end])) {
        while (end < reader->length && is_digit(text[end]))
            end++;
        int shown = end - at > 24 ? 24 : (int)(end - at);
        fprintf(out, "%.*s%s", shown, text + at, end - at > 24 ? "..." : "");
        return;
    }
    size_t bytes = text_character_length(text, reader->length, at);
    bool control = bytes == 2 && reader->text[at] == 0xC2 && reader->text[at + 1] < 0xA0;
    const char *name = invisible_name(text + at, bytes);
    if (name != NULL)
        fputs(name, out);
    else if (control || (bytes == 1 && reader->text[at] >= 0x7F))
        fprintf(out, "byte %02X", reader->text[at]);
    else
        fprintf(out, "'%.*s'", (int)bytes, text + at);
}

/* Which part of `I 01 H 20` does not fit: what precedes it decides. */
static void print_jump_if(const struct rkm04_reader *reader, const struct rkm04_range ranges[RKM04_RANGES_MAX], FILE *out)
{
    bool number = false, level = false;
    for (size_t i = reader->start + 1; i < reader->wrong && i < reader->length; i++) {
        number = number || is_digit((char)reader->text[i]);
        level = level || reader->text[i] == 'H' || reader->text[i] == 'L';
    }
    if (level) {
        fputs("a label ", out);
        print_ranges(ranges + 2, 1, out);
        fputs(" after H or L of I", out);
    } else if (number) {
        fputs("H or L after the input of I", out);
    } else {
        fputs("an input or variable ", out);
        print_ranges(ranges, 2, out);
        fputs(" after I", out);
    }
}

static void print_bad_value(const struct rkm04_reader *reader, FILE *out)
{
    enum rkm04_form form = RKM04_FORM_NONE;
    struct rkm04_range ranges[RKM04_RANGES_MAX] = {0};
    uint8_t op = reader->text[reader->start];
    int count = rkm04_form_of(op, &form, ranges);
    fputs("expected ", out);
    if (form == RKM04_FORM_JUMP_IF) {
        print_jump_if(reader, ranges, out);
    } else {
        fputs("a number ", out);
        print_ranges(ranges, count, out);
        /* The call is spelled in several ways; 0x27 is the one to write. */
        fprintf(out, "%s after %c", form == RKM04_FORM_ABSOLUTE ? ", + or -" : "", op == '"' || op >= 0x7F ? '\'' : op);
    }
    fputs(", found ", out);
    print_found(reader, out);
}

static void print_unknown(const struct rkm04_reader *reader, FILE *out)
{
    uint8_t character = reader->text[reader->start];
    enum rkm04_form form;
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    if (character == '{') {
        fputs("expected a } that ends this comment", out);
        return;
    }
    fputs("expected a command, found ", out);
    print_found(reader, out);
    uint8_t upper = (uint8_t)(character - 'a' + 'A');
    if ('a' <= character && character <= 'z' && rkm04_form_of(upper, &form, ranges) >= 0)
        fprintf(out, "; commands are capital letters: %c", upper);
    else if (character == '}')
        fputs("; no comment is open here", out);
}

void diagnose_error(const struct rkm04_reader *reader, enum rkm04_read found, FILE *out)
{
    if (found == RKM04_READ_BAD_VALUE)
        print_bad_value(reader, out);
    else
        print_unknown(reader, out);
}

/* ---- The whole text ----------------------------------------------------------------------------------------------- */

enum rkm04_read diagnose_read(struct rkm04_reader *reader, struct rkm04_command *command)
{
    const enum rkm04_read found = rkm04_read(reader, command);
    if (found != RKM04_READ_BAD_VALUE && found != RKM04_READ_UNKNOWN)
        return found;
    size_t end = reader->length;
    if (reader->wrong < end)
        end = reader->wrong + text_character_length((const char *)reader->text, end, reader->wrong);
    if (reader->at > reader->wrong && reader->at < end)
        reader->at = end;
    return found;
}

int diagnose_text(const char *name, const char *text, size_t length, FILE *out)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    enum rkm04_read found;
    struct text_place place = text_place_begin(text, length);
    struct error_lines errors = {0};
    rkm04_read_begin(&reader, text, length);
    while ((found = diagnose_read(&reader, &command)) != RKM04_READ_END) {
        if (found == RKM04_READ_COMMAND || !error_lines_add(&errors))
            continue;
        text_place_move(&place, reader.start);
        fprintf(out, "%s:%zu:%zu: error: ", name, place.line, place.column);
        diagnose_error(&reader, found, out);
        fputc('\n', out);
    }
    error_lines_end(&errors, name, out);
    return errors.count < INT_MAX ? (int)errors.count : INT_MAX;
}

int diagnose_readings(const char *name, const char *text, size_t length, const struct rkm04_readings *readings, FILE *out)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    struct text_place place = text_place_begin(text, length);
    struct error_lines errors = {0};
    rkm04_read_begin(&reader, text, length);
    while (readings->negative_position == RKM04_NEGATIVE_POSITION_NO && rkm04_read(&reader, &command) == RKM04_READ_COMMAND) {
        if (command.op != '=' || command.argument <= INT32_MAX || !error_lines_add(&errors))
            continue;
        text_place_move(&place, reader.start);
        fprintf(out, "%s:%zu:%zu: error: expected a number from 0 on after =, found %" PRId32, name, place.line, place.column,
                (int32_t)command.argument);
        fputs(" (--readings negative-position=no)\n", out);
    }
    error_lines_end(&errors, name, out);
    return errors.count < INT_MAX ? (int)errors.count : INT_MAX;
}
