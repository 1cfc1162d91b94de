/* SPDX-License-Identifier: MIT */
/* Names of a PLC program in a table with buckets, and numbers of its text. */
#include <string.h>

#include "names.h"

void cnc_clear_names(struct cnc_names *names)
{
    memset(names->buckets, 0xFF, sizeof names->buckets);
    names->count = 0;
}

static unsigned bucket_of(unsigned scope, const char *text, size_t length)
{
    uint32_t sum = scope;

    for (size_t i = 0; i < length; i++)
        sum = sum * 31 + ((uint8_t)text[i] & 0xDFu); /* the same for letters in either case */
    return (sum ^ sum >> 16) % CNC_SYMBOLS_MAX;
}

const struct cnc_symbol *cnc_find_symbol(const struct cnc_names *names, unsigned scope, const char *text, size_t length)
{
    for (unsigned at = names->buckets[bucket_of(scope, text, length)]; at != CNC_NO_SYMBOL; at = names->symbols[at].next)
        if (names->symbols[at].scope == scope && cnc_same_name(names->symbols[at].name, text, length))
            return &names->symbols[at];
    return NULL;
}

struct cnc_symbol *cnc_add_symbol(struct cnc_names *names, unsigned scope, const char *text, size_t length)
{
    if (names->count == CNC_SYMBOLS_MAX)
        return NULL;
    struct cnc_symbol *symbol = &names->symbols[names->count];
    uint16_t *bucket = &names->buckets[bucket_of(scope, text, length)];
    memset(symbol, 0, sizeof *symbol);
    memcpy(symbol->name, text, length);
    symbol->scope = (uint16_t)scope;
    symbol->next = *bucket;
    *bucket = names->count++;
    return symbol;
}

static bool is_digit(char letter)
{
    return letter >= '0' && letter <= '9';
}

bool cnc_is_name_letter(char letter)
{
    return is_digit(letter) || (letter >= 'A' && letter <= 'Z') || (letter >= 'a' && letter <= 'z') || letter == '_' ||
           letter == '?' || letter == '@';
}

size_t cnc_name_length(const char *text, size_t length)
{
    size_t letters = 0;

    if (length > 0 && is_digit(*text))
        return 0;
    while (letters < length && cnc_is_name_letter(text[letters]))
        letters++;
    return letters;
}

/* Bytes of a quotation mark: ', U+2018 or U+2019. */
static size_t mark_length(const char *text, size_t length)
{
    if (length >= 1 && text[0] == '\'')
        return 1;
    return length >= 3 && (memcmp(text, "\xE2\x80\x98", 3) == 0 || memcmp(text, "\xE2\x80\x99", 3) == 0) ? 3 : 0;
}

size_t cnc_quoted_length(const char *text, size_t length, int64_t *value)
{
    size_t before = mark_length(text, length);

    if (before == 0 || length <= before + 1 || text[before] < ' ' || text[before] > '~')
        return 0;
    size_t after = mark_length(text + before + 1, length - before - 1);
    if (after == 0)
        return 0;
    *value = (unsigned char)text[before];
    return before + 1 + after;
}

/* Value of a digit, 16 if it is none. */
static unsigned digit_of(char letter)
{
    if (is_digit(letter))
        return (unsigned)(letter - '0');
    letter = (char)(letter | 0x20);
    return letter >= 'a' && letter <= 'f' ? (unsigned)(letter - 'a') + 10 : 16;
}

bool cnc_parse_number(const char *text, size_t length, int64_t *value)
{
    uint64_t sum = 0;

    if (length > 0 && cnc_quoted_length(text, length, value) == length)
        return true;
    if (length == 0 || !is_digit(*text))
        return false;
    unsigned base = text[length - 1] == 'h' || text[length - 1] == 'H' ? 16 : 10;
    if (base == 16)
        length--;
    for (; length > 0; text++, length--) {
        unsigned digit = digit_of(*text);
        if (digit >= base || sum > ((uint64_t)INT64_MAX - digit) / base)
            return false;
        sum = sum * base + digit;
    }
    *value = (int64_t)sum;
    return true;
}

bool cnc_find_constant(const char *text, size_t length, int64_t *value)
{
    static const struct {
        char name[19];
        uint8_t value;
    } constants[] = {{"PLCEVENT_START_REQ", 1}, {"BLOCK_IDLE", 0},  {"BLOCK_INIT", 1},
                     {"BLOCK_MOVE", 2},         {"BLOCK_DELAY", 3}, {"BLOCK_DONE", 4}};

    for (size_t i = 0; i < sizeof constants / sizeof *constants; i++) {
        if (cnc_same_name(constants[i].name, text, length)) {
            *value = constants[i].value;
            return true;
        }
    }
    return false;
}
