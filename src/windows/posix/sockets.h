/* SPDX-License-Identifier: MIT */
/* sockets.h: included before the files that read and find addresses; the others do without the headers of Windows. */
#ifndef RKM04_WINDOWS_SOCKETS_H
#define RKM04_WINDOWS_SOCKETS_H

#include <posix.h>
#include <ws2tcpip.h>

#define EAI_SYSTEM 0x7fffffff /* never comes */

/* As getaddrinfo(), which needs the library begun. */
int windows_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **found);

/* Why, in the words of other systems. */
const char *windows_gai_strerror(int error);

#define getaddrinfo windows_getaddrinfo
#undef gai_strerror
#define gai_strerror windows_gai_strerror

#endif
