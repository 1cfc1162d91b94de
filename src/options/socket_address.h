/* SPDX-License-Identifier: MIT */
/* socket_address.h: the address of a Unix socket, of a path of any length. */
#ifndef RKM04_OPTIONS_SOCKET_ADDRESS_H
#define RKM04_OPTIONS_SOCKET_ADDRESS_H

#include <stdbool.h>
#include <sys/socket.h>
#include <sys/un.h>

#define SOCKET_NAME_SURE 80u /* bytes of a name (after the last /) that always fit */

/* Find the address of `path`. The system takes 107 bytes; a longer path is named through its folder, which stays open as
 * *folder (-1: not needed) until the caller closes it after bind() or connect(). Returns false if the name is empty or
 * longer than SOCKET_NAME_SURE and does not fit, or (errno) if the folder cannot be opened. */
bool socket_address_find(const char *path, struct sockaddr_un *address, int *folder);

#endif
