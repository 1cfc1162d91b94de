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
    static const char pairs[] = "0001020304050607080910111213141516171819"
                                "2021222324252627282930313233343536373839"
                                "4041424344454647484950515253545556575859"
                                "6061626364656667686970717273747576777879"
                                "8081828384858687888990919293949596979899";
    char digits[DIGITS_MAX];
    size_t n = DIGITS_MAX;
    while (number > UINT32_MAX) {
        digits[--n] = (char)('0' + number % 10u);
        number /= 10u;
    }
    uint32_t rest = (uint32_t)number; /* divides faster */
    for (; rest >= 10u; rest /= 100u) {
        const char *pair = pairs + 2u * (rest % 100u);
        digits[--n] = pair[1];
        digits[--n] = pair[0];
    }
    if (rest > 0 || n == DIGITS_MAX)
        digits[--n] = (char)('0' + rest);
    memcpy(at, digits + n, DIGITS_MAX - n);
    return at + (DIGITS_MAX - n);
}

static inline char *put_signed(char *at, int64_t number)
{
    if (number < 0)
        *at++ = '-';
    return put_number(at, number < 0 ? 0u - (uint64_t)number : (uint64_t)number);
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
