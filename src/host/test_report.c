/* SPDX-License-Identifier: MIT */
#include "test_report.h"

#include <inttypes.h>
#include <jansson.h>

#include <rkm04/limits.h>

#define TIME_FORMAT "%" PRIu64 ".%06" PRIu64 " s"
#define TIME_OF(ticks) (ticks) / RKM04_TICKS_PER_SECOND, (ticks) % RKM04_TICKS_PER_SECOND

size_t test_report_count(const struct test_case *tests, size_t count, enum test_outcome outcome)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += tests[i].outcome == outcome;
    return found;
}

/* ---- Lines ---------------------------------------------------------------------------------------------------------- */

/* A text without what would break the line. */
static void print_plain(FILE *out, const char *text)
{
    for (; *text != '\0'; text++)
        fputc((unsigned char)*text < 0x20 || *text == 0x7F ? ' ' : *text, out);
}

static void print_name(FILE *out, const struct test_case *test)
{
    const char *name = scenario_name(test->scenario);
    if (name == NULL)
        return;
    fputs(": ", out);
    print_plain(out, name);
}

static void print_failure(FILE *out, const struct test_case *test)
{
    const struct scenario_result *result = &test->result;
    fprintf(out, "FAIL %s:%zu:%zu", test->file, result->line, result->column);
    print_name(out, test);
    if (result->label != NULL) {
        fputs(": ", out);
        print_plain(out, result->label);
    }
    fputs(": expected ", out);
    print_plain(out, result->expected);
    fputs("; seen ", out);
    print_plain(out, result->seen);
    fprintf(out, "; at tick %" PRIu64 " (" TIME_FORMAT ")", result->tick, TIME_OF(result->tick));
    if (test->record != NULL)
        fprintf(out, "; record %s", test->record);
    fputc('\n', out);
}

void test_report_line(FILE *out, const struct test_case *test)
{
    if (test->outcome == TEST_FAILED) {
        print_failure(out, test);
        return;
    }
    const char *words = test->outcome == TEST_PASSED ? "pass" : test->outcome == TEST_BROKEN ? "broken" : "not run";
    fprintf(out, "%s %s", words, test->file);
    print_name(out, test);
    if (test->outcome == TEST_PASSED)
        fprintf(out, " (" TIME_FORMAT ")", TIME_OF(test->result.tick));
    if (test->outcome == TEST_BROKEN)
        fputs(": memory is short", out);
    fputc('\n', out);
}

void test_report_sum(FILE *out, const struct test_case *tests, size_t count)
{
    size_t passed = test_report_count(tests, count, TEST_PASSED), failed = test_report_count(tests, count, TEST_FAILED);
    fprintf(out, "%zu scenario%s: %zu passed, %zu failed", count, count == 1 ? "" : "s", passed, failed);
    if (passed + failed < count)
        fprintf(out, ", %zu not run", count - passed - failed);
    fputc('\n', out);
}

/* ---- JSON ----------------------------------------------------------------------------------------------------------- */

static json_t *text_json(const char *text)
{
    json_t *json = text != NULL ? json_string(text) : json_null();
    return json != NULL ? json : json_string_nocheck("?"); /* it is not UTF-8: the name of a file may be anything */
}

static json_t *case_json(const struct test_case *test)
{
    static const char *const outcomes[] = {
        [TEST_NOT_RUN] = "not_run", [TEST_PASSED] = "pass", [TEST_FAILED] = "fail", [TEST_BROKEN] = "broken"};
    const struct scenario_result *result = &test->result;
    json_t *json = json_pack("{s:o, s:o, s:s, s:I, s:f}", "file", text_json(test->file), "name", text_json(test_case_name(test)),
                             "result", outcomes[test->outcome], "t_us", (json_int_t)result->tick, "seconds", test->seconds);
    if (json == NULL || test->outcome != TEST_FAILED)
        return json;
    json_t *failure = json_pack("{s:I, s:I, s:o, s:o, s:o, s:o}", "line", (json_int_t)result->line, "column",
                                (json_int_t)result->column, "label", text_json(result->label), "expected",
                                text_json(result->expected), "seen", text_json(result->seen), "record", text_json(test->record));
    json_object_set_new(json, "failure", failure);
    return json;
}

bool test_report_json(FILE *out, const struct test_case *tests, size_t count)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, case_json(&tests[i]));
    json_t *json = json_pack("{s:I, s:I, s:I, s:o}", "scenarios", (json_int_t)count, "passed",
                             (json_int_t)test_report_count(tests, count, TEST_PASSED), "failed",
                             (json_int_t)test_report_count(tests, count, TEST_FAILED), "results", list);
    bool well = json != NULL && json_dumpf(json, out, JSON_INDENT(2)) == 0 && fputc('\n', out) != EOF;
    json_decref(json);
    return well;
}
