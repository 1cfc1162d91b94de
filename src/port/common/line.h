/* SPDX-License-Identifier: MIT */
/* line.h: the serial line: a queue each way between the main loop and the UART's interrupt, and when the RS485 driver is on. */
#ifndef LINE_H
#define LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifndef LINE_BAUD
#define LINE_BAUD 19200u
#endif
#define LINE_ROOM 64u /* of each queue; a power of 2. 64 bytes are 33 ms of the line. */

/* ---- Main loop ------------------------------------------------------------------------------------------------------ */

/* What has come in and not been taken yet, as far as it lies in one piece. Returns its length. */
size_t line_poll(const uint8_t **bytes);

/* So many bytes of it have been taken. */
void line_take(size_t count);

/* Free places in the queue of what goes out. */
size_t line_room(void);

/* Send; at most line_room() bytes. */
void line_send(const uint8_t *bytes, size_t count);

/* Has the main loop something to do for the line: bytes came since line_poll, or it has more to send and half of the queue is
 * free? With interrupts off. */
bool line_needs_main_loop(bool more);

/* ---- Interrupt ------------------------------------------------------------------------------------------------------ */

/* Is there room for what comes in? If not the byte stays in the UART; what comes on top of that is lost, as it must be on a bus
 * without handshake. */
bool line_has_room(void);

/* A byte has come in; there is room. */
void line_came(uint8_t byte);

/* Is there a byte to send? Then it is taken out of the queue. */
bool line_next(uint8_t *byte);

/* Shall the RS485 driver be on? From the first byte to send until the queue is empty and the UART is `idle`: the stop bit of the
 * last byte has left it. To be asked before a byte is handed to the UART, and when it may have become idle. */
bool line_drives(bool idle);

#endif
