/* SPDX-License-Identifier: MIT */
/* parse.c: program text -> commands, and commands -> canonical text (specification section 5, P8).
 *
 * What a command looks like is in commands.h; how each form of operand is read, checked and written is in `forms`.
 * The characters: blanks are all up to 0x20, a comment is { ... } and may be between commands only. */
#include <rkm04/text.h>

#include "commands.h"

enum form_index { FORM_NONE, FORM_NUMBER, FORM_BIT, FORM_SIGNED, FORM_ABSOLUTE, FORM_JUMP_IF };

struct row {
    uint8_t form; /* enum form_index; meaningful if `known` */
    bool known;
    struct rkm04_range ranges[RKM04_RANGES_MAX]; /* unused ones are RANGE_NONE */
};

/* Indexed by character, from the first one that is a command. A row given twice does not compile. */
#define FIRST_COMMAND '\''
#define ROW(character, name, form, ...) [(character) - FIRST_COMMAND] = {FORM_##form, true, {__VA_ARGS__}},
static const struct row rows[] = {COMMAND_TABLE(ROW)};
#undef ROW

#define NOTHING_WRONG SIZE_MAX /* no offset in any text */

/* ---- Rows and ranges ---------------------------------------------------------------------------------------------- */

static const struct row *find_row(uint8_t op)
{
    if (op < FIRST_COMMAND || (size_t)(op - FIRST_COMMAND) >= sizeof rows / sizeof rows[0])
        return NULL;
    const struct row *row = &rows[op - FIRST_COMMAND];
    return row->known ? row : NULL;
}

/* The manual typesets the call in several ways: also taken are ", the acute accent and the low quote of code page 1250. */
static uint8_t canonical_op(uint8_t character)
{
    return character == 0x22 || character == 0xB4 || character == 0x84 ? '\'' : character;
}

static unsigned range_count(const struct row *row)
{
    unsigned count = 0;
    while (count < RKM04_RANGES_MAX && (row->ranges[count].low != 0 || row->ranges[count].high != 0))
        count++;
    return count;
}

/* Is the value in one of the ranges first .. first + count - 1? */
static bool in_ranges(const struct row *row, unsigned first, unsigned count, int64_t value)
{
    for (unsigned i = first; i < first + count; i++)
        if (row->ranges[i].low <= value && value <= row->ranges[i].high)
            return true;
    return false;
}

/* ---- Characters --------------------------------------------------------------------------------------------------- */

/* The next character, or 0 at the end: as good as any that fits nowhere once blanks have been skipped. */
static uint8_t peek(const struct rkm04_reader *reader)
{
    return reader->at < reader->length ? reader->text[reader->at] : 0;
}

static bool at_digit(const struct rkm04_reader *reader)
{
    uint8_t character = peek(reader);
    return '0' <= character && character <= '9';
}

static void skip_blanks(struct rkm04_reader *reader)
{
    while (reader->at < reader->length && reader->text[reader->at] <= 0x20)
        reader->at++;
}

/* Pass over blanks and comments, up to a command, the end, or a '{' that is never closed. */
static void skip_to_command(struct rkm04_reader *reader)
{
    for (skip_blanks(reader); peek(reader) == '{'; skip_blanks(reader)) {
        size_t end = reader->at;
        while (end < reader->length && reader->text[end] != '}')
            end++;
        if (end == reader->length)
            return;
        reader->at = end + 1;
    }
}

/* The first thing that does not fit is the one reported. */
static void refuse(struct rkm04_reader *reader, size_t where)
{
    if (reader->wrong == NOTHING_WRONG)
        reader->wrong = where;
}

/* Read a number without sign. What does not fit into 32 bits becomes UINT32_MAX, which is in no range. */
static uint32_t take_number(struct rkm04_reader *reader)
{
    skip_blanks(reader);
    if (!at_digit(reader))
        refuse(reader, reader->at);
    uint32_t number = 0;
    for (; at_digit(reader); reader->at++) {
        uint32_t digit = (uint32_t)(peek(reader) - '0');
        number = number > (UINT32_MAX - 9) / 10 ? UINT32_MAX : 10 * number + digit;
    }
    return number;
}

static uint32_t take_in_ranges(struct rkm04_reader *reader, const struct row *row, unsigned first, unsigned count)
{
    skip_blanks(reader);
    size_t begin = reader->at;
    uint32_t number = take_number(reader);
    if (!in_ranges(row, first, count, number))
        refuse(reader, begin);
    return number;
}

static bool take_character(struct rkm04_reader *reader, uint8_t character)
{
    skip_blanks(reader);
    if (peek(reader) != character)
        return false;
    reader->at++;
    return true;
}

static size_t put_number(char *text, uint32_t number, unsigned digits)
{
    char reversed[10];
    size_t length = 0;
    for (; number != 0 || length < digits; number /= 10)
        reversed[length++] = (char)('0' + number % 10);
    for (size_t i = 0; i < length; i++)
        text[i] = reversed[length - 1 - i];
    return length;
}

/* ---- The forms of operands ---------------------------------------------------------------------------------------- */

static uint32_t read_none(struct rkm04_reader *reader, const struct row *row)
{
    (void)reader, (void)row;
    return 0;
}

static bool valid_none(const struct row *row, uint32_t argument)
{
    (void)row;
    return argument == 0;
}

static size_t format_none(char *text, uint32_t argument)
{
    (void)text, (void)argument;
    return 0;
}

static uint32_t read_number(struct rkm04_reader *reader, const struct row *row)
{
    return take_in_ranges(reader, row, 0, range_count(row));
}

static bool valid_number(const struct row *row, uint32_t argument)
{
    return in_ranges(row, 0, range_count(row), argument);
}

static size_t format_number(char *text, uint32_t argument)
{
    return put_number(text, argument, 1);
}

static size_t format_bit(char *text, uint32_t argument)
{
    return put_number(text, argument, 2);
}

static uint32_t read_signed(struct rkm04_reader *reader, const struct row *row)
{
    skip_blanks(reader);
    size_t begin = reader->at;
    bool negative = take_character(reader, '-');
    int64_t value = take_number(reader);
    if (negative)
        value = -value;
    if (!in_ranges(row, 0, range_count(row), value))
        refuse(reader, begin);
    return (uint32_t)value;
}

static int64_t signed_value(uint32_t argument)
{
    return argument <= INT32_MAX ? (int64_t)argument : (int64_t)argument - UINT32_MAX - 1;
}

static bool valid_signed(const struct row *row, uint32_t argument)
{
    return in_ranges(row, 0, range_count(row), signed_value(argument));
}

static size_t format_signed(char *text, uint32_t argument)
{
    if (signed_value(argument) >= 0)
        return format_number(text, argument);
    text[0] = '-';
    return 1 + format_number(text + 1, 0 - argument);
}

static uint32_t read_absolute(struct rkm04_reader *reader, const struct row *row)
{
    if (take_character(reader, '+'))
        return RKM04_G_FORWARD;
    if (take_character(reader, '-'))
        return RKM04_G_BACK;
    return read_number(reader, row);
}

static bool valid_absolute(const struct row *row, uint32_t argument)
{
    return argument == RKM04_G_FORWARD || argument == RKM04_G_BACK || valid_number(row, argument);
}

static size_t format_absolute(char *text, uint32_t argument)
{
    if (argument != RKM04_G_FORWARD && argument != RKM04_G_BACK)
        return format_number(text, argument);
    text[0] = argument == RKM04_G_FORWARD ? '+' : '-';
    return 1;
}

/* Parts after one that does not fit are read too, so that they are not taken for commands when reading continues. */
static uint32_t read_jump_if(struct rkm04_reader *reader, const struct row *row)
{
    uint32_t bit = take_in_ranges(reader, row, 0, 2);
    bool high = take_character(reader, 'H');
    if (!high && !take_character(reader, 'L'))
        refuse(reader, reader->at);
    uint32_t label = take_in_ranges(reader, row, 2, 1);
    return bit | (uint32_t)high << 8 | label << 16;
}

static bool valid_jump_if(const struct row *row, uint32_t argument)
{
    return in_ranges(row, 0, 2, argument & 0xFF) && (argument >> 8 & 0xFF) <= 1 && in_ranges(row, 2, 1, argument >> 16);
}

static size_t format_jump_if(char *text, uint32_t argument)
{
    size_t length = format_bit(text, argument & 0xFF);
    text[length++] = argument >> 8 & 0xFF ? 'H' : 'L';
    return length + put_number(text + length, argument >> 16, 1);
}

static const struct form {
    enum rkm04_form form;
    uint32_t (*read)(struct rkm04_reader *reader, const struct row *row); /* refuses what does not fit */
    bool (*valid)(const struct row *row, uint32_t argument);
    size_t (*format)(char *text, uint32_t argument); /* returns the length */
} forms[] = {
    [FORM_NONE] = {RKM04_FORM_NONE, read_none, valid_none, format_none},
    [FORM_NUMBER] = {RKM04_FORM_NUMBER, read_number, valid_number, format_number},
    [FORM_BIT] = {RKM04_FORM_NUMBER, read_number, valid_number, format_bit},
    [FORM_SIGNED] = {RKM04_FORM_SIGNED, read_signed, valid_signed, format_signed},
    [FORM_ABSOLUTE] = {RKM04_FORM_ABSOLUTE, read_absolute, valid_absolute, format_absolute},
    [FORM_JUMP_IF] = {RKM04_FORM_JUMP_IF, read_jump_if, valid_jump_if, format_jump_if},
};

/* ---- Calls -------------------------------------------------------------------------------------------------------- */

/* Leave what is wrong to the caller: the character that did not fit, unless it begins something itself, and the number that
 * follows directly. So one slip is one error when the rest is read. */
static void pass_over_error(struct rkm04_reader *reader)
{
    uint8_t next = peek(reader);
    if (reader->at == reader->wrong && reader->at < reader->length && next != '{' && !find_row(canonical_op(next)))
        reader->at++;
    while (at_digit(reader) || peek(reader) == '+' || peek(reader) == '-')
        reader->at++;
}

void rkm04_read_begin(struct rkm04_reader *reader, const void *text, size_t length)
{
    *reader = (struct rkm04_reader){.text = text, .length = length, .wrong = NOTHING_WRONG};
}

enum rkm04_read rkm04_read(struct rkm04_reader *reader, struct rkm04_command *command)
{
    skip_to_command(reader);
    reader->start = reader->at;
    reader->wrong = NOTHING_WRONG;
    if (reader->at == reader->length)
        return RKM04_READ_END;

    uint8_t op = canonical_op(peek(reader));
    const struct row *row = find_row(op);
    if (row == NULL) {
        reader->wrong = reader->start;
        if (op == '{')
            reader->at = reader->length; /* all the rest was meant as a comment */
        else
            pass_over_error(reader);
        return RKM04_READ_UNKNOWN;
    }

    reader->at++;
    uint32_t argument = forms[row->form].read(reader, row);
    if (reader->wrong != NOTHING_WRONG) {
        pass_over_error(reader);
        return RKM04_READ_BAD_VALUE;
    }
    *command = (struct rkm04_command){op, argument};
    return RKM04_READ_COMMAND;
}

bool rkm04_command_valid(struct rkm04_command command)
{
    const struct row *row = find_row(command.op);
    return row != NULL && forms[row->form].valid(row, command.argument);
}

size_t rkm04_format(struct rkm04_command command, char text[RKM04_COMMAND_TEXT_MAX])
{
    const struct row *row = find_row(command.op);
    text[0] = (char)command.op;
    return row == NULL ? 1 : 1 + forms[row->form].format(text + 1, command.argument);
}

int rkm04_form_of(uint8_t op, enum rkm04_form *form, struct rkm04_range ranges[RKM04_RANGES_MAX])
{
    const struct row *row = find_row(canonical_op(op));
    if (row == NULL)
        return -1;
    *form = forms[row->form].form;
    unsigned count = range_count(row);
    for (unsigned i = 0; i < count; i++)
        ranges[i] = row->ranges[i];
    return (int)count;
}
