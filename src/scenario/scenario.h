/* SPDX-License-Identifier: MIT */
/* scenario.h: a scenario: what is done to a line of units and what must come of it, from a text file, in virtual time.
 * docs/SCENARIOS.md describes the file. */
#ifndef RKM04_SCENARIO_H
#define RKM04_SCENARIO_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "device/device.h"
#include "text/text.h"

struct scenario;

/* How the files are read that a scenario names: plants and programs. */
struct scenario_files {
    /* Read the whole file `path`. Returns a text with a zero after it, to be freed, or NULL and in *why the reason. */
    char *(*read)(void *context, const char *path, size_t *length, const char **why);
    /* Map a program text in place to the bytes that a unit takes. Returns its new length. NULL: it is one already. */
    size_t (*map)(char *text, size_t length);
    void *context;
    /* What a scenario is about that names no device, and the settings of that device it begins with. NULL: an RKM04 as it is. */
    const struct device_kind *device;
    const struct device_config *config;
};

/* Read and check the text of a scenario. Errors go to `errors`, a line each: NAME:LINE:COLUMN: error: expected …. Returns NULL
 * then. `files` is needed during the call only. */
struct scenario *scenario_read(const char *name, const char *text, size_t length, const struct scenario_files *files,
                               FILE *errors);
void scenario_free(struct scenario *scenario);

/* What it is called: its `name`, or NULL if it has none. */
const char *scenario_name(const struct scenario *scenario);

/* Run it under these readings from now on; those that it names itself stay as it has them. */
void scenario_set_readings(struct scenario *scenario, const struct device_config *readings);

/* The kind of its units, and their settings; what the scenario names itself is chosen in them. */
const struct device_kind *scenario_device(const struct scenario *scenario);
const struct device_config *scenario_config(const struct scenario *scenario);

enum scenario_end {
    SCENARIO_PASSED,
    SCENARIO_FAILED,
    SCENARIO_INTERRUPTED,
    SCENARIO_NO_MEMORY
};

/* What came of it. Strings are to be freed with scenario_result_free(). */
struct scenario_result {
    uint64_t tick;            /* at which it ended, or that of the failure */
    size_t line, column;      /* of a failure: the place in the scenario */
    char *label;              /* of the step that failed; NULL: it has none */
    char *expected, *seen;
    int record_error;         /* errno with which writing the recording has failed; 0: it has not */
};

/* Run it from power-up. `record`: where the recording goes, which stays the caller's; NULL: not needed. `interrupted`: NULL,
 * or asked now and then with the line's tick: true ends the run. */
enum scenario_end scenario_run(const struct scenario *scenario, FILE *record, bool (*interrupted)(void *context, uint64_t tick),
                               void *context, struct scenario_result *result);
void scenario_result_free(struct scenario_result *result);

#endif
