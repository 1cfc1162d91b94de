/* SPDX-License-Identifier: MIT */
/* test_report.h: what `rkm04 test` reports: a line a scenario for people, JSON for programs, JUnit XML for CI servers. */
#ifndef RKM04_RUN_TEST_REPORT_H
#define RKM04_RUN_TEST_REPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "test_case.h"

/* A line about one that has been run. */
void test_report_line(FILE *out, const struct test_case *test);

/* Under how many readings it passes and on which it depends: a line, and one for each run that ended otherwise. */
void test_report_readings(FILE *out, const struct test_case *test);

/* A line about all of them. */
void test_report_sum(FILE *out, const struct test_case *tests, size_t count);

/* All of them as one JSON object. Returns false if it could not be written. */
bool test_report_json(FILE *out, const struct test_case *tests, size_t count);

/* All of them as JUnit XML: whatever is in names and texts, it is well formed. `strict`: one that depends on a reading has
 * failed. */
void test_report_junit(FILE *out, const struct test_case *tests, size_t count, bool strict);

/* How many of them came out so? */
size_t test_report_count(const struct test_case *tests, size_t count, enum test_outcome outcome);

/* How many of them depend on a reading? */
size_t test_report_dependent(const struct test_case *tests, size_t count);

#endif
