/* SPDX-License-Identifier: MIT */
/* pmc_plan.h: the planner of an axis: from rest, or from the present place and speed, into legs (AM1, AM2, AM6 to AM8). */
#ifndef PMC_PMC_PLAN_H
#define PMC_PMC_PLAN_H

#include "pmc.h"

/* Plan a motion from rest at `tick`, motion->total pulses or, with motion->endless, for ever, with speed and start speed as they
 * are set, 1..8000. */
void pmc_plan_begin(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick, uint16_t speed,
                    uint16_t start_speed);

/* The speed becomes another one, in a slot. Returns false on the final ramp, where nothing changes. */
bool pmc_plan_speed(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick, uint16_t speed);

/* Stop with a ramp, in a slot (AM8); on the final ramp it ends as it would. Returns false if no pulse is to come. */
bool pmc_plan_stop(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick);

/* Put the ticks of the next pulses up to `limit` into `tick`, at most `room`, of one leg. Returns their number; there are more
 * while motion->ramp.next <= limit. */
size_t pmc_plan_pulses(struct pmc_motion *motion, uint64_t limit, uint64_t *tick, size_t room);

#endif
