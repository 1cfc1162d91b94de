/* SPDX-License-Identifier: MIT */
#include <sockets.h>

#undef getaddrinfo

int windows_getaddrinfo(const char *host, const char *port, const struct addrinfo *hints, struct addrinfo **found)
{
    WSADATA data;
    int error = WSAStartup(MAKEWORD(2, 2), &data);
    return error != 0 ? error : getaddrinfo(host, port, hints, found);
}

const char *windows_gai_strerror(int error)
{
    switch (error) {
    case EAI_NONAME:
    case WSANO_DATA:
        return "Name or service not known";
    case EAI_AGAIN:
        return "Temporary failure in name resolution";
    default:
        return "the name cannot be looked up";
    }
}
