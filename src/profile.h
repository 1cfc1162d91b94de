/* SPDX-License-Identifier: MIT */
/* profile.h: the one planner: from a present state (place, speed) to a goal, under the limits of the segments, into break
 * points (R3 to R6, P7). Places count from the begin of the motion. */
#ifndef RKM04_SRC_PROFILE_H
#define RKM04_SRC_PROFILE_H

#include <rkm04/motion.h>

/* Plan the rest of a motion from standstill at motion->done steps: on to its end, or without end (R1, R3, R4; after a hold C3).
 * The break points that were passed before stay in the table. */
void profile_plan(struct rkm04_motion *motion);

/* Plan again at `tick` while moving: the speed of the segment it is in becomes `speed` (C4, R6). No effect on the final ramp. */
void profile_change_speed(struct rkm04_motion *motion, uint64_t tick, uint16_t speed);

/* Plan a stop from the present speed at `tick` (R5). Nothing changes on the final ramp.
 * Returns false if the motion has no further step to do: it ends here. */
bool profile_stop(struct rkm04_motion *motion, uint64_t tick);

/* ---- Any goal from any state: for axes that are not an RKM04's motor ---- */

enum profile_goal_kind { PROFILE_TO_PLACE, PROFILE_FOR_EVER, PROFILE_TO_STOP };

/* Where an axis is to go, and how. */
struct profile_goal {
    enum profile_goal_kind kind;
    int64_t way;          /* TO_PLACE: steps from the pulse sent last, forward > 0; less than 2^32 either way */
    int32_t speed;        /* steps/s: TO_PLACE > 0; FOR_EVER: forward > 0, back < 0 */
    uint16_t start_speed; /* of a motion from rest, and of a stop; RKM04_SPEED_MAX: no ramps */
    uint16_t acceleration, deceleration; /* steps/s^2 */
    int8_t early; /* TO_PLACE: the braking ends that many steps before the place, and the rest is done at start_speed, or at the
                   * speed if that is lower; < 0: it is planned to end after the place, where the caller cuts it. What can be
                   * reached is asked of the place itself. Takes two segments: RKM04_SEGMENTS_MAX of 2 at least */
};

enum profile_answer {
    PROFILE_MOVES, /* on the way to the goal */
    PROFILE_TURNS, /* stops first: ask again at the tick of the last pulse, with what is left to do */
    PROFILE_STANDS /* no further step is to be done */
};

/* Plan to a goal at `tick`: from rest (motion->moving is false), or from the present place, speed and direction. A place ahead
 * that can be reached without a turn is; otherwise, and for a speed the other way, the axis stops first. Places and
 * motion->done count from the pulse sent last. rate: of ticks, as in ramp_begin(). Sets motion->moving; the caller clears it at
 * the last pulse (motion->ramp.next is RKM04_NEVER). Ticks may be one off after a plan on the way (R2), steps are exact. */
enum profile_answer profile_go(struct rkm04_motion *motion, uint64_t tick, uint32_t rate, const struct profile_goal *goal);

/* ---- What the host sees ---- */

/* The i-th break point as P7 prints it. Returns false after the last one. */
struct profile_point {
    uint32_t step;
    uint32_t speed; /* steps/s, rounded down */
};
bool profile_point(const struct rkm04_motion *motion, unsigned i, struct profile_point *point);

#endif
