/* SPDX-License-Identifier: MIT */
/* outputs.h: what the eight outputs drive: registers and buttons, phases, PWM. */
#ifndef RKM04_CIB_OUTPUTS_H
#define RKM04_CIB_OUTPUTS_H

#include "cib.h"

/* What is driven in front of what happens at `tick`, PWM; the rest as it is now. */
uint16_t outputs_at(const struct cib_unit *unit, uint64_t tick);

/* Something at `tick` may have changed what DO and drives drive: report it. */
void outputs_changed(struct cib_unit *unit, uint64_t tick);

/* Do the edges of PWM at `tick`, and find the next one. */
void outputs_pass_edge(struct cib_unit *unit, uint64_t tick);

/* The port has changed. */
void outputs_attach(struct cib_unit *unit);

/* Find the next edge of PWM from `tick` on, if the port has `edges`. */
void outputs_find_edge(struct cib_unit *unit, uint64_t tick);

#endif
