/* SPDX-License-Identifier: MIT */
/* client_port.h: the way to the unit's line: a serial device, a pseudo terminal or tcp:HOST:PORT. */
#ifndef RKM04_CLIENT_PORT_H
#define RKM04_CLIENT_PORT_H

#include <stdbool.h>
#include <stdint.h>

/* A port in help texts; on Windows another one. */
#ifndef CLIENT_PORT_EXAMPLE
#define CLIENT_PORT_EXAMPLE "/dev/ttyUSB0"
#endif

/* Ticks of 1 us on a monotonic clock. */
uint64_t client_now(void);

/* Has the name the form of a port? (Every path has; tcp: wants HOST:PORT, an IPv6 address in [ ].) */
bool client_port_valid(const char *port);

/* Open the line `port`, which has to be valid: a terminal raw with 19200 baud, 8N1 (U7), locked against other programs that
 * lock, what has come before dropped. A lock, a name server and a connection are waited for up to `timeout_ms` each. Failures
 * are reported on stderr. Returns a non-blocking descriptor, or -1. */
int client_port_open(const char *port, unsigned timeout_ms);

#endif
