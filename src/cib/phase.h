/* SPDX-License-Identifier: MIT */
/* phase.h: the tables of the six modes (section 3 of docs/CIB.md). */
#ifndef RKM04_CIB_PHASE_H
#define RKM04_CIB_PHASE_H

#include <stdbool.h>
#include <stdint.h>

/* Is there such a mode? (BT1) */
bool phase_has_mode(uint16_t mode);

/* Rows of a mode's table: 4, or 8 for half steps. */
unsigned phase_rows(uint16_t mode);

/* What row 1..rows of a mode drives: bits 0-3 the four outputs on or +, bits 8-11 the ones that are -. */
uint16_t phase_pattern(uint16_t mode, unsigned row);

#endif
