/* SPDX-License-Identifier: MIT */
/* pmc_store.h: parameters and program of each axis in flash (AP6). */
#ifndef PMC_PMC_STORE_H
#define PMC_PMC_STORE_H

#include "pmc.h"

/* Write parameters and program of an axis as the new generation; the old one stays whole until the new one is. Returns false if
 * the flash failed: then the old generation stands. */
bool pmc_store_save(const struct pmc_unit *unit, const struct pmc_axis *axis);

/* Read what was stored last. What was never stored, or is not whole, has the values of T1 and NOP in all registers. */
void pmc_store_load(const struct pmc_unit *unit, struct pmc_axis *axis);

#endif
