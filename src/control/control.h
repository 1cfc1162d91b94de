/* SPDX-License-Identifier: MIT */
/* control.h: the control socket: JSON-RPC 2.0, one object a line, on a Unix stream socket. docs/CONTROL.md is the protocol. */
#ifndef RKM04_CONTROL_H
#define RKM04_CONTROL_H

#include <jansson.h>
#include <uv.h>

#include "bus/bus.h"

struct control;

struct control_calls {
    void (*shutdown)(void *context);               /* a client wants the emulator to end */
    void (*presence)(void *context);               /* a client has come or gone */
    json_t *(*ready)(void *context);               /* what READY says, as it is now; a new reference, NULL: out of memory */
    void *context;
};

/* Open the socket `path`, for this user alone. Failures are reported. Returns NULL if it did not work. */
struct control *control_open(uv_loop_t *loop, const char *path, struct bus *const *buses, unsigned lines,
                             const struct control_calls *calls);

const char *control_path(const struct control *control);

/* How many clients are there. */
unsigned control_clients(const struct control *control);

/* Remove the socket, hang up on everybody. The loop has to run out before control_free(). NULL: nothing. */
void control_close(struct control *control);
void control_free(struct control *control);

#endif
