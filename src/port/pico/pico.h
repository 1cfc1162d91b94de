/* SPDX-License-Identifier: MIT */
/* pico.h: pins of the Pico (docs/PICO.md draws them), and what its files share. */
#ifndef PICO_H
#define PICO_H

enum pico_pin {
    PIN_TX = 0, PIN_RX, PIN_DRIVER,        /* RS485; driver-enable high */
    PIN_DATA = 3, PIN_CLOCK, PIN_LATCH,    /* two 74HC595: DO 01-08, LEDs 1-4 */
    PIN_STEP = 6,                          /* step of motor 1, direction of motor 1, step of motor 2, ... */
    PIN_INPUTS = 14,                       /* DI 01-08; current pulls them low */
    PIN_SWITCH_1 = 22, PIN_SWITCH_2 = 26,  /* S1-1; S1-2 to S1-4. Closed pulls them low. */
    PIN_BOARD_LED = 25                     /* of the Pico itself: one of the LEDs is lit */
};

/* The timer's interrupt, every 100 us: feeds the PIO and the UART. */
void beat_interrupt(void);

#endif
