/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_NETDB_H
#define RKM04_WINDOWS_NETDB_H

struct addrinfo;

#endif
