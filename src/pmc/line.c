/* SPDX-License-Identifier: MIT */
#include "line.h"

#define DIGITS_MAX 9u /* of a number that is read exactly */

struct reader {
    const char *text;
    size_t at, length;
    unsigned axes;
};

/* The next character; 0: the end. */
static char peek(const struct reader *reader)
{
    return reader->at < reader->length ? reader->text[reader->at] : '\0';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_sign(char c)
{
    return c == '+' || c == '-';
}

static void skip_blanks(struct reader *reader)
{
    while (peek(reader) == ' ')
        reader->at++;
}

/* Take an axis with its sign, if there is one. Returns false if it is wrong; *found: there was one. */
static bool read_axis(struct reader *reader, bool is_signed, struct pmc_line_operands *operands, bool *found)
{
    size_t at = reader->at;
    char sign = peek(reader);
    *found = false;
    if (is_signed && is_sign(sign))
        reader->at++;
    char letter = peek(reader);
    if (letter != 'X' && letter != 'Y')
        return reader->at == at; /* a sign alone is malformed */
    uint8_t bit = letter == 'X' ? 1 : 2;
    if (bit >> reader->axes != 0 || (operands->axes & bit) != 0)
        return false;
    operands->axes |= bit;
    if (reader->at == at || sign == '+')
        operands->forward |= bit;
    reader->at++;
    *found = true;
    return true;
}

static bool read_axes(struct reader *reader, bool is_signed, struct pmc_line_operands *operands)
{
    for (bool found = true; found;) {
        skip_blanks(reader);
        if (!read_axis(reader, is_signed, operands, &found))
            return false;
    }
    return operands->axes != 0;
}

/* Take a number, if there is one. Returns false if it is malformed. */
static bool read_number(struct reader *reader, int32_t *number, bool *found)
{
    char sign = peek(reader);
    unsigned digits = 0;
    int32_t value = 0;
    if (is_sign(sign))
        reader->at++;
    for (; is_digit(peek(reader)); reader->at++) {
        digits += digits > 0 || peek(reader) != '0'; /* zeros in front do not count */
        value = digits <= DIGITS_MAX ? value * 10 + (peek(reader) - '0') : PMC_LINE_LARGE;
        *found = true;
    }
    *number = sign == '-' ? -value : value;
    return *found || !is_sign(sign);
}

/* `[n][,[n]]`: an axis without a number is left alone. */
static bool read_numbers(struct reader *reader, struct pmc_line_operands *operands)
{
    for (unsigned axis = 0; axis < 2; axis++) {
        bool found = false;
        skip_blanks(reader);
        if (!read_number(reader, &operands->number[axis], &found) || (found && axis >= reader->axes))
            return false;
        operands->axes |= (uint8_t)(found ? 1u << axis : 0u);
        skip_blanks(reader);
        if (peek(reader) != ',')
            break;
        reader->at++;
    }
    return operands->axes != 0;
}

/* XY05: axes, then a register of two digits. */
static bool read_start(struct reader *reader, struct pmc_line_operands *operands)
{
    if (!read_axes(reader, false, operands))
        return false;
    size_t at = reader->at;
    while (is_digit(peek(reader)))
        reader->at++;
    if (reader->at - at != 2)
        return false;
    operands->reg = (uint8_t)((reader->text[at] - '0') * 10 + (reader->text[at + 1] - '0'));
    return true;
}

static bool read_value(struct reader *reader, struct pmc_line_operands *operands)
{
    bool found = false;
    return read_number(reader, &operands->number[0], &found) && found;
}

bool pmc_line_read(enum pmc_line_operand form, const char *text, size_t length, unsigned axes,
                   struct pmc_line_operands *operands)
{
    struct reader reader = {.text = text, .length = length, .axes = axes};
    *operands = (struct pmc_line_operands){0};
    skip_blanks(&reader);
    operands->is_empty = reader.at == length;
    switch (form) {
    case PMC_LINE_AXES:
        return read_axes(&reader, false, operands);
    case PMC_LINE_SIGNED:
        return read_axes(&reader, true, operands);
    case PMC_LINE_ONE:
        return read_axes(&reader, false, operands) && operands->axes != 3;
    case PMC_LINE_START:
        return read_start(&reader, operands);
    case PMC_LINE_NUMBERS:
        return read_numbers(&reader, operands);
    case PMC_LINE_VALUES:
        return operands->is_empty || read_numbers(&reader, operands);
    case PMC_LINE_VALUE:
        return operands->is_empty || read_value(&reader, operands);
    default:
        return true; /* PMC_LINE_NONE */
    }
}
