/* SPDX-License-Identifier: MIT */
/* pmc_home.h: home search in four steps (section 7). */
#ifndef PMC_PMC_HOME_H
#define PMC_PMC_HOME_H

#include "pmc.h"

/* Begin a search in this slot; the first phase that has something to do begins, too. */
void pmc_home_begin(struct pmc_unit *unit, struct pmc_axis *axis);

/* In a slot, for an axis that searches: look at the switches, go on to the next phase. axis->phase is 0 when the search is over:
 * axis->homed says how. */
void pmc_home_turn(struct pmc_unit *unit, struct pmc_axis *axis);

/* The search ends here, without an error; the motion goes on. */
void pmc_home_drop(struct pmc_axis *axis);

#endif
