/* SPDX-License-Identifier: MIT */
/* uart.h: the serial line: bytes in and out by interrupt, RS485 driver on while there is something to say. */
#ifndef UART_H
#define UART_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* 19200 baud, 8N1 (U7); driver off. */
void uart_start(void);

/* What has come in and not been taken yet, as far as it lies in one piece. Returns its length. */
size_t uart_poll(const uint8_t **bytes);

/* So many bytes of it have been taken. */
void uart_take(size_t count);

/* Free places in the queue of what goes out. */
size_t uart_room(void);

/* Send; at most uart_room() bytes. */
void uart_send(const uint8_t *bytes, size_t count);

/* Has the main loop something to do for the line: bytes came since uart_poll, or it has more to send and half of the queue is
 * free? With interrupts off. */
bool uart_needs_main_loop(bool more);

void uart_receive_interrupt(void);
void uart_sent_interrupt(void);
void uart_timer_interrupt(void);

#endif
