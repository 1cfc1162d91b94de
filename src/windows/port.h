/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_PORT_H
#define RKM04_WINDOWS_PORT_H

#include <stdbool.h>

#define PORT_FD 0x10000   /* the number of the port, which no file has */
#define CANCEL_FD 0x10001 /* that of the flag that ends a request: poll() finds it readable while it is set */

/* The headers of Windows have other numbers for these than <poll.h>. */
enum { PORT_IN = 1, PORT_OUT = 4 };

/* Of a program that has a port: wait for its events, at most `timeout` ms. Returns those that there are. */
extern short (*port_poll)(short events, int timeout);

/* The flag. Any thread may set it. */
void port_set_cancelled(bool cancelled);
bool port_is_cancelled(void);

#endif
