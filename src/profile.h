/* SPDX-License-Identifier: MIT */
/* profile.h: the one planner: from a present state (place, speed) to a goal, under the limits of the segments, into break
 * points (R3 to R6, P7). Places count from the begin of the motion. */
#ifndef RKM04_SRC_PROFILE_H
#define RKM04_SRC_PROFILE_H

#include <rkm04/motion.h>

/* Plan the rest of a motion from standstill at motion->done steps: on to its end, or for ever (R1, R3, R4; after a hold C3).
 * The break points that were passed before stay in the table. */
void profile_plan(struct rkm04_motion *motion);

/* Plan anew at `tick` while moving: the speed of the segment it is in becomes `speed` (C4, R6). No effect on the final ramp. */
void profile_change_speed(struct rkm04_motion *motion, uint64_t tick, uint16_t speed);

/* Plan a stop from the present speed at `tick` (R5). Nothing changes on the final ramp.
 * Returns false if the motion has no further step to do: it ends here. */
bool profile_stop(struct rkm04_motion *motion, uint64_t tick);

/* The i-th break point as P7 prints it. Returns false behind the last one. */
struct profile_point {
    uint32_t step;
    uint32_t speed; /* steps/s, rounded down */
};
bool profile_point(const struct rkm04_motion *motion, unsigned i, struct profile_point *point);

#endif
