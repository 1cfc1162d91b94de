/* SPDX-License-Identifier: MIT */
/* control_socket.h: a Unix stream socket under a path, for its owner alone. */
#ifndef RKM04_CONTROL_SOCKET_H
#define RKM04_CONTROL_SOCKET_H

#include "control_place.h"

/* Make the socket `path` at a place that is not claimed; it does not listen yet. Failures are reported with advice. Returns its
 * descriptor; -1 if it did not work: then nothing is left. control_place_release() removes it. */
int control_socket_open(struct control_place *place, const char *path);

#endif
