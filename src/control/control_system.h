/* SPDX-License-Identifier: MIT */
/* control_system.h: what the control socket needs of Unix sockets. src/windows has another one, for a system without them. */
#ifndef RKM04_CONTROL_SYSTEM_H
#define RKM04_CONTROL_SYSTEM_H

#include <stdbool.h>
#include <uv.h>

/* Make a socket, for its owner alone from the beginning; it does not listen yet. Returns a descriptor; -1: errno says why,
 * ENAMETOOLONG: the name is too long for a socket. */
int control_system_bind(const char *path);

/* Is there a socket? */
bool control_system_is_socket(const char *path);

/* Does a process listen at this socket, or can that not be said? */
bool control_system_is_alive(const char *path);

/* Has the client at the other end of a connection closed both directions (not just its sending side)? */
bool control_system_is_gone(const uv_pipe_t *pipe);

/* The TCP address where a system without such sockets listens instead; NULL: this one has them. */
const char *control_system_instead(void);

#endif
