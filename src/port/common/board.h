/* SPDX-License-Identifier: MIT */
/* board.h: what a board has to do for loop.c, which is the same on all of them: the unit runs ahead of the clock, what it wants
 * done at which tick waits in `board_pulses`, and an interrupt of the board does it. All is called by the main loop.
 * The board's Makefile or compiler options give BOARD_TICKS_AHEAD. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "pulses.h"

/* How far the unit runs ahead, in ticks: more than the longest planning takes, plus 1000. Commands and inputs take effect later
 * by as much, and an answer is ahead by as much. */
#ifndef BOARD_TICKS_AHEAD
#define BOARD_TICKS_AHEAD 7000u
#endif

/* The main loop puts in, an interrupt of the board plays. Defined in loop.c. */
extern struct pulses board_pulses;

/* Once, before anything else: clocks, pins (all outputs at 0), line at 19200 8N1 (U7), flash. No pulse is played yet. */
void board_start(void);

/* Let board_clock begin at 0, and the pulses be played. */
void board_clock_start(void);

/* Microseconds since board_clock_start, never going back. Called more than once in 71 minutes. */
uint64_t board_clock(void);

/* Call wake_at with this tick, and have the interrupt look at the pulses again, since something may have been put there. */
void board_play(uint32_t wake);

/* Interrupts on or off; wait for one with them off: what is pending already, or comes, ends the wait. */
void board_interrupts(bool on);
void board_wait(void);

/* Begin anew, as after switching on. */
void board_reset(void);

/* Terminals DI 01..08, bit 0 is DI 01; 1 = current flows. */
uint8_t board_inputs(void);

/* Seven inputs besides, for pmc_loop.c: bit 0 is the first. */
uint8_t board_more_inputs(void);

/* Switch S1: 0..15, S1-1 is bit 0 (U4). */
uint8_t board_switch(void);

/* LED of motor 1..4. */
void board_led(unsigned motor, bool lit);

/* The line has been given something to send, or room for what comes in: have the UART's interrupt look. */
void board_line(void);

/* Another speed of the line than LINE_BAUD from now on, for pmc_loop.c. */
void board_baud(uint32_t baud);

/* Flash, callbacks of struct rkm04_port. */
int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length);
int board_flash_erase(void *context, unsigned block);
int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length);

#endif
