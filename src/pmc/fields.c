/* SPDX-License-Identifier: MIT */
#include "fields.h"

#include <string.h>

#define TENTHS_MIN (-83886080)
#define TENTHS_MAX 83886070
#define UNITS_MAX 9999999 /* seven digits */

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* ---- Reading ------------------------------------------------------------------------------------------------------------ */

bool pmc_reader_next(struct pmc_reader *reader)
{
    if (reader->at >= reader->length)
        return false;
    size_t end = reader->at;
    while (end < reader->length && reader->text[end] != '\n')
        end++;
    reader->line++;
    reader->begin = reader->at;
    reader->end = reader->begin;
    while (reader->end < end && reader->text[reader->end] != '#')
        reader->end++;
    while (reader->end > reader->begin && is_blank(reader->text[reader->end - 1u]))
        reader->end--;
    reader->at = end + 1u;
    return true;
}

/* The column of a place in the present line. */
static unsigned column_of(const struct pmc_reader *reader, size_t place)
{
    size_t begin = place;
    while (begin > 0 && reader->text[begin - 1u] != '\n')
        begin--;
    return (unsigned)(place - begin) + 1u;
}

static void skip_blanks(struct pmc_reader *reader)
{
    while (reader->begin < reader->end && is_blank(reader->text[reader->begin]))
        reader->begin++;
}

struct pmc_field pmc_reader_field(struct pmc_reader *reader, const char *stops)
{
    skip_blanks(reader);
    size_t begin = reader->begin;
    while (reader->begin < reader->end) {
        char c = reader->text[reader->begin];
        if (is_blank(c) || (c != '\0' && strchr(stops, c) != NULL))
            break;
        reader->begin++;
    }
    return (struct pmc_field){reader->text + begin, reader->begin - begin, column_of(reader, begin)};
}

bool pmc_reader_take(struct pmc_reader *reader, char c)
{
    skip_blanks(reader);
    bool found = reader->begin < reader->end && reader->text[reader->begin] == c;
    reader->begin += found;
    return found;
}

static void report(struct pmc_reader *reader, const struct pmc_text_error *error)
{
    if (reader->report)
        reader->report(reader->context, error);
}

bool pmc_reader_fail(struct pmc_reader *reader, const struct pmc_field *field, const char *expected)
{
    report(reader, &(struct pmc_text_error){.line = reader->line, .column = field->column, .text = expected});
    reader->is_wrong = true;
    return false;
}

void pmc_reader_warn(struct pmc_reader *reader, unsigned line, unsigned column, const char *text)
{
    report(reader, &(struct pmc_text_error){.line = line, .column = column, .is_warning = true, .text = text});
}

bool pmc_field_is(const struct pmc_field *field, const char *text)
{
    return strlen(text) == field->length && memcmp(text, field->text, field->length) == 0;
}

/* Digits, and how far they go. Returns false if there are none, or they are more than `most`. */
static bool read_digits(const struct pmc_field *field, size_t *at, int32_t most, int32_t *number)
{
    size_t begin = *at;
    *number = 0;
    for (; *at < field->length && is_digit(field->text[*at]); ++*at) {
        int32_t digit = field->text[*at] - '0';
        if (*number > (most - digit) / 10)
            return false;
        *number = *number * 10 + digit;
    }
    return *at > begin;
}

static bool read_sign(const struct pmc_field *field, size_t *at)
{
    bool is_signed = field->length > 0 && (field->text[0] == '-' || field->text[0] == '+');
    *at = is_signed;
    return is_signed && field->text[0] == '-';
}

bool pmc_field_number(const struct pmc_field *field, int32_t low, int32_t high, int32_t *number)
{
    size_t at;
    bool minus = read_sign(field, &at);
    if (!read_digits(field, &at, INT32_MAX, number) || at != field->length)
        return false;
    *number = minus ? -*number : *number;
    return *number >= low && *number <= high;
}

static int hex_digit(char c)
{
    static const char digits[] = "0123456789ABCDEF0123456789abcdef";
    const char *found = c != '\0' ? strchr(digits, c) : NULL;
    return found ? (int)(found - digits) & 15 : -1;
}

bool pmc_field_bits(const struct pmc_field *field, int32_t high, int32_t *number)
{
    *number = 0;
    if (field->length != 6 || field->text[0] != '0' || field->text[1] != 'x')
        return false;
    for (size_t at = 2; at < field->length; at++) {
        int digit = hex_digit(field->text[at]);
        if (digit < 0)
            return false;
        *number = *number * 16 + digit;
    }
    return *number <= high;
}

bool pmc_field_tenths(const struct pmc_field *field, int32_t *tenths)
{
    size_t at;
    int32_t whole;
    bool minus = read_sign(field, &at);
    if (!read_digits(field, &at, UNITS_MAX, &whole))
        return false;
    *tenths = whole * 10;
    if (at + 2 == field->length && field->text[at] == '.' && is_digit(field->text[at + 1])) {
        *tenths += field->text[at + 1] - '0';
        at += 2;
    }
    *tenths = minus ? -*tenths : *tenths;
    return at == field->length && *tenths >= TENTHS_MIN && *tenths <= TENTHS_MAX;
}

/* ---- Writing ------------------------------------------------------------------------------------------------------------ */

static void put(struct pmc_writer *writer, char c)
{
    if (writer->length < writer->room)
        writer->text[writer->length] = c;
    writer->length++;
}

void pmc_write(struct pmc_writer *writer, const char *text)
{
    for (; *text != '\0'; text++)
        put(writer, *text);
}

void pmc_write_number(struct pmc_writer *writer, int32_t number, unsigned digits)
{
    uint32_t magnitude = number < 0 ? 0u - (uint32_t)number : (uint32_t)number, place = 1;
    if (number < 0)
        put(writer, '-');
    for (unsigned i = 1; i < digits || magnitude / place >= 10; i++)
        place *= 10;
    for (; place > 0; place /= 10)
        put(writer, (char)('0' + magnitude / place % 10u));
}

void pmc_write_tenths(struct pmc_writer *writer, int32_t tenths)
{
    int32_t rest = tenths % 10;
    if (tenths < 0)
        put(writer, '-');
    pmc_write_number(writer, tenths < 0 ? -(tenths / 10) : tenths / 10, 1);
    if (rest != 0) {
        put(writer, '.');
        put(writer, (char)('0' + (rest < 0 ? -rest : rest)));
    }
}

void pmc_write_bits(struct pmc_writer *writer, int32_t bits)
{
    pmc_write(writer, "0x");
    for (unsigned shift = 16; shift > 0;) {
        shift -= 4;
        put(writer, "0123456789ABCDEF"[(uint32_t)bits >> shift & 15u]);
    }
}
