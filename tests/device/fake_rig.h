/* SPDX-License-Identifier: MIT */
/* fake_rig.h: a bus with fake devices in virtual time, and all that is seen of it, in words. */
#ifndef RKM04_TESTS_FAKE_RIG_H
#define RKM04_TESTS_FAKE_RIG_H

#include <stdio.h>

#include "scenario/scenario.h"
#include "sim/sim.h"

struct fake_rig {
    struct sim sim;
    struct watcher watcher;
    FILE *stream;
    char *text;
    size_t length;
};

/* Units with these addresses ("1,2"). `timed`: bytes take their time. */
void fake_rig_begin(struct fake_rig *rig, const char *nodes, bool timed);

/* Units of this kind, with a setting ("end=sums", of a file its text; NULL: none). */
void fake_rig_begin_as(struct fake_rig *rig, const struct device_kind *kind, const char *setting, const char *nodes, bool timed);

void fake_rig_end(struct fake_rig *rig);

/* The host sends a request to a unit, now. */
void fake_rig_ask(struct fake_rig *rig, unsigned address, const char *text);

/* Without time on the wires: the host sends a request and gets this answer. */
void fake_rig_expect_answer(struct fake_rig *rig, unsigned address, const char *text, const char *answer);

/* What was seen since the last call, a line each: "US heard 4f", "US unit 1 motor 1 step 5". Valid until the next call. */
const char *fake_rig_seen(struct fake_rig *rig);

/* A command, params as JSON. Returns its result, a new reference; or fails. */
json_t *fake_rig_command(struct fake_rig *rig, const char *method, const char *params);

/* The result of a command, as text without spaces, has `wanted` in it. */
void fake_rig_expect_result(struct fake_rig *rig, const char *method, const char *params, const char *wanted);
void fake_rig_do(struct fake_rig *rig, const char *method, const char *params);

/* A command that is refused with a message that has `expected` in it. */
void fake_rig_expect_refusal(struct fake_rig *rig, const char *method, const char *params, const char *expected);

/* A member of `state` of unit 1, written as JSON, has to be `value`. `name`: "do", "motors.0.position". */
void fake_rig_expect_state(struct fake_rig *rig, const char *name, const char *value);

/* A scenario, given as text, has to end so; its messages, and what was expected and seen, have to have `said` in them (NULL:
 * anything). */
void run_story(const char *text, enum scenario_end wanted, const char *said);

#endif
