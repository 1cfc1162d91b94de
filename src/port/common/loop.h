/* SPDX-License-Identifier: MIT */
/* loop.h: the main loop of a board whose pulses are exact. It keeps the unit ahead of the clock; what the unit wants done at
 * which tick waits in pulses.c, and an interrupt of the board does it. Motions are planned here: no pulse waits for that. */
#ifndef LOOP_H
#define LOOP_H

#include <rkm04/unit.h>

extern struct rkm04_unit unit;
extern const struct rkm04_port loop_port;

/* Power-up of board and unit. */
void loop_start(void);

/* Do what is to be done now, then sleep until there is more. */
void loop_turn(void);

#endif
