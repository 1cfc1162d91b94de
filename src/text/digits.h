/* SPDX-License-Identifier: MIT */
/* digits.h: text put together by hand, character by character. A trace has a row a pulse: printf would be most of the run time.
 * All write at `at`, where there must be room, without a terminating zero, and return where the text ends. */
#ifndef RKM04_TEXT_DIGITS_H
#define RKM04_TEXT_DIGITS_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define DIGITS_MAX 20u /* characters of the longest number, its sign included */

static inline char *put_text(char *at, const char *text)
{
    size_t length = strlen(text);
    memcpy(at, text, length);
    return at + length;
}

static inline char *put_number(char *at, uint64_t number)
{
    char digits[DIGITS_MAX];
    size_t n = DIGITS_MAX;
    while (number > UINT32_MAX) {
        digits[--n] = (char)('0' + number % 10u);
        number /= 10u;
    }
    uint32_t rest = (uint32_t)number; /* divides faster */
    do {
        digits[--n] = (char)('0' + rest % 10u);
        rest /= 10u;
    } while (rest > 0);
    memcpy(at, digits + n, DIGITS_MAX - n);
    return at + (DIGITS_MAX - n);
}

static inline char *put_signed(char *at, int32_t number)
{
    if (number < 0)
        *at++ = '-';
    return put_number(at, (uint64_t)(number < 0 ? -(int64_t)number : number));
}

/* "7E03", without blanks. */
static inline char *put_hex(char *at, const uint8_t *bytes, size_t length)
{
    static const char digits[] = "0123456789ABCDEF";
    for (size_t i = 0; i < length; i++) {
        *at++ = digits[bytes[i] >> 4];
        *at++ = digits[bytes[i] & 0xFu];
    }
    return at;
}

#endif
