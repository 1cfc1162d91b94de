/* SPDX-License-Identifier: MIT */
/* test_readings.h: a scenario under readings other than the defaults: on which of them does its result depend? */
#ifndef RKM04_HOST_TEST_READINGS_H
#define RKM04_HOST_TEST_READINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <rkm04/readings.h>

#include "text/text.h"
#include "test_case.h"

#define TEST_READINGS_TEXT_SIZE 1024 /* bytes of a list of all of them, and of pairs */

enum test_readings_mode {
    TEST_READINGS_ONE,  /* one run under one set */
    TEST_READINGS_ALL,  /* and under each other value of each reading, one at a time */
    TEST_READINGS_PAIRS /* and under each two other values of two readings */
};

/* One other value of a reading. */
struct test_choice {
    unsigned at, value; /* at READINGS: none */
};

/* A run that ended otherwise than the first one. */
struct test_variant {
    struct test_choice choice[2]; /* the second one: of a pair whose values, each alone, change nothing */
    enum test_outcome outcome;
    struct scenario_result result;
};

struct test_readings {
    size_t planned, runs, passed; /* the first run is counted */
    bool broken;                  /* memory was short */
    size_t variants;
    struct test_variant *variant;
};

/* Run a scenario that has been run under `base` under others, too; those in `named`, and those that it names itself, keep
 * their value. test->under has what came of it, NULL: memory is short. */
void test_readings_run(struct test_case *test, const struct rkm04_readings *base, readings_set named,
                       enum test_readings_mode mode, struct test_progress *progress);

void test_readings_free(struct test_readings *under);

/* Does the result depend on a reading? */
bool test_readings_depends(const struct test_case *test);

/* "passes under 22 of 23; depends on hold-exit". Returns `text`. */
const char *test_readings_text(const struct test_readings *under, char text[TEST_READINGS_TEXT_SIZE]);

/* The readings of a variant, as in "hold-exit=latch". Returns `text`. */
const char *test_variant_text(const struct test_variant *variant, char text[READINGS_TEXT_SIZE]);

#endif
