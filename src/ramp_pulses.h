/* SPDX-License-Identifier: MIT */
/* ramp_pulses.h: the pulses of one leg, one by one or in blocks. For ramp.c alone. */
#ifndef RKM04_SRC_RAMP_PULSES_H
#define RKM04_SRC_RAMP_PULSES_H

#include <rkm04/motion.h>
#include <stddef.h>

#include "fixed.h"

/* The leg's first pulse: from ramp->at to the tick at which it is due, which may be ramp->at itself. */
void ramp_find_first(struct rkm04_ramp *ramp);

/* Put the ticks of pulses of the present leg due up to and including `limit` into `tick`: at least one, which is due, at most
 * `room`. After the leg's last pulse ramp->left is 0, and y counts from the one that would come next. Returns their number;
 * there may be more up to `limit`. */
size_t ramp_leg_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room);

/* Pulse j after the one that y and w are of is due at `tick` or a tick earlier. Returns which. */
uint64_t ramp_exact_tick(const struct rkm04_ramp *ramp, uint64_t tick, size_t j);

/* w from which on pulses of a slope in steps/s^2 may be worked out in blocks of 16. */
uint64_t ramp_fast_from(uint32_t slope, uint32_t rate);

/* A block keeps when the pulse after the next one is due, in ticks after ramp->at with 32 binary places and RAMP_NEAR too much,
 * less one tick, as a cubic: ramp->due, and its differences due1 to due3. It is right to less than RAMP_NEAR. */
#define RAMP_NEAR (UINT64_C(1) << 25) /* 2^-7 of a tick */

/* Begin a block with the pulse that y and w are of. Returns false where the speed is too low or the leg too short. */
bool ramp_begin_block(struct rkm04_ramp *ramp);

/* y and w of the ramp d ticks on, or back if d < 0. */
struct motion_state ramp_moved(const struct rkm04_ramp *ramp, int64_t d);

/* Let y and w be at the next pulse, and no block be under way. */
void ramp_leave_block(struct rkm04_ramp *ramp);

#endif
