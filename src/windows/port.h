/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_PORT_H
#define RKM04_WINDOWS_PORT_H

#define PORT_FD 0x10000 /* the number of the port, which no file has */

/* The headers of Windows have other numbers for these than <poll.h>. */
enum { PORT_IN = 1, PORT_OUT = 4 };

/* Of a program that has a port: wait for its events, at most `timeout` ms. Returns those that there are. */
extern short (*port_poll)(short events, int timeout);

#endif
