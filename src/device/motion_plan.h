/* SPDX-License-Identifier: MIT */
/* motion_plan.h: the rest of a motion as its planner has it: speed over time from corner to corner. */
#ifndef RKM04_DEVICE_MOTION_PLAN_H
#define RKM04_DEVICE_MOTION_PLAN_H

#include <rkm04/motion.h>

#include "device.h"

/* A break point of a planner. */
struct plan_corner {
    double place, speed; /* steps since the place that `done` counts from; steps/s */
    int32_t slope;       /* steps/s^2, from here to the next one */
};

struct plan_motion {
    const struct rkm04_ramp *ramp; /* the pulse generator at present */
    uint64_t now;                  /* ticks of the ramp */
    unsigned ticks_per_us;
    uint32_t done;                 /* steps done */
    int32_t position;              /* the counter */
    bool forward, endless;
    unsigned count;                /* corners from the begin of the present leg on */
    const struct plan_corner *corner;
};

/* As struct device_kind's `plan`. */
size_t plan_motion(const struct plan_motion *motion, struct device_plan_point *point, size_t room);

/* The place of a break point in steps. */
double plan_place(struct rkm04_place place);

/* The same of a `motion` of the shared planner (profile.h) whose ticks are us, from the tick `now` on, when the counter is at
 * `position`. */
size_t motion_plan(const struct rkm04_motion *motion, uint64_t now, int32_t position, struct device_plan_point *point,
                   size_t room);

#endif
