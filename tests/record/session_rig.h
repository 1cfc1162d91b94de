/* SPDX-License-Identifier: MIT */
/* session_rig.h: a line that lives through random sessions (requests, programs, inputs, faults, power) and takes down all that
 * can be seen of it, for tests of snapshots and records. */
#ifndef RKM04_TESTS_SESSION_RIG_H
#define RKM04_TESTS_SESSION_RIG_H

#include <check.h>

#include "command/command.h"
#include "sim/sim.h"

#define SECOND UINT64_C(1000000)

/* What was seen, a line each: "TICK unit 1 motor 2 step 15", "TICK heard 7e". Ticks count from `zero`. */
struct session {
    struct sim sim;
    struct watcher watcher;
    uint64_t zero;
    FILE *stream;
    char *text;
    size_t length;
    uint64_t dice;
    uint64_t taken; /* tick for which the last bytes were handed over */
};

/* How a line is made. */
struct session_kind {
    const char *nodes;
    bool timed, plain;
    const char *plant; /* NULL: none */
    const char *readings; /* NULL: the defaults */
};

extern const struct session_kind session_kinds[];
extern const size_t session_kind_count;

void session_begin(struct session *session, const struct session_kind *kind);
void session_end(struct session *session);

/* A number below `below`. */
uint64_t session_draw(struct session *session, uint64_t below);

/* Something random comes from outside at the present tick. */
void session_act(struct session *session);

/* So many acts in so long a time, which is cut into pieces of up to `piece` ticks (0: not at all). */
void session_live(struct session *session, unsigned acts, uint64_t ticks, uint64_t piece);

/* Forget what was seen; ticks count from now on. */
void session_forget(struct session *session);

/* What was seen. Valid until the session continues. */
const char *session_seen(struct session *session);

/* What can be asked of all units at the present tick, without ticks, as JSON; to be freed. */
char *session_state(struct session *session);

/* A request at the present tick. */
void session_ask(struct session *session, uint8_t node, const void *message, size_t length);

/* Set Command. */
void session_set(struct session *session, uint8_t node, char motor, const char *text);

/* A command, which must be executed (session_command), or its refusal: "" if it is executed. `params` is JSON. Static memory. */
void session_command(struct session *session, const char *method, const char *params);
const char *session_refusal(struct session *session, const char *method, const char *params);

/* Compare two texts; says where they differ. */
void session_same(const char *wanted, const char *got, const char *what);

#endif
