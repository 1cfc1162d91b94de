/* SPDX-License-Identifier: MIT */
/* command.h: what can be done to a line and asked of it from outside, at the present tick, by name and JSON parameters. The
 * control socket, scenarios and replays all go this way; docs/CONTROL.md describes each method.
 *
 * Each file that implements methods ends with their table: name, function, whether it changes anything (then the journal takes it
 * down). command.c lists the tables of this room; a room above it (record, a kind of device) attaches its own to the sim with
 * command_attach(). Parameters: `unit`, a name as in "3" or 3, may be left out where there is one unit. */
#ifndef RKM04_COMMAND_H
#define RKM04_COMMAND_H

#include <jansson.h>
#include <stdbool.h>

#include "sim/sim.h"

/* Why a command was refused: codes of JSON-RPC 2.0. */
enum refusal_code {
    REFUSED_METHOD = -32601, /* no such method */
    REFUSED_PARAMS = -32602, /* wrong parameters: text says which, and what was expected */
    REFUSED_MEMORY = -32603,
    REFUSED_STATE = -32000   /* cannot be done now: text says why and what to do */
};

struct refusal {
    int code;
    char text[640];
};

typedef json_t *command_function(struct sim *sim, const json_t *params, struct refusal *refusal);

/* A method. Tables of them end with a row without name. */
struct command_method {
    const char *name;
    command_function *function;
    bool changes; /* something: the journal takes it down */
};

/* Attach the methods of a table, too, which must stay; after sim_begin(). Does nothing if they are attached already.
 * Returns false if SIM_COMMAND_TABLES are attached. */
bool command_attach(struct sim *sim, const struct command_method *methods);

/* Do it. `params`: an object or NULL. Returns the result, a new reference; NULL: refused, nothing was changed. */
json_t *sim_command(struct sim *sim, const char *method, const json_t *params, struct refusal *refusal);

/* Does `sim` know such a method? */
bool sim_has_command(const struct sim *sim, const char *method);

/* ---- For the functions behind it -------------------------------------------------------------------------------------- */

/* Refuse; always returns NULL. */
json_t *refuse(struct refusal *refusal, int code, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Read `unit` (string or number; may be left out where there is one unit). Returns its number on the line; 0: refused. */
unsigned param_unit(struct sim *sim, const json_t *params, struct refusal *refusal);

/* Read a whole number low..high. Returns false if it is missing or wrong: refused. With `missing` it may be left out. */
bool param_integer(const json_t *params, const char *name, int64_t low, int64_t high, int64_t *value, struct refusal *refusal);
bool param_integer_or(const json_t *params, const char *name, int64_t low, int64_t high, int64_t missing, int64_t *value,
                      struct refusal *refusal);

/* Read a time: a whole number of us, or a string as in time_value.h ("1.5s"). Refused as above; `missing`: DEVICE_NEVER must be
 * given. */
bool param_time(const json_t *params, const char *name, uint64_t missing, uint64_t *ticks, struct refusal *refusal);

/* Read a string. Returns NULL if it is missing or no string: refused. */
const char *param_string(const json_t *params, const char *name, struct refusal *refusal);

/* Read true or false, false if it is missing. Returns false: refused. */
bool param_flag(const json_t *params, const char *name, bool *value, struct refusal *refusal);

/* Refuse every parameter that is not in the list, which ends with NULL: a typing error must not go unnoticed. */
bool params_known(const json_t *params, const char *const *names, struct refusal *refusal);

#endif
