/* SPDX-License-Identifier: MIT */
/* client_request.h: the commands of rkmctl that are one request to a unit on the line (manual 5.3). */
#ifndef RKM04_CLIENT_REQUEST_H
#define RKM04_CLIENT_REQUEST_H

#include <rkm04/link.h>

#include "client_answer.h"

#define CLIENT_REQUEST_NAMES "version, set, send, store, position, command, table, progress or raw"

struct client_request {
    const char *port;         /* NULL: not named */
    const struct rkm04_framing *framing;
    unsigned node, motor, timeout_ms, message_max;
    bool json, allow_overflow;
    const char *const *words; /* after the name of the command */
    size_t count;
};

/* Is `name` one of them? */
bool client_request_has(const char *name);

/* Send the request `name` and show the answer. Returns the exit status. */
enum exit_status client_request(const struct client_request *request, const char *name);

#endif
