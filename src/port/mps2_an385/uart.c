/* SPDX-License-Identifier: MIT */
#include "uart.h"

#include "board.h"
#include "mps2.h"

#define BAUD 19200u
#define ROOM 64u /* of each queue; a power of 2. 64 bytes are 33 ms of the line. */
#define BYTE_CYCLES (10u * MPS2_CLOCK / BAUD + 1) /* start bit, 8 bits, stop bit */

struct queue {
    volatile uint32_t in, out; /* bytes ever; each has one writer */
    uint8_t byte[ROOM];
};

static struct queue received, sending;
static uint32_t seen; /* received.in when the main loop looked last */

static uint32_t used(const struct queue *queue)
{
    return queue->in - queue->out;
}

static void put(struct queue *queue, uint8_t byte)
{
    uint32_t in = queue->in;
    queue->byte[in % ROOM] = byte;
    __atomic_signal_fence(__ATOMIC_SEQ_CST); /* the byte is there before the other side sees that there is one */
    queue->in = in + 1;
}

void uart_start(void)
{
    board_driver(false);
    MPS2_TIMER1->control = 0;
    MPS2_TIMER1->reload = 0;
    MPS2_UART0->divider = (MPS2_CLOCK + BAUD / 2) / BAUD;
    MPS2_UART0->control = UART_ON;
    NVIC_PRIORITY[IRQ_UART0_RECEIVE] = BOARD_PRIORITY_LINE;
    NVIC_PRIORITY[IRQ_UART0_SENT] = BOARD_PRIORITY_LINE;
    NVIC_PRIORITY[IRQ_TIMER1] = BOARD_PRIORITY_LINE;
    NVIC_ENABLE = 1u << IRQ_UART0_RECEIVE | 1u << IRQ_UART0_SENT | 1u << IRQ_TIMER1;
}

/* ---- In --------------------------------------------------------------------------------------------------------------- */

/* If the queue is full the byte stays in the UART, and the interrupt off, until uart_take. What comes on top of that is lost,
 * as it must be on a line without handshake (and QEMU waits with the next byte). */
void uart_receive_interrupt(void)
{
    MPS2_UART0->interrupt = UART_CAME;
    while (MPS2_UART0->state & UART_RECEIVED) {
        if (used(&received) == ROOM) {
            MPS2_UART0->control = UART_ON & ~UART_RECEIVE_INTERRUPT;
            return;
        }
        put(&received, (uint8_t)MPS2_UART0->data);
    }
}

size_t uart_poll(const uint8_t **bytes)
{
    seen = received.in;
    uint32_t at = received.out % ROOM, count = seen - received.out;
    *bytes = received.byte + at;
    return count < ROOM - at ? count : ROOM - at;
}

void uart_take(size_t count)
{
    received.out += (uint32_t)count;
    if (!(MPS2_UART0->control & UART_RECEIVE_INTERRUPT) && used(&received) < ROOM) {
        MPS2_UART0->control = UART_ON;
        NVIC_PEND = 1u << IRQ_UART0_RECEIVE; /* for the byte that is in the UART */
    }
}

/* ---- Out -------------------------------------------------------------------------------------------------------------- */

size_t uart_room(void)
{
    return ROOM - used(&sending);
}

void uart_send(const uint8_t *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++)
        put(&sending, bytes[i]);
    NVIC_PEND = 1u << IRQ_UART0_SENT; /* there everything else happens */
}

/* The buffer of the UART is empty: the next byte. If there is none the last one is being shifted out: driver off after it. */
void uart_sent_interrupt(void)
{
    MPS2_UART0->interrupt = UART_SENT;
    MPS2_TIMER1->control = 0;
    if (used(&sending) > 0)
        board_driver(true);
    while (used(&sending) > 0 && !(MPS2_UART0->state & UART_SENDING)) {
        MPS2_UART0->data = sending.byte[sending.out % ROOM];
        sending.out++;
    }
    if (used(&sending) == 0 && !(MPS2_UART0->state & UART_SENDING)) {
        MPS2_TIMER1->value = BYTE_CYCLES;
        MPS2_TIMER1->control = TIMER_ON;
    }
}

void uart_timer_interrupt(void)
{
    MPS2_TIMER1->interrupt = 1;
    MPS2_TIMER1->control = 0;
    board_driver(false);
}

bool uart_needs_main_loop(bool more)
{
    return received.in != seen || (more && used(&sending) <= ROOM / 2);
}
