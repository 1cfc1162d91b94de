/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_SOCKET_H
#define RKM04_WINDOWS_SOCKET_H

struct sockaddr_storage;

#endif
