/* SPDX-License-Identifier: MIT */
/* port.h: a way to a unit for a Windows program: a COM port by the Win32 API, or a TCP socket. */
#ifndef RKM04_TESTS_WINDOWS_PORT_H
#define RKM04_TESTS_WINDOWS_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <winsock2.h> /* and with it windows.h */

#define LIMIT_MS 30000u /* until something counts as never coming */

struct port {
    HANDLE com; /* INVALID_HANDLE_VALUE: a socket */
    SOCKET socket;
    bool overlapped; /* the COM port was opened for it */
    HANDLE done[2];  /* events for overlapped reads and writes */
};

/* Open COM1...COM256, or tcp:HOST:PORT. Returns false if that does not work (reported). */
bool port_open(struct port *port, const char *name, bool overlapped);
void port_close(struct port *port);

/* 19200 baud, 8N1, no flow control, RTS and DTR on; a read waits for all bytes, up to LIMIT_MS. */
bool port_set_up(const struct port *port);

/* Write all bytes. Returns false if that does not work (reported). */
bool port_write(const struct port *port, const uint8_t *bytes, size_t length);

/* Read `room` bytes of a COM port, within the timeouts that are set. Returns their number. */
DWORD com_read(const struct port *port, uint8_t *bytes, DWORD room);

/* Read one byte at least, `room` at most. Returns their number; 0: none within LIMIT_MS, or a failure (reported). */
size_t port_read(const struct port *port, uint8_t *bytes, size_t room);

/* Print what went wrong, with the error that Windows reports. Returns false. */
bool wrong(const char *what, DWORD error);

/* Send a request to unit 1 and wait for its answer, in HDLC frames. Returns the length of the answer; 0: none (reported). */
size_t unit_ask(const struct port *port, const void *request, size_t length, uint8_t *answer, size_t room);

/* The frame of a request to unit 1. `frame` takes 2 * length + 10 bytes. Returns its length. */
size_t unit_frame(const void *request, size_t length, uint8_t *frame);

#endif
