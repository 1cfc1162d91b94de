/* SPDX-License-Identifier: MIT */
/* reference.h: an independent opinion on when the pulses of a motion are due (R1-R6), for tests.
 *
 * Single motions from rest are decided exactly in whole numbers. Everything else is a track: legs of constant acceleration
 * in floating point numbers of 2048 bits, planned as a limit on the square of the speed over the place. Times are ticks of
 * 1 us since the slot in which the motion began. Nothing here is taken from the product. */
#ifndef RKM04_TESTS_REFERENCE_H
#define RKM04_TESTS_REFERENCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <gmp.h>

#define REF_BITS 2048      /* of a track's numbers */
#define REF_LEGS 120       /* of a track, changes included */
#define REF_SEGMENTS 10
#define REF_ENDLESS (UINT64_C(1) << 50) /* steps of a motion that has no end: 2230 years at 16 000 steps/s */

/* One segment; a single motion is one of them. */
struct ref_segment {
    uint64_t steps;        /* N, 1..2^32 or REF_ENDLESS */
    unsigned speed;        /* V, steps/s */
    unsigned acceleration; /* A, steps/s^2 */
};

/* Once, before anything else here: how GMP gets its memory. */
void ref_use_blocks(void);

/* ---- R1, exact ---- */

/* So many ticks make a second from now on, instead of a million. */
void ref_use_rate(unsigned long ticks_per_second);

/* Tick of pulse k, 1..N, of a motion from rest: the smallest whole number not below 10^6 T(k). */
uint64_t ref_single_tick(unsigned start_speed, const struct ref_segment *motion, uint64_t k);

/* Last step, rounded down, of the rising and of the constant phase. */
void ref_single_phases(unsigned start_speed, const struct ref_segment *motion, uint64_t *rising, uint64_t *constant);

/* ---- Tracks ---- */

struct ref_leg {
    mpf_t time, place, speed; /* at its begin: seconds, steps, steps/s */
    int slope;                /* steps/s^2 */
    bool replanned;           /* a change or a stop happened here */
};

/* How the end of a stop was found (R5). */
enum ref_edge {
    REF_EDGE_NONE,       /* the exact place is well away from a whole number */
    REF_EDGE_WHOLE,      /* it is a whole number: no step is added */
    REF_EDGE_RATIONAL,   /* less than 10^-6 above a whole number, but rational: a step is added */
    REF_EDGE_IRRATIONAL  /* less than 10^-6 above a whole number and irrational: counts as that number */
};

struct ref_track {
    unsigned start_speed; /* S */
    unsigned segments;
    struct ref_segment segment[REF_SEGMENTS];
    uint64_t steps; /* N; after a stop N' */
    unsigned legs;
    struct ref_leg leg[REF_LEGS + 1]; /* leg[legs] is the end */
    enum ref_edge edge;               /* of the last stop */
};

void ref_init(struct ref_track *track);
void ref_clear(struct ref_track *track);
void ref_copy(struct ref_track *track, const struct ref_track *from);

/* Plan a motion from rest (R1, R3, R4). One segment of REF_ENDLESS steps is a motion without end. */
void ref_plan(struct ref_track *track, unsigned start_speed, const struct ref_segment *segment, unsigned segments);

/* The motion gets a new speed at this tick (R6, C4). */
void ref_change(struct ref_track *track, uint64_t tick, unsigned speed);

/* The motion is stopped at this tick (R5): sets `steps` and `edge`. */
void ref_stop(struct ref_track *track, uint64_t tick);

/* Plan what is left of a motion that has been stopped, again from rest at tick 0 (C75): from->steps have been done.
 * Returns false if nothing is left. */
bool ref_plan_rest(struct ref_track *track, const struct ref_track *from);

/* Tick of pulse k, 1..steps. */
uint64_t ref_tick(const struct ref_track *track, uint64_t k);

/* Number of pulses up to and with this tick. */
uint64_t ref_steps_at(const struct ref_track *track, uint64_t tick);

/* Is the motion on its last fall to its planned end at this tick? */
bool ref_on_final_ramp(const struct ref_track *track, uint64_t tick);

/* Speed at this tick, for conditions of tests; not exact. */
double ref_speed_at(const struct ref_track *track, uint64_t tick);

/* Place at this tick, for conditions of tests; not exact. */
double ref_place_at(const struct ref_track *track, uint64_t tick);

/* The text of message 6 after the motor's digit (P7). `room` >= 1024. */
void ref_table(const struct ref_track *track, char *text, size_t room);

/* Square of the speed at a place by the definition of R4 alone: the smallest of all limits that reach it. For tests of
 * ref_plan. */
double ref_limit_at(unsigned start_speed, const struct ref_segment *segment, unsigned segments, double place);

/* Square of the speed at a place of a track. */
double ref_square_at(const struct ref_track *track, double place);

#endif
