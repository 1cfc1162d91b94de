/* SPDX-License-Identifier: MIT */
#include "wide.h"

#ifndef __SIZEOF_INT128__

/* a * b. An ARMv6-M multiplies to 32 bits only; four such multiplications take half the time of its library's of 64 bits. */
static inline uint64_t product(uint32_t a, uint32_t b)
{
#ifdef __ARM_ARCH_6M__
    const uint32_t a0 = a & 0xffff, a1 = a >> 16, b0 = b & 0xffff, b1 = b >> 16;
    const uint32_t low = a0 * b0, middle = a1 * b0 + (low >> 16), other = a0 * b1 + (middle & 0xffff);
    return (uint64_t)(a1 * b1 + (middle >> 16) + (other >> 16)) << 32 | (other << 16 | (low & 0xffff));
#else
    return (uint64_t)a * b;
#endif
}

struct wide wide_product(uint64_t a, uint64_t b)
{
    const uint32_t a0 = (uint32_t)a, a1 = (uint32_t)(a >> 32), b0 = (uint32_t)b, b1 = (uint32_t)(b >> 32);
    if ((a0 | a1) == 0) /* speeds without places after the point: most of them */
        return (struct wide){0, 0};
    const uint64_t low = product(a0, b0), middle = product(a1, b0) + (low >> 32);
    const uint64_t other = product(a0, b1) + (uint32_t)middle;
    return (struct wide){product(a1, b1) + (middle >> 32) + (other >> 32), other << 32 | (uint32_t)low};
}

uint64_t wide_high(uint64_t a, uint64_t b)
{
    return wide_product(a, b).high;
}

uint64_t wide_scaled(uint64_t a, uint64_t b)
{
    if (b >> 32 == 0)
        return (product((uint32_t)(a >> 32), (uint32_t)b) + (product((uint32_t)a, (uint32_t)b) >> 32)) >> 8;
    const struct wide whole = wide_product(a, b);
    return whole.high << 24 | whole.low >> 40;
}

#endif

/* The next digit of 32 bits of a quotient (Knuth, The Art of Computer Programming, 4.3.1, algorithm D): *left * 2^32 + next by a
 * divisor >= 2^63; *left < divisor becomes the remainder. */
static uint32_t next_digit(uint64_t *left, uint32_t next, uint64_t divisor)
{
    const uint32_t high = (uint32_t)(divisor >> 32), low = (uint32_t)divisor;
    uint64_t digit = *left / high, rest = *left % high;
    while (digit >> 32 || (uint32_t)digit * (uint64_t)low > (rest << 32 | next)) { /* at most twice */
        digit--;
        rest += high;
        if (rest >> 32)
            break;
    }
    *left = (*left << 32 | next) - digit * divisor;
    return (uint32_t)digit;
}

uint64_t wide_divide(struct wide number, uint64_t divisor, uint64_t *rest)
{
    unsigned shift = 0;
    for (unsigned bits = 32; bits > 0; bits >>= 1)
        if (!(divisor >> (64 - bits))) {
            divisor <<= bits;
            shift += bits;
        }
    if (shift > 0)
        number = wide_shifted(number, shift);
    uint64_t left = number.high, high = next_digit(&left, (uint32_t)(number.low >> 32), divisor);
    uint64_t low = next_digit(&left, (uint32_t)number.low, divisor);
    *rest = left >> shift;
    return high << 32 | low;
}

struct wide wide_fraction(uint64_t rest, uint64_t divisor, bool *inexact)
{
    struct wide places;
    places.high = wide_divide((struct wide){rest, 0}, divisor, &rest);
    places.low = wide_divide((struct wide){rest, 0}, divisor, &rest);
    *inexact = rest != 0;
    return places;
}

/* Square root of a number below 2^62, rounded down, bit by bit. */
static uint64_t root_of_half(uint64_t number)
{
    uint64_t root = 0;
    for (uint64_t digit = UINT64_C(1) << 60; digit != 0; digit >>= 2) {
        uint64_t trial = root + digit;
        root >>= 1;
        if (number >= trial) {
            number -= trial;
            root += digit;
        }
    }
    return root;
}

/* Square root, rounded down, of 2^124 <= number < 2^126: that of its upper half, and a quotient for the rest, which may be
 * 2 too much. */
static uint64_t root_of_whole(struct wide number)
{
    uint64_t high = root_of_half(number.high), rest = number.high - high * high;
    uint64_t root = (high << 32) + (rest << 31 | number.low >> 33) / high;
    while (wide_less(number, wide_product(root, root)))
        root--;
    return root;
}

/* number / 2^shift; *inexact becomes true if something is cut off. */
static struct wide shifted_down(struct wide number, unsigned shift, bool *inexact)
{
    if (shift >= 64) {
        *inexact = *inexact || number.low != 0;
        number = (struct wide){0, number.high};
        shift -= 64;
    }
    if (shift > 0) {
        *inexact = *inexact || number.low << (64 - shift) != 0;
        number = (struct wide){number.high >> shift, number.low >> shift | number.high << (64 - shift)};
    }
    return number;
}

struct wide wide_root(struct wide radicand, unsigned places, bool *inexact)
{
    unsigned shift = 64 - places;
    *inexact = false;
    if ((radicand.high | radicand.low) == 0)
        return radicand;
    for (; !(radicand.high >> 60); radicand = wide_shifted(radicand, 2))
        shift++;
    /* Root * 2^64 has the digits `high` and `low`: low = rest * 2^64 / (2 * high), or a little less, as low^2 must fit, too, into
     * what is over. */
    uint64_t high = root_of_whole(radicand), low = UINT64_MAX, over = high;
    uint64_t rest = wide_difference(radicand, wide_product(high, high)).low;
    if (rest >> 1 < high)
        low = wide_divide((struct wide){rest >> 1, rest << 63}, high, &over);
    over *= 2;
    struct wide square = wide_product(low, low);
    bool plenty = false; /* 2^64 and more is over */
    while (!plenty && wide_less((struct wide){over, 0}, square)) {
        low--;
        square = wide_product(low, low);
        over += 2 * high;
        plenty = over < 2 * high;
    }
    *inexact = plenty || over != square.high || square.low != 0;
    return shifted_down((struct wide){high, low}, shift, inexact);
}

uint32_t wide_root_of(uint32_t number)
{
    uint32_t root = 0;
    for (uint32_t digit = UINT32_C(1) << 30; digit != 0; digit >>= 2) {
        uint32_t trial = root + digit;
        root >>= 1;
        if (number >= trial) {
            number -= trial;
            root += digit;
        }
    }
    return root;
}
