/* SPDX-License-Identifier: MIT */
/* board.h: clock, pins and LEDs of the board. */
#ifndef BOARD_H
#define BOARD_H

#include <stdbool.h>
#include <stdint.h>

#include "pulses.h"

/* Pins. GPIO0: 0-3 step, 4-7 direction of motors 1-4, 8 RS485 driver-enable. GPIO1: 0-7 DO 01-08, 8-15 DI 01-08. */
#define BOARD_DRIVER_PIN 8u
#define BOARD_INPUT_PINS 0xff00u

/* Cycles of the board's clock in one tick of the unit, 1 us. (tools/port-figures slows the unit's time down by more.) */
#ifndef BOARD_TICK_CYCLES
#define BOARD_TICK_CYCLES 25u
#endif

/* Priorities, 0 is the most urgent: a pulse does not wait; a byte waits for pulses (it has 521 us). */
#define BOARD_PRIORITY_PULSES 0x00u
#define BOARD_PRIORITY_LINE 0x80u
#define BOARD_PRIORITY_INPUTS 0xc0u

extern struct pulses board_pulses; /* main loop and timer interrupt share it */
extern const struct pulse_pins board_pins;

/* Once, before anything else: pins, clock, timer. */
void board_start(void);

/* Let the clock begin at 0. */
void board_clock_start(void);

/* Microseconds since board_clock_start. Main loop only: it counts the wraps of the hardware's 32 bits, so it has to be called at
 * least once in 71 minutes. */
uint64_t board_clock(void);

/* The timer interrupt looks at the pulses again (call it when something has been put there), and wakes the main loop at this
 * tick. */
void board_play(uint32_t wake);

/* Sleep until the tick handed to board_play, a change of an input, a byte on the line or, if there is more to send, room for
 * it. */
void board_sleep(bool more);

/* DI 01..08, S1 (0..15), LED of motor 1..4. */
uint8_t board_inputs(void);
uint8_t board_switch(void);
void board_led(unsigned motor, bool lit);

/* RS485 driver on or off. */
void board_driver(bool on);

/* The one-shot timer has run out; an input has changed. */
void board_timer_interrupt(void);
void board_input_interrupt(void);

#endif
