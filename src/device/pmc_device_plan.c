/* SPDX-License-Identifier: MIT */
/* The rest of a motion of a PMC as its planner has it: speed over time from corner to corner (AM2). */
#include "motion_plan.h"
#include "pmc_device.h"

#define RATE ((double)PMC_TICKS_PER_SECOND)

size_t pmc_device_plan(const struct device_unit *unit, unsigned number, struct device_plan_point *point, size_t room)
{
    const struct pmc_unit *core = pmc_in(unit);
    const struct pmc_axis *axis = &core->axis[number - 1u];
    const struct pmc_motion *motion = &axis->motion;
    struct plan_corner corner[PMC_BREAKS_MAX];
    struct plan_motion plan = {.ramp = &motion->ramp,
                               .now = core->now,
                               .ticks_per_us = PMC_TICKS_PER_US,
                               .done = motion->done,
                               .position = axis->commanded,
                               .forward = motion->forward,
                               .endless = motion->endless,
                               .corner = corner};
    if (!motion->moving)
        return 0;
    for (const struct pmc_break *from = &motion->point[motion->leg]; from < &motion->point[motion->count]; from++)
        corner[plan.count++] = (struct plan_corner){plan_place(from->at), (double)from->w.whole / (2 * RATE), from->slope};
    return plan_motion(&plan, point, room);
}
