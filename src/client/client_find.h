/* SPDX-License-Identifier: MIT */
/* client_find.h: the emulators of this user that are running now: those that answer on a control socket
 * (/proc/net/unix), or at the address of a control file in the folders of default links. */
#ifndef RKM04_CLIENT_FIND_H
#define RKM04_CLIENT_FIND_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#define CLIENT_FOUND_MAX 32u

struct client_found {
    char control[PATH_MAX]; /* of the control socket */
    char port[PATH_MAX];    /* of its bus, as --port takes it; empty: it has several buses, or reported none */
};

/* Find at most CLIENT_FOUND_MAX of them. Returns their number. */
size_t client_find(struct client_found found[CLIENT_FOUND_MAX]);

/* The one that is meant by who names none. NULL: there is none, or there are several, which is reported; `option` is what
 * chooses one ("--port"). */
const struct client_found *client_find_one(const char *option);

/* The one with the bus `port`, or, where `control` is not NULL, with this control socket. Returns false, and reports nothing, if
 * there is none. */
bool client_find_pair(const char *port, const char *control, struct client_found *pair);

#endif
