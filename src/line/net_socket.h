/* SPDX-License-Identifier: MIT */
/* net_socket.h: what the system knows of a TCP connection before the event loop does. */
#ifndef RKM04_LINE_NET_SOCKET_H
#define RKM04_LINE_NET_SOCKET_H

#include <stdbool.h>
#include <stdint.h>
#include <sys/types.h>
#include <uv.h>

/* Before it listens: let it keep no more of the system than one connection needs. */
void net_socket_prepare_listener(uv_tcp_t *listener);

/* Bytes that have come and have not been read. */
size_t net_socket_waiting(const uv_tcp_t *tcp);

/* Has the other side closed it, or has it failed? Bytes may still wait. */
bool net_socket_has_ended(const uv_tcp_t *tcp);

/* Read what waits, without waiting for more. Returns the number of bytes; 0: there are none; -1: the connection has failed. */
ssize_t net_socket_read(const uv_tcp_t *tcp, uint8_t *bytes, size_t room);

#endif
