/* SPDX-License-Identifier: MIT */
/* host_address.h: the address of a host by its name, found within a time. */
#ifndef RKM04_OPTIONS_HOST_ADDRESS_H
#define RKM04_OPTIONS_HOST_ADDRESS_H

#include <netdb.h>

/* Find the addresses of `host` (a name, or an address in digits) and `port` (digits), of the family (AF_UNSPEC: any). Digits are
 * read at once; a name blocks for as long as its name server takes, at most `limit_ms` (0: digits only). Returns NULL with a list
 * in *found, for freeaddrinfo(), or what is wrong, a text that stays. */
const char *host_address_find(const char *host, const char *port, int family, unsigned limit_ms, struct addrinfo **found);

#endif
