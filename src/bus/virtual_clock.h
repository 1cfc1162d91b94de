/* SPDX-License-Identifier: MIT */
/* virtual_clock.h: the monotonic time of the machine (ns) <-> the virtual time of the unit (ticks of 1 us). Pure arithmetic. */
#ifndef RKM04_BUS_VIRTUAL_CLOCK_H
#define RKM04_BUS_VIRTUAL_CLOCK_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/limits.h>

#define VIRTUAL_CLOCK_EXPECTED "real, max, stepped, or xN with N from 0.001 to 10000 (as in x10 or x0.25)"

struct virtual_clock {
    uint32_t thousandths; /* of the speed of real time, 1..10 000 000 */
    bool runs_ahead;      /* max: leaps may be added */
    bool stands;          /* stepped: only leaps move it */
    uint64_t start;       /* ns from which it counts */
    uint64_t leapt;       /* the tick at that moment, and ticks added by virtual_clock_leap() */
};

/* Read "real", "max", "stepped" or "xN". Returns false if it is none of VIRTUAL_CLOCK_EXPECTED. */
bool virtual_clock_read(struct virtual_clock *clock, const char *text);

/* Tick `tick` is at `now` (ns). */
void virtual_clock_start(struct virtual_clock *clock, uint64_t now, uint64_t tick);

/* The tick at `now` (ns, not before the start). */
uint64_t virtual_clock_tick(const struct virtual_clock *clock, uint64_t now);

/* The first ns at which virtual_clock_tick() is at least `tick`; DEVICE_NEVER: the clock is stopped. */
uint64_t virtual_clock_when(const struct virtual_clock *clock, uint64_t tick);

/* From `now` (ns) on, count from `tick`; must not be before virtual_clock_tick(). */
void virtual_clock_leap(struct virtual_clock *clock, uint64_t now, uint64_t tick);

/* `nanoseconds` of the machine's time have not been. */
void virtual_clock_skip(struct virtual_clock *clock, uint64_t nanoseconds);

#endif
