/* SPDX-License-Identifier: MIT */
/* pins.h: masks of pins that lie side by side in a port of 32 bits. */
#ifndef PINS_H
#define PINS_H

#include <stdbool.h>
#include <stdint.h>

/* `count` (1..31) pins from pin `first` on. */
#define PINS(first, count) (((1u << (count)) - 1) << (first))

/* The levels of `count` pins from `first` on, the first in bit 0. low: they count where the level is 0, as with pull-ups and
 * something that pulls to ground. */
static inline uint8_t pins_read(uint32_t levels, unsigned first, unsigned count, bool low)
{
    return (uint8_t)(((low ? ~levels : levels) & PINS(first, count)) >> first);
}

/* `mask` with the bit of motor 1..4 set or cleared. */
static inline uint32_t pins_with(uint32_t mask, unsigned motor, bool on)
{
    uint32_t bit = 1u << (motor - 1);
    return on ? mask | bit : mask & ~bit;
}

#endif
