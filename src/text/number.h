/* SPDX-License-Identifier: MIT */
/* number.h: whole numbers out of texts that people and other programs write. Every number of an option, an address or a command
 * is read here: strtol() and its kin take blanks and signs, some of them wrap, and none knows what is allowed. */
#ifndef RKM04_TEXT_NUMBER_H
#define RKM04_TEXT_NUMBER_H

#include <stdbool.h>
#include <stdint.h>

/* Read a decimal number low..high: digits and nothing else. Returns false, *number as it was, if the text is none. */
static inline bool number_read(const char *text, uint64_t low, uint64_t high, uint64_t *number)
{
    uint64_t value = 0;
    if (*text == '\0')
        return false;
    for (; *text != '\0'; text++) {
        if (*text < '0' || *text > '9')
            return false;
        unsigned digit = (unsigned)(*text - '0');
        if (digit > high || value > (high - digit) / 10)
            return false;
        value = value * 10 + digit;
    }
    if (value < low)
        return false;
    *number = value;
    return true;
}

/* The same with an optional sign in front. */
static inline bool number_read_signed(const char *text, int64_t low, int64_t high, int64_t *number)
{
    bool negative = *text == '-';
    uint64_t size;
    if (!number_read(text + (negative || *text == '+'), 0, (uint64_t)INT64_MAX + negative, &size))
        return false;
    int64_t value = !negative ? (int64_t)size : size > 0 ? -(int64_t)(size - 1) - 1 : 0;
    if (value < low || value > high)
        return false;
    *number = value;
    return true;
}

#endif
