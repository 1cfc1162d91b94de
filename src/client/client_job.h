/* SPDX-License-Identifier: MIT */
/* client_job.h: one command of rkmctl to the control socket: what was typed, and what its parts share. */
#ifndef RKM04_CLIENT_JOB_H
#define RKM04_CLIENT_JOB_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

#include "client_answer.h"
#include "client_rpc.h"
#include "client_usage.h"

#define CLIENT_JOB_TIMEOUT_MS 10000 /* for what is answered at once */

struct client_job {
    const char *path;         /* of the control socket; NULL: the default */
    const char *unit;         /* NULL: not named */
    const char *limit;        /* --limit; NULL: none */
    int line;                 /* -1: not named */
    int timeout_ms;           /* of real time; 0: not given */
    bool json, once, advance, force;
    const char *const *words; /* after the name of the command */
    size_t count;
    bool connected;
    struct client_rpc rpc;
};

/* Connect if that has not been done. Returns false if it did not work (reported). */
bool client_job_connect(struct client_job *job);

/* Call a method; --line and, with `of_unit`, --unit are added to `params`, whose reference is taken (NULL: none). Refusals and a
 * silent emulator are reported. The second is for what may last: there is no time limit unless one was given.
 * Returns the exit status; *result is a new reference if that is STATUS_SUCCESS, otherwise NULL. */
enum exit_status client_job_call(struct client_job *job, const char *method, json_t *params, bool of_unit, json_t **result);
enum exit_status client_job_call_long(struct client_job *job, const char *method, json_t *params, json_t **result);

/* What client_job_call() has to add and what it makes of an outcome, for those who send and receive by themselves. */
json_t *client_job_params(const struct client_job *job, json_t *params, bool of_unit);
enum exit_status client_job_outcome(const struct client_job *job, enum client_rpc_outcome outcome, json_t *json);

/* Print the result: as JSON with --json, otherwise nothing. Takes the reference. Returns the exit status. */
enum exit_status client_job_done(const struct client_job *job, json_t *result);

/* Call a method of a unit and show its result: as JSON with --json, otherwise by `print`; NULL: there is nothing to show. Takes
 * the reference of `params`; NULL: they are not UTF-8 (reported). Returns the exit status. */
enum exit_status client_job_show(struct client_job *job, const char *method, json_t *params, void (*print)(const json_t *result));

/* Words NAME=VALUE as members of `params`: whole and other numbers, true, false as such, everything else as a string.
 * Returns false if a word is not of that form (reported). */
bool client_job_members(json_t *params, const char *const *words, size_t count);

/* Print the members of an object that are there and not in the list `but`, which ends with NULL, as "  NAME=VALUE" each. */
void client_job_print_members(const json_t *object, const char *const *but);

/* Parameters with `file`, the place of a file as seen from here: the emulator may run in another folder. Returns a new reference,
 * or NULL (reported). */
json_t *client_job_file(const char *path);

/* The same for a file that the emulator is to write: with `force' if --force was given. */
json_t *client_job_output(const struct client_job *job, const char *path);

/* The commands, one function each: client_control.c, client_control_time.c, client_control_state.c, client_control_plant.c,
 * client_control_cib.c, client_control_cnc.c. */
typedef enum exit_status client_job_function(struct client_job *job);

client_job_function client_control_state, client_control_di;
client_job_function client_control_wait, client_control_advance, client_control_events, client_control_trace;
client_job_function client_control_fault, client_control_plant, client_control_cib, client_control_cnc;

#endif
