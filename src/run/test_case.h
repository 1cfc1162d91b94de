/* SPDX-License-Identifier: MIT */
/* test_case.h: a scenario of `rkm04 test`: its file, its run, what came of it. */
#ifndef RKM04_RUN_TEST_CASE_H
#define RKM04_RUN_TEST_CASE_H

#include <limits.h>
#include <stdbool.h>
#include <stddef.h>

#include "scenario/scenario.h"

enum test_outcome {
    TEST_NOT_RUN,
    TEST_PASSED,
    TEST_FAILED,
    TEST_BROKEN /* out of memory: it says nothing about the scenario */
};

#define TEST_NO_READING UINT_MAX

/* One other value of a reading. */
struct test_choice {
    unsigned at, value; /* at TEST_NO_READING: none */
};

/* A run that ended otherwise than the first one. */
struct test_variant {
    struct test_choice choice[2]; /* the second one: of a pair whose values, each alone, change nothing */
    enum test_outcome outcome;
    struct scenario_result result;
};

/* What came of it under other readings (test_readings.h fills it in). */
struct test_readings {
    const struct device_readings *readings; /* of the scenario's device; NULL: it has none */
    size_t planned, runs, passed; /* the first run is counted */
    bool broken;                  /* out of memory */
    size_t variants;
    struct test_variant *variant;
};

struct test_case {
    const char *file;         /* as given, "<stdin>" for "-" */
    struct scenario *scenario;
    enum test_outcome outcome;
    struct scenario_result result;
    double seconds;           /* of real time */
    char *record;             /* where the recording of the failure is; NULL: nowhere */
    struct test_readings *under; /* what came of it under other readings; NULL: it was run once */
};

/* How far a run is, for people. */
struct test_progress {
    bool wanted, shown;
    size_t at, count;         /* this one, of so many */
    double next;              /* s */
    const struct test_case *test;
};

/* Read the file `path`, "-" for standard input. `device`: what the command line says; it is for scenarios that name
 * none. Errors are reported on stderr.
 * Returns 0, or what the exit status is to be. */
int test_case_read(struct test_case *test, const char *path, const struct device_arguments *device);

/* Run it. `folder`: where the recording of a failure goes; NULL: it is not kept. `flags`: of output_file.h, for the record.
 * `number`: 2, 3, … for the second, third of a run whose files are called alike. A recording that cannot be written is reported
 * on stderr: then false. */
bool test_case_run(struct test_case *test, const char *folder, unsigned flags, unsigned number, struct test_progress *progress);

/* Run it once more, under the readings that it has now, and keep nothing but *result. */
enum test_outcome test_case_try(struct test_case *test, struct scenario_result *result, struct test_progress *progress);

/* Would the records of both have the same name? */
bool test_case_alike(const struct test_case *left, const struct test_case *right);

/* What people call it: its name, or its file. */
const char *test_case_name(const struct test_case *test);

void test_case_free(struct test_case *test);

/* For signals: the present run ends soon, and test_case_interrupted() is true from then on. */
void test_case_interrupt(int signal_number);
bool test_case_interrupted(void);

#endif
