/* SPDX-License-Identifier: MIT */
/* client_rpc.h: the way to the control socket of an emulator: JSON-RPC 2.0, one object a line (docs/CONTROL.md). The path is that
 * of a Unix socket, or of a control file with a TCP address and a token. */
#ifndef RKM04_CLIENT_RPC_H
#define RKM04_CLIENT_RPC_H

#include <jansson.h>
#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#define CLIENT_RPC_FOREVER (-1) /* as a time limit */

struct client_rpc {
    char path[PATH_MAX];
    int fd;
    json_int_t id;           /* of the last request */
    char *buffer;            /* what has come and was not yet read: `length` bytes from `begin` on */
    size_t begin, length, room;
    void (*notified)(void *context, const char *method, const json_t *params); /* an event has come; NULL: not wanted */
    void *context;
    bool quiet;              /* what goes wrong is not reported but kept in `trouble` */
    char trouble[PATH_MAX + 128];
};

enum client_rpc_outcome {
    CLIENT_RPC_RESULT,
    CLIENT_RPC_REFUSED, /* an error came: {code, message, …} */
    CLIENT_RPC_NOTHING, /* not within the time limit */
    CLIENT_RPC_LOST     /* the emulator has gone, or talks something else (reported) */
};

/* The socket to talk to: `path`; NULL: the environment's RKM04_CONTROL; without that the one next to the link that
 * `rkm04 serve` makes by default. Returns false if the name is too long (reported). */
bool client_rpc_path(const char *path, char found[PATH_MAX]);

/* Connect; an emulator that does not answer is given 10 s. *rpc must be zero. Failures are reported with advice.
 * client_rpc_close() is due if it returns true. */
bool client_rpc_open(struct client_rpc *rpc, const char *path);
void client_rpc_close(struct client_rpc *rpc);

/* Send a request; takes the reference to `params` (an object; NULL: none). Returns false if the emulator has gone, or takes no
 * request within 10 s (reported). */
bool client_rpc_send(struct client_rpc *rpc, const char *method, json_t *params);

/* Wait up to `timeout_ms` for the answer to the last request; events that come before it are handed to `notified`. *json is a new
 * reference to the result or error, NULL with the other outcomes. */
enum client_rpc_outcome client_rpc_receive(struct client_rpc *rpc, int timeout_ms, json_t **json);

/* Both, within `timeout_ms`. After 5 s without an answer a person at the terminal is informed. */
enum client_rpc_outcome client_rpc_call(struct client_rpc *rpc, const char *method, json_t *params, int timeout_ms,
                                        json_t **json);

/* Wait up to `timeout_ms` for the end of the connection; what comes before it is dropped. Returns whether it has ended. */
bool client_rpc_ends(struct client_rpc *rpc, int timeout_ms);

/* Wait up to `timeout_ms` for at least one event, or the answer to the last request. With CLIENT_RPC_RESULT *json is NULL if only
 * events came. */
enum client_rpc_outcome client_rpc_listen(struct client_rpc *rpc, int timeout_ms, json_t **json);

#endif
