/* SPDX-License-Identifier: MIT */
/* pmc_program.h: the interpreter of an axis (section 4). */
#ifndef PMC_PMC_PROGRAM_H
#define PMC_PMC_PROGRAM_H

#include "pmc.h"

/* Run the program from a register on; its command is executed in this slot. */
void pmc_program_begin(struct pmc_unit *unit, struct pmc_axis *axis, uint8_t reg);

/* In a slot: execute one command, if it is due. */
void pmc_program_turn(struct pmc_unit *unit, struct pmc_axis *axis);

/* In a slot, last of all: switch off outputs whose OTP ends. */
void pmc_program_end_pulses(struct pmc_unit *unit, struct pmc_axis *axis);

#endif
