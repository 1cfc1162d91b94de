/* SPDX-License-Identifier: MIT */
/* pmc_loop.h: the main loop of a board that is a PMC-1HS or PMC-2HS, as loop.h is that of an RKM04. Axes X and Y are motors 1 and
 * 2; the outputs of X are DO 01 and 02, those of Y DO 03 and 04; the inputs of X and emg, in the order of enum pmc_input, are
 * DI 01 to 08, those of Y board_more_inputs(). The Modbus address is the switch + 1.
 *
 * Pulses are exact to the microsecond, and 10 us long. Faster ones than the board can play are not dropped: the unit's time gets
 * slower than the clock. The Makefile gives BOARD_AXES, BOARD_FACE and LINE_BAUD. */
#ifndef PMC_LOOP_H
#define PMC_LOOP_H

#include "pmc/pmc.h"

extern struct pmc_unit unit;
extern const struct pmc_port pmc_loop_port;

/* Power-up of board and unit. */
void pmc_loop_start(void);

/* Do what is to be done now, then sleep until there is more. */
void pmc_loop_turn(void);

#endif
