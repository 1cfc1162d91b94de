/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_UN_H
#define RKM04_WINDOWS_UN_H

struct sockaddr_un;

#endif
