/* SPDX-License-Identifier: MIT */
/* test_readings.h: a scenario under readings other than the defaults: on which of them does its result depend? */
#ifndef RKM04_RUN_TEST_READINGS_H
#define RKM04_RUN_TEST_READINGS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include <rkm04/readings.h>

#include "test_case.h"
#include "text/text.h"

#define TEST_READINGS_TEXT_SIZE 1024 /* bytes of a list of all of them, and of pairs */

enum test_readings_mode {
    TEST_READINGS_ONE,  /* one run under one set */
    TEST_READINGS_ALL,  /* and under each other value of each reading, one at a time */
    TEST_READINGS_PAIRS /* and under each two other values of two readings */
};

/* Run a scenario that has been run under the readings of `base` under others, too; those that are chosen there, and those that it
 * names itself, keep their value. test->under has what came of it, NULL: out of memory. */
void test_readings_run(struct test_case *test, const struct device_config *base, enum test_readings_mode mode,
                       struct test_progress *progress);

/* Does the result depend on a reading? */
bool test_readings_depends(const struct test_case *test);

/* "passes under 22 of 23; depends on hold-exit". Returns `text`. */
const char *test_readings_text(const struct test_readings *under, char text[TEST_READINGS_TEXT_SIZE]);

/* The readings of a variant, as in "hold-exit=latch". Returns `text`. */
const char *test_variant_text(const struct test_readings *under, const struct test_variant *variant, char text[DEVICE_TEXT_SIZE]);

#endif
