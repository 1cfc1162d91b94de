/* SPDX-License-Identifier: MIT */
/* wide.h: the few operations on 128-bit numbers that planning a motion needs, the same on every machine. */
#ifndef RKM04_SRC_WIDE_H
#define RKM04_SRC_WIDE_H

#include <stdbool.h>
#include <stdint.h>

/* high * 2^64 + low; additions and subtractions wrap modulo 2^128. */
struct wide {
    uint64_t high, low;
};

/* Upper half of a * b. The one place where a compiler's own 128-bit type is used: the result is the same without. */
static inline uint64_t wide_high(uint64_t a, uint64_t b)
{
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 u128;
    return (uint64_t)((u128)a * b >> 64);
#else
    uint64_t a0 = (uint32_t)a, a1 = a >> 32, b0 = (uint32_t)b, b1 = b >> 32;
    uint64_t middle = a1 * b0 + (a0 * b0 >> 32);
    uint64_t other = a0 * b1 + (uint32_t)middle;
    return a1 * b1 + (middle >> 32) + (other >> 32);
#endif
}

static inline struct wide wide_product(uint64_t a, uint64_t b)
{
    return (struct wide){wide_high(a, b), a * b};
}

static inline struct wide wide_sum(struct wide a, struct wide b)
{
    uint64_t low = a.low + b.low;
    return (struct wide){a.high + b.high + (low < a.low), low};
}

static inline struct wide wide_difference(struct wide a, struct wide b)
{
    return (struct wide){a.high - b.high - (a.low < b.low), a.low - b.low};
}

static inline bool wide_less(struct wide a, struct wide b)
{
    return a.high < b.high || (a.high == b.high && a.low < b.low);
}

/* a * 2^shift, 0 < shift < 64. */
static inline struct wide wide_shifted(struct wide a, unsigned shift)
{
    return (struct wide){a.high << shift | a.low >> (64 - shift), a.low << shift};
}

/* number / divisor, rounded down; 0 < divisor < 2^63 and number.high < divisor, so that the quotient fits.
 * *rest receives the remainder. */
uint64_t wide_divide(struct wide number, uint64_t divisor, uint64_t *rest);

/* The first 128 binary places of rest / divisor, cut off; rest < divisor < 2^63. *inexact: something was cut off. */
struct wide wide_fraction(uint64_t rest, uint64_t divisor, bool *inexact);

/* Square root of radicand * 4^places, rounded down; the result must be below 2^124. *inexact: something was cut off. */
struct wide wide_root(struct wide radicand, unsigned places, bool *inexact);

/* Square root of a whole number, rounded down. */
uint32_t wide_root_of(uint32_t number);

#endif
