/* SPDX-License-Identifier: MIT */
/* control.h: the control socket: JSON-RPC 2.0, one object a line, on a Unix stream socket, or at a TCP port of the loopback
 * interface whose clients need a token from a file. docs/CONTROL.md is the protocol. */
#ifndef RKM04_CONTROL_H
#define RKM04_CONTROL_H

#include <jansson.h>
#include <uv.h>

#include "bus/bus.h"

#define CONTROL_STRANGERS 8u /* TCP clients that have not shown the token yet */

struct control;

struct control_calls {
    void (*shutdown)(void *context);               /* a client wants the emulator to end */
    void (*presence)(void *context);               /* a client has come or gone */
    json_t *(*ready)(void *context);               /* what READY says, as it is now; a new reference, NULL: out of memory */
    void *context;
};

/* Does the text name a TCP port of the loopback interface: as net_address_valid() and with no host, localhost, 127.x.x.x or ::1?
 * Names are taken at their word: control_open() sees to it that the address is one. */
#define CONTROL_TCP_EXPECTED "PORT or HOST:PORT with 127.0.0.1, [::1] or localhost and PORT from 0 to 65535 (0: a free one)"
bool control_tcp_valid(const char *address);

/* Open the socket `path`, for this user alone; or listen at the TCP address `tcp` (in digits; NULL: none, where the system has
 * Unix sockets) and write the control file `path`, for this user alone. Failures are reported. Returns NULL if it did not
 * work. */
struct control *control_open(uv_loop_t *loop, const char *path, const char *tcp, struct bus *const *buses, unsigned lines,
                             const struct control_calls *calls);

/* The path, and the TCP address (NULL: a Unix socket). */
const char *control_path(const struct control *control);
const char *control_address(const struct control *control);

/* How many clients are there. */
unsigned control_clients(const struct control *control);

/* Remove the socket, hang up on everybody; on who asked for the end with control_hang_up() alone, when nothing is left to be
 * done. The loop has to run out before control_free(). NULL: nothing. */
void control_close(struct control *control);
void control_hang_up(struct control *control);
void control_free(struct control *control);

#endif
