/* SPDX-License-Identifier: MIT */
/* rkm04/motion.h: what a motion is made of (specification section 6): its segments, its break points and the state of the
 * pulse generator. Types only: they are parts of struct rkm04_unit and are handled by profile.c and ramp.c.
 *
 * Units inside: position in whole steps and a part of a step; time in ticks, `rate` of which make a second. With
 * y = 2 * rate^2 * position and w = 2 * rate * speed a constant acceleration a [steps/s^2] gives, d ticks later,
 *
 *     y' = y + d * (w + a * d)        w' = w + 2 * a * d
 *
 * which are whole numbers wherever the motion began at rest: no root, no rounding, no drift. */
#ifndef RKM04_MOTION_H
#define RKM04_MOTION_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/limits.h>

#ifdef __cplusplus
extern "C" {
#endif

/* One segment (a single motion has one). */
struct rkm04_segment {
    uint32_t steps;        /* N; 1..160 000 000 in a compound, up to 4 147 483 648 with G (U3) */
    uint16_t speed;        /* V, 1..16 000 steps/s */
    uint16_t acceleration; /* A, 1..60 000 steps/s^2: of rising speed */
    uint16_t deceleration; /* of falling speed; the RKM04 has one A for both */
};

/* 64.64 fixed point, value = whole + part / 2^64. */
struct rkm04_fixed {
    int64_t whole;
    uint64_t part;
};

/* A point in time with the fraction of a tick: tick + (high * 2^64 + low) / 2^128. */
struct rkm04_instant {
    uint64_t tick;
    uint64_t high, low;
};

/* A place in a motion, 32.96 fixed point: (high * 2^64 + low) / 2^96 steps; the upper half of `high` counts whole steps. */
struct rkm04_place {
    uint64_t high, low;
};

/* From this place on the slope holds until the next break point. */
struct rkm04_break {
    uint64_t speed2; /* 2 * speed^2 in units of 2^-34 steps^2/s^2 */
    struct rkm04_place at;
    int32_t slope; /* steps/s^2; > 0 faster, 0 constant speed, < 0 slower */
};

/* The break points of a motion, the passed ones included (P7). */
struct rkm04_profile {
    uint8_t count; /* points in use */
    uint8_t leg;   /* the motion is between point[leg] and point[leg + 1] */
    bool endless;  /* the last point's slope holds without end; otherwise the last point is the end */
    struct rkm04_break point[RKM04_BREAKS_MAX];
};

/* The pulse generator of one motor. */
struct rkm04_ramp {
    uint64_t next;            /* tick of the next pulse, or of the change to the next leg; RKM04_NEVER: no motion */
    uint64_t at;              /* tick at which y and w stand: that of the next pulse, or of the first of the present block */
    struct rkm04_fixed y;     /* 2 * rate^2 * (position - number of that pulse) */
    struct rkm04_fixed w;     /* 2 * rate * speed */
    struct rkm04_instant end; /* when the present leg ends; RKM04_NEVER: it does not */
    uint32_t left;            /* pulses left in the present leg */
    int32_t interval;         /* ticks between two pulses, about */
    int32_t change;           /* by how much it changes from pulse to pulse, about */
    int32_t slope;            /* of the present leg */
    uint32_t level;           /* speed of a level leg in whole steps/s; 0: it slopes, or its speed is no whole number */
    uint32_t phase;           /* on a level leg: y / (2 * rate), rounded down */
    uint64_t fast;            /* on a slope: w from which its pulses are worked out in blocks */
    uint64_t due, due1, due2, due3; /* of a block: when the pulse after the next one is due, and differences (ramp_pulses.c) */
    uint8_t block, sent;      /* pulses of the block, and how many of them are out; 0: none under way */
    bool last;                /* no pulse is left behind the present leg */
    bool exact;               /* no irrational number has come in so far (R5) */
    uint32_t rate;            /* ticks a second */
    int64_t step;             /* y of one step: 2 * rate^2 */
};

enum rkm04_motion_kind {
    RKM04_MOTION_NONE,
    RKM04_MOTION_STEPS,   /* R, G, H: one or more segments */
    RKM04_MOTION_ENDLESS, /* G+ G- */
    RKM04_MOTION_LIMIT    /* ) ( : at S until an input is 1 */
};

/* One motion from its command to its end, through holds. */
struct rkm04_motion {
    uint32_t done;       /* pulses sent so far, modulo 2^32 (P9) */
    uint32_t total;      /* of a STEPS motion */
    uint32_t mark;       /* pulse at which the outputs of T51-58 are set; 0 = none (C12) */
    uint16_t start_speed; /* S when the motion began */
    uint8_t segments;
    uint8_t kind;        /* enum rkm04_motion_kind */
    uint8_t input;       /* of a limit move: 1..8 */
    uint8_t marks;       /* outputs to be set at `mark` (C12) */
    bool forward;
    bool moving;         /* between begin and last pulse; false during a hold */
    bool stopping;       /* on a stop ramp (R5) */
    bool changed;        /* its speed has been changed on the way (C4) */
    struct rkm04_ramp ramp;
    struct rkm04_segment segment[RKM04_SEGMENTS_MAX];
    struct rkm04_profile profile;
};

#ifdef __cplusplus
}
#endif

#endif
