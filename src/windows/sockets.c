/* SPDX-License-Identifier: MIT */
#include <sockets.h>

#undef getaddrinfo

int windows_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **found)
{
    WSADATA data;
    int error = WSAStartup(MAKEWORD(2, 2), &data);
    return error != 0 ? error : getaddrinfo(host, port, hints, found);
}
