/* SPDX-License-Identifier: MIT */
/* apply.h: a setup begins to count, at power-up or by APPLY (BU8). */
#ifndef RKM04_CIB_APPLY_H
#define RKM04_CIB_APPLY_H

#include "cib.h"

/* From unit->now on `setup`, which is good, counts: drives as after power-up, DO and PWM registers 0. Reports nothing. */
void apply_setup(struct cib_unit *unit, const struct cib_setup *setup);

/* Check the proposal, and apply it if it is good. */
void apply_proposal(struct cib_unit *unit);

#endif
