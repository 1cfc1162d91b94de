/* SPDX-License-Identifier: MIT */
/* trace_set.h: traces that are started and stopped while a bus runs: the methods `trace.start` and `trace.stop` of
 * docs/CONTROL.md. */
#ifndef RKM04_TRACE_TRACE_SET_H
#define RKM04_TRACE_TRACE_SET_H

#include "command/command.h"

#define TRACE_SET_MAX 16u /* at a time */

struct trace_file;
struct wire_file;

/* One of the two files. */
struct trace_entry {
    unsigned number; /* 0: this place is free */
    struct sim *sim;
    char *path;
    struct trace_file *trace;
    struct wire_file *wire;
};

struct trace_set {
    struct trace_entry entry[TRACE_SET_MAX];
    unsigned last; /* number given last */
};

/* `trace.start`. Returns its result; NULL: refused. */
json_t *trace_set_start(struct trace_set *set, struct sim *sim, const json_t *params, struct refusal *refusal);

/* The trace that `trace.stop` means: by its number, or the only one. NULL: refused. */
struct trace_entry *trace_set_find(struct trace_set *set, const json_t *params, struct refusal *refusal);

/* Stop it, at the present tick of its sim. Returns the result of `trace.stop`; NULL: the file could not be written. */
json_t *trace_set_stop(struct trace_entry *entry, struct refusal *refusal);

#endif
