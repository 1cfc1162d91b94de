/* SPDX-License-Identifier: MIT */
#include "board.h"
#include "line.h"
#include "mps2.h"

static uint32_t baud = LINE_BAUD;

void board_baud(uint32_t wanted)
{
    baud = wanted;
    MPS2_UART0->divider = (MPS2_CLOCK + baud / 2) / baud;
}

void uart_start(void)
{
    board_driver(false);
    MPS2_TIMER1->control = 0;
    MPS2_TIMER1->reload = 0;
    board_baud(LINE_BAUD);
    MPS2_UART0->control = UART_ON;
    NVIC_PRIORITY[IRQ_UART0_RECEIVE] = BOARD_PRIORITY_LINE;
    NVIC_PRIORITY[IRQ_UART0_SENT] = BOARD_PRIORITY_LINE;
    NVIC_PRIORITY[IRQ_TIMER1] = BOARD_PRIORITY_LINE;
    NVIC_ENABLE[0] = 1u << IRQ_UART0_RECEIVE | 1u << IRQ_UART0_SENT | 1u << IRQ_TIMER1;
}

/* If the queue is full the interrupt is off until there is room again (and QEMU waits with the next byte). */
void uart_receive_interrupt(void)
{
    MPS2_UART0->interrupt = UART_CAME;
    while (MPS2_UART0->state & UART_RECEIVED) {
        if (!line_has_room()) {
            MPS2_UART0->control = UART_ON & ~UART_RECEIVE_INTERRUPT;
            return;
        }
        line_came((uint8_t)MPS2_UART0->data);
    }
}

/* A byte to send, or one in the UART for which there was no room: the interrupts do the rest. */
void board_line(void)
{
    if (!(MPS2_UART0->control & UART_RECEIVE_INTERRUPT) && line_has_room()) {
        MPS2_UART0->control = UART_ON;
        NVIC_PEND[0] = 1u << IRQ_UART0_RECEIVE;
    }
    NVIC_PEND[0] = 1u << IRQ_UART0_SENT;
}

/* The buffer of the UART is empty: the next byte. If there is none the last one is being shifted out: driver off after it. */
void uart_sent_interrupt(void)
{
    uint8_t byte;
    MPS2_UART0->interrupt = UART_SENT;
    if ((MPS2_UART0->state & UART_SENDING) || !line_drives(false))
        return;
    board_driver(true);
    if (line_next(&byte)) {
        MPS2_TIMER1->control = 0;
        MPS2_UART0->data = byte;
    } else if (!(MPS2_TIMER1->control & 1u)) {
        MPS2_TIMER1->value = 10u * MPS2_CLOCK / baud + 1; /* start bit, 8 bits, stop bit */
        MPS2_TIMER1->control = TIMER_ON;
    }
}

void uart_timer_interrupt(void)
{
    MPS2_TIMER1->interrupt = 1;
    MPS2_TIMER1->control = 0;
    board_driver(line_drives(true));
}
