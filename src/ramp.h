/* SPDX-License-Identifier: MIT */
/* ramp.h: break points -> the tick of every pulse. Whole numbers only, no I/O; knows nothing but break points (R1, R2).
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

/* Begin at point[leg] of the profile, at `tick`, with the speed of that point. rate: ticks a second, a million to 16 millions;
 * pulses come at most once a tick. */
void ramp_begin(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, uint64_t tick, uint32_t rate);

/* Continue from the present position and speed at `tick` along a profile planned again: point[leg] is the present place. */
void ramp_continue(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t tick);

/* Put the ticks of the next pulses due up to and including `limit` into `tick`, at most `room`, of one leg. Moves profile->leg
 * on. Returns their number; there are more while ramp->next <= limit. */
size_t ramp_pulses(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t limit, uint64_t *tick, size_t room);

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
