/* SPDX-License-Identifier: MIT */
/* client.h: the face of the room for `rkmctl`: requests over a port, and methods of a control socket. */
#ifndef RKM04_CLIENT_H
#define RKM04_CLIENT_H

#include "client_control.h"
#include "client_link.h"
#include "client_request.h"
#include "client_usage.h"

#endif
