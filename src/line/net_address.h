/* SPDX-License-Identifier: MIT */
/* net_address.h: where a TCP port listens, as options name it. */
#ifndef RKM04_LINE_NET_ADDRESS_H
#define RKM04_LINE_NET_ADDRESS_H

#include <stdbool.h>
#include <sys/socket.h>

#define NET_ADDRESS_EXPECTED "HOST:PORT, [IPV6]:PORT or PORT with PORT from 0 to 65535 (0: a free one)"
#define NET_NAME_SIZE 80u /* bytes of an address in digits */

/* Has the text the form HOST:PORT, :PORT, PORT or [IPV6]:PORT? */
bool net_address_valid(const char *address);

/* Find what a valid address stands for, in digits: "127.0.0.1:4000", "[::1]:4000"; without a host 127.0.0.1. A name may take
 * `limit_ms`, and blocks meanwhile. Returns NULL, or what is wrong. */
const char *net_address_find(const char *address, unsigned limit_ms, char found[NET_NAME_SIZE]);

/* Read an address in digits. Returns NULL, or what is wrong. */
const char *net_address_read(const char *digits, struct sockaddr_storage *address);

/* Write an address in digits. */
void net_address_write(char digits[NET_NAME_SIZE], const struct sockaddr_storage *address);

#endif
