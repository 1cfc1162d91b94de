/* SPDX-License-Identifier: MIT */
/* pwm.h: PWM outputs (section 7 of docs/CIB.md). Levels follow from the tick alone: nothing is counted. */
#ifndef RKM04_CIB_PWM_H
#define RKM04_CIB_PWM_H

#include "cib.h"

/* All duties 0: the first period begins at unit->since. */
void pwm_reset(struct cib_unit *unit);

/* Write the duty of an output 0..7 at unit->now: it counts from the next period on that has not begun (BW2). */
void pwm_write(struct cib_unit *unit, unsigned output, uint16_t duty);

/* Levels (log. 1) of all eight in front of what happens at `tick`; those of outputs that are not PWM mean nothing. */
uint8_t pwm_levels(const struct cib_unit *unit, uint64_t tick);

/* The first tick, >= `tick`, at which the level of a PWM output changes; CIB_NEVER: none does. */
uint64_t pwm_next_edge(const struct cib_unit *unit, uint64_t tick);

#endif
