/* SPDX-License-Identifier: MIT */
/* mps2.h: the registers used of Arm's MPS2 board with image AN385 (Cortex-M3, 25 MHz); QEMU calls it mps2-an385. */
#ifndef MPS2_H
#define MPS2_H

#include <stdbool.h>
#include <stdint.h>

#include "cortex.h"
#include "pulses.h"

#define MPS2_CLOCK 25000000u /* Hz, of the processor and of everything below */

/* CMSDK UART: a buffer of one byte each way. */
struct mps2_uart {
    volatile uint32_t data, state, control, interrupt, divider;
};
#define MPS2_UART0 ((struct mps2_uart *)0x40004000)
#define UART_SENDING 1u /* state: the transmit buffer is full */
#define UART_RECEIVED 2u /* state: the receive buffer is full */
#define UART_ON (1u | 2u | 4u | 8u) /* control: transmitter, receiver, an interrupt of each */
#define UART_RECEIVE_INTERRUPT 8u
#define UART_SENT 1u /* interrupt: write 1 to clear */
#define UART_CAME 2u

/* CMSDK timer: counts down; with reload at 0 it stops at 0, once. */
struct mps2_timer {
    volatile uint32_t control, value, reload, interrupt;
};
#define MPS2_TIMER0 ((struct mps2_timer *)0x40000000)
#define MPS2_TIMER1 ((struct mps2_timer *)0x40001000)
#define TIMER_ON (1u | 8u) /* control: counts, and its interrupt is on */

/* CMSDK GPIO, 16 pins. low[mask] and high[mask] write only the pins of the mask, in one access. */
struct mps2_gpio {
    volatile uint32_t data, out, unused[2], enable_set, enable_clear, unused2[2];
    volatile uint32_t interrupt_set, interrupt_clear, edge_set, edge_clear, high_level_set, high_level_clear, status;
    volatile uint32_t unused3[241];
    volatile uint32_t low[256], high[256];
};
#define MPS2_GPIO0 ((struct mps2_gpio *)0x40010000)
#define MPS2_GPIO1 ((struct mps2_gpio *)0x40011000)

/* FPGA I/O: a free counter behind a prescaler. */
#define MPS2_COUNTER (*(volatile uint32_t *)0x40028018)
#define MPS2_PRESCALE (*(volatile uint32_t *)0x4002801c)
/* Configuration registers: eight LEDs, eight switches. */
#define MPS2_LEDS (*(volatile uint32_t *)0x4002f004)
#define MPS2_SWITCHES (*(volatile uint32_t *)0x4002f00c)

/* Interrupts of the processor. */
enum mps2_interrupt { IRQ_UART0_RECEIVE = 0, IRQ_UART0_SENT = 1, IRQ_GPIO0 = 6, IRQ_GPIO1 = 7, IRQ_TIMER0 = 8,
                      IRQ_TIMER1 = 9 };

/* Pins. GPIO0: 0-3 step, 4-7 direction of motors 1-4, 8 RS485 driver-enable, 9-15 inputs of axis Y of a PMC-2HS.
 * GPIO1: 0-7 DO 01-08, 8-15 DI 01-08. */
#define BOARD_DRIVER_PIN 8u
#define BOARD_INPUT_PIN 8u
#define BOARD_MORE_PIN 9u
#define BOARD_MORE_INPUTS 7u

/* Cycles of the board's clock in one tick of the unit, 1 us. (tools/port-figures slows the unit's time down by more.) */
#ifndef BOARD_TICK_CYCLES
#define BOARD_TICK_CYCLES 25u
#endif

/* Priorities, 0 is the most urgent: a pulse does not wait; a byte waits for pulses (it has 521 us). */
#define BOARD_PRIORITY_PULSES 0x00u
#define BOARD_PRIORITY_LINE 0x80u
#define BOARD_PRIORITY_INPUTS 0xc0u

/* uart.c: the UART, and the timer that ends a transmission. */
void uart_start(void);
void uart_receive_interrupt(void);
void uart_sent_interrupt(void);
void uart_timer_interrupt(void);

/* board.c: the pins as pulses.c moves them; RS485 driver on or off; the one-shot timer has run out; an input has changed. */
extern const struct pulse_pins board_pins;
void board_driver(bool on);
void board_timer_interrupt(void);
void board_input_interrupt(void);

#endif
