/* SPDX-License-Identifier: MIT */
/* pmc_report.h: what an axis reports, and what ends its program. */
#ifndef PMC_PMC_REPORT_H
#define PMC_PMC_REPORT_H

#include "pmc.h"

static inline unsigned pmc_index(const struct pmc_unit *unit, const struct pmc_axis *axis)
{
    return (unsigned)(axis - unit->axis);
}

/* The first slot at or after a tick. */
static inline uint64_t pmc_slot_at(uint64_t tick)
{
    const uint64_t slot = (tick + PMC_SLOT_TICKS - 1) / PMC_SLOT_TICKS * PMC_SLOT_TICKS;
    return slot > 0 ? slot : PMC_SLOT_TICKS;
}

void pmc_report(struct pmc_unit *unit, struct pmc_axis *axis, uint64_t tick, enum pmc_event what, uint32_t value);

/* Switch outputs of the unit. */
void pmc_write_outputs(struct pmc_unit *unit, uint8_t outputs);

/* The program is over, and none begins behind a search. */
void pmc_end_program(struct pmc_unit *unit, struct pmc_axis *axis);

/* Latch errors (enum pmc_error) of an axis; they end its program (AL5). */
void pmc_raise(struct pmc_unit *unit, struct pmc_axis *axis, unsigned errors);

/* Clear errors and warning (AL5, AL6). */
void pmc_clear_errors(struct pmc_unit *unit, struct pmc_axis *axis);

/* Set the commanded counter. */
void pmc_set_commanded(struct pmc_unit *unit, struct pmc_axis *axis, int32_t position);

#endif
