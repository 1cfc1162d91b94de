/* SPDX-License-Identifier: MIT */
/* motion_plan.h: the rest of a motion as the shared planner has it (profile.h): speed over time from corner to corner. For kinds
 * whose ticks are us. */
#ifndef RKM04_DEVICE_MOTION_PLAN_H
#define RKM04_DEVICE_MOTION_PLAN_H

#include <rkm04/motion.h>

#include "device.h"

/* As struct device_kind's `plan`: of `motion` from the tick `now` on, when the counter is at `position`. */
size_t motion_plan(const struct rkm04_motion *motion, uint64_t now, int32_t position, struct device_plan_point *point,
                   size_t room);

#endif
