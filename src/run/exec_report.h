/* SPDX-License-Identifier: MIT */
/* exec_report.h: what a run of `rkm04 exec` reports at its end, for people or as JSON. */
#ifndef RKM04_RUN_EXEC_REPORT_H
#define RKM04_RUN_EXEC_REPORT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "exec_run.h"

struct report {
    json_t *answers; /* NULL: answers go to stderr as they come */
};

void report_begin(struct report *report, bool json);

/* Take note of the answer to a message of the stimulus; `context` is a struct report. */
void report_answer(void *context, uint64_t tick, const struct stimulus *stimulus, const uint8_t *answer, size_t length);

/* Print the final state on `out`: the object of device_kind.state with `end` ("done", "until", "interrupted", "no_trace"),
 * `answers`, a list of {t_us, message, answer}, and, if a motor waits for what nothing brings, `waits`, a list of
 * {motor, command, for}; or a table, and on stderr what is waited for. Frees the report.
 * Returns false if it could not be written; that has been reported. */
bool report_end(struct report *report, struct exec_run *run, enum exec_end end, FILE *out);

/* Tell on stderr about each motor that ended in a fault. Returns true if there is one. */
bool report_faults(struct exec_run *run);

#endif
