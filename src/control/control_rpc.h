/* SPDX-License-Identifier: MIT */
/* control_rpc.h: JSON-RPC 2.0 of the control socket, one object a line: requests read, answers written. Pure. */
#ifndef RKM04_CONTROL_RPC_H
#define RKM04_CONTROL_RPC_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "command/command.h"

#define RPC_DEPTH 64u /* nested lists and objects */

/* Codes of JSON-RPC besides those of command.h. */
enum rpc_code { RPC_NO_JSON = -32700, RPC_NO_REQUEST = -32600, RPC_NO_TOKEN = -32001 };

/* A request. All of it belongs to `json`. */
struct rpc_request {
    json_t *json;       /* to be given back by rpc_end() */
    const json_t *id;   /* NULL: it is not to be answered */
    const char *method;
    json_t *params;     /* an object of its own, without `line`; may be changed; never NULL */
    unsigned line;      /* the parameter `line`; 0 if it was left out */
    bool line_given;
};

/* Read line[0..length), one of `lines` lines exists. Returns false if it is no request: refused; `request->id` is what can be
 * made out of its id (JSON null if nothing). rpc_end() is due in either case. */
bool rpc_read(struct rpc_request *request, const char *line, size_t length, unsigned lines, struct refusal *refusal);
void rpc_end(struct rpc_request *request);

/* The text of an answer, with its newline. Take the reference to `result`. Return a string to be freed, or NULL if memory is
 * short. */
char *rpc_result(const json_t *id, json_t *result);
char *rpc_error(const json_t *id, const struct refusal *refusal);

/* The text of a notification, likewise. */
char *rpc_notification(const char *method, json_t *params);

#endif
