/* SPDX-License-Identifier: MIT */
/* clock.h: a clock of 64 bits from a counter of 32, which wraps after 71 minutes if it counts microseconds. */
#ifndef CLOCK_H
#define CLOCK_H

#include <stdint.h>

/* *clock: the time last found; `counter`: the counter now, less its value at time 0. Returns the time, and keeps it in *clock.
 * Has to be called at least once in 2^32 counts. */
static inline uint64_t clock_extend(uint64_t *clock, uint32_t counter)
{
    *clock += counter - (uint32_t)*clock;
    return *clock;
}

#endif
