/* SPDX-License-Identifier: MIT */
/* ramp.h: legs of a motion -> the tick of every pulse. Whole numbers only, no I/O; knows nothing but legs (R1, R2).
 *
 *   speed                    A leg lies between two break points. On it, with y = 2 * rate^2 * (position - next pulse) and
 *     |      ____            w = 2 * rate * speed, d ticks later: y + d * (w + slope * d). A pulse is due at the first
 *     |     /    \           tick with y >= 0. A rising or level leg is computed from its beginning, a falling one from its
 *     |    /      \          end, so that the last step of a motion is as exact as the first.
 *     |___/        \____
 *     +--0--1------2-----3-- position: break points 0, 1, 2, and 3, the end */
#ifndef RKM04_SRC_RAMP_H
#define RKM04_SRC_RAMP_H

#include <rkm04/motion.h>
#include <stddef.h>

#include "wide.h"

#define RAMP_SPEED2_BITS 34 /* rkm04_break.speed2 = 2 * speed^2 * 2^34 */

/* w of 1 step/s. */
static inline int64_t ramp_speed_unit(const struct rkm04_ramp *ramp)
{
    return 2 * (int64_t)ramp->rate;
}

/* Whole steps of a place. */
static inline uint32_t ramp_step_of(struct rkm04_place place)
{
    return (uint32_t)(place.high >> 32);
}

/* ---- Leg by leg: for any planner ---- */

/* A leg between two break points. */
struct ramp_leg {
    struct rkm04_place from, to;  /* `to`: not of an open leg */
    struct rkm04_fixed w, w_end;  /* 2 * rate * speed there; above 0 */
    int32_t slope;                /* steps/s^2 from -600 000 000 to 600 000 000 */
    bool open;                    /* it has no end; slope 0 */
    bool last;                    /* no pulse is left after it */
};

/* rate: ticks a second, a million to 16 millions; pulses come at most once a tick. */
void ramp_set_rate(struct rkm04_ramp *ramp, uint32_t rate);

/* Begin a leg at `start`. Pulses count from the next whole step after leg->from. */
void ramp_begin_leg(struct rkm04_ramp *ramp, const struct ramp_leg *leg, struct rkm04_instant start);

/* Is the leg over by `limit`? Then the next one begins at ramp->end. */
static inline bool ramp_leg_is_over(const struct rkm04_ramp *ramp, uint64_t limit)
{
    return ramp->left == 0 && ramp->next <= limit;
}

/* Put the ticks of pulses of the present leg, which is not over, due up to and including `limit` into `tick`, at most `room`.
 * Returns their number; there are more while ramp->next <= limit. After the last pulse of a motion ramp->next is RKM04_NEVER. */
size_t ramp_leg_ticks(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room);

/* ---- Along a profile ---- */

/* Begin at point[leg] of the profile, at `tick`, with the speed of that point. rate: ticks a second, a million to 16 millions;
 * pulses come at most once a tick. */
void ramp_begin(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, uint64_t tick, uint32_t rate);

/* Continue from the present position and speed at `tick` along a profile planned again: point[leg] is the present place. */
void ramp_continue(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t tick);

/* Put the ticks of the next pulses due up to and including `limit` into `tick`, at most `room`, of one leg. Moves profile->leg
 * on. Returns their number; there are more while ramp->next <= limit. */
size_t ramp_pulses(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t limit, uint64_t *tick, size_t room);

/* ---- For both ---- */

/* Skip pulses that are not reported one by one: most of those of the present leg that are due up to `limit`, which the
 * next one is, but not more than `most`. At least one of those due up to `limit` is left for ramp_pulses(). The number of
 * operations grows with the logarithm of the number of pulses. Returns how many were passed over; 0: not worth it. */
uint32_t ramp_skip(struct rkm04_ramp *ramp, uint64_t limit, uint32_t most);

/* y and w at `tick`; the tick must lie within the present leg. */
void ramp_state_at(const struct rkm04_ramp *ramp, uint64_t tick, struct rkm04_fixed *y, struct rkm04_fixed *w);

/* A tick, not before ramp->next, before which the present leg does not end and at most `most` of its pulses are due; UINT32_MAX:
 * any number of them. */
uint64_t ramp_quiet_pulses(const struct rkm04_ramp *ramp, uint32_t most);

/* A tick before which the motion does not end; RKM04_NEVER if it has no end of its own. */
uint64_t ramp_quiet_until(const struct rkm04_ramp *ramp);

#endif
