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

/* a * b, its upper half alone, and a * b / 2^40 rounded down, which must be below 2^64. The one place where a compiler's own
 * 128-bit type is used: the results are the same without. */
#ifdef __SIZEOF_INT128__
__extension__ typedef unsigned __int128 wide_native;

static inline uint64_t wide_high(uint64_t a, uint64_t b)
{
    return (uint64_t)((wide_native)a * b >> 64);
}

static inline struct wide wide_product(uint64_t a, uint64_t b)
{
    return (struct wide){wide_high(a, b), a * b};
}

static inline uint64_t wide_scaled(uint64_t a, uint64_t b)
{
    return (uint64_t)((wide_native)a * b >> 40);
}
#else
uint64_t wide_high(uint64_t a, uint64_t b);
struct wide wide_product(uint64_t a, uint64_t b);
uint64_t wide_scaled(uint64_t a, uint64_t b);
#endif

/* |a|, whatever a is. */
static inline uint64_t size_of(int64_t a)
{
    return a < 0 ? 0 - (uint64_t)a : (uint64_t)a;
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

/* number / divisor, rounded down; 0 < divisor and number.high < divisor, so that the quotient fits.
 * *rest receives the remainder. */
uint64_t wide_divide(struct wide number, uint64_t divisor, uint64_t *rest);

/* The first 128 binary places of rest / divisor, cut off; rest < divisor. *inexact: something was cut off. */
struct wide wide_fraction(uint64_t rest, uint64_t divisor, bool *inexact);

/* Square root of radicand * 4^places, rounded down; radicand < 2^126, places <= 64. *inexact: something was cut off. */
struct wide wide_root(struct wide radicand, unsigned places, bool *inexact);

/* Square root of a whole number, rounded down. */
uint32_t wide_root_of(uint32_t number);

#endif
