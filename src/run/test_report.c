/* SPDX-License-Identifier: MIT */
#include "test_report.h"

#include <inttypes.h>
#include <jansson.h>

#include <rkm04/limits.h>

#include "test_readings.h"

#define TIME_FORMAT "%" PRIu64 ".%06" PRIu64 " s"
#define TIME_OF(ticks) (ticks) / US_PER_SECOND, (ticks) % US_PER_SECOND

size_t test_report_count(const struct test_case *tests, size_t count, enum test_outcome outcome)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += tests[i].outcome == outcome;
    return found;
}

size_t test_report_dependent(const struct test_case *tests, size_t count)
{
    size_t found = 0;
    for (size_t i = 0; i < count; i++)
        found += test_readings_depends(&tests[i]);
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

static void print_failure(FILE *out, const struct test_case *test, const struct scenario_result *result)
{
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
    if (result == &test->result && test->record != NULL)
        fprintf(out, "; recording %s", test->record);
    fputc('\n', out);
}

void test_report_line(FILE *out, const struct test_case *test)
{
    if (test->outcome == TEST_FAILED) {
        print_failure(out, test, &test->result);
        return;
    }
    const char *words = test->outcome == TEST_PASSED ? "pass" : test->outcome == TEST_BROKEN ? "broken" : "not run";
    fprintf(out, "%s %s", words, test->file);
    print_name(out, test);
    if (test->outcome == TEST_PASSED)
        fprintf(out, " (" TIME_FORMAT ")", TIME_OF(test->result.tick));
    if (test->outcome == TEST_BROKEN)
        fputs(": out of memory", out);
    fputc('\n', out);
}

void test_report_readings(FILE *out, const struct test_case *test)
{
    char text[TEST_READINGS_TEXT_SIZE], readings[DEVICE_TEXT_SIZE];
    if (test->under == NULL)
        return;
    fprintf(out, "%s: %s\n", test->file, test_readings_text(test->under, text));
    for (size_t i = 0; i < test->under->variants; i++) {
        const struct test_variant *variant = &test->under->variant[i];
        fprintf(out, "  %s: ", test_variant_text(test->under, variant, readings));
        if (variant->outcome == TEST_FAILED)
            print_failure(out, test, &variant->result);
        else
            fprintf(out, "pass %s (" TIME_FORMAT ")\n", test->file, TIME_OF(variant->result.tick));
    }
}

void test_report_sum(FILE *out, const struct test_case *tests, size_t count)
{
    size_t passed = test_report_count(tests, count, TEST_PASSED), failed = test_report_count(tests, count, TEST_FAILED);
    fprintf(out, "%zu scenario%s: %zu passed, %zu failed", count, count == 1 ? "" : "s", passed, failed);
    if (passed + failed < count)
        fprintf(out, ", %zu not run", count - passed - failed);
    if (test_report_dependent(tests, count) > 0)
        fprintf(out, "; %zu depend%s on readings", test_report_dependent(tests, count),
                test_report_dependent(tests, count) == 1 ? "s" : "");
    fputc('\n', out);
}

/* ---- JSON ----------------------------------------------------------------------------------------------------------- */

static json_t *text_json(const char *text)
{
    json_t *json = text != NULL ? json_string(text) : json_null();
    return json != NULL ? json : json_string_nocheck("?"); /* it is not UTF-8: the name of a file may be anything */
}

static json_t *failure_json(const struct scenario_result *result)
{
    return json_pack("{s:I, s:I, s:o, s:o, s:o}", "line", (json_int_t)result->line, "column", (json_int_t)result->column, "label",
                     text_json(result->label), "expected", text_json(result->expected), "seen", text_json(result->seen));
}

/* What came of it under other readings: those it depends on, and the runs that ended otherwise. */
static json_t *readings_runs_json(const struct test_readings *under)
{
    char text[DEVICE_TEXT_SIZE];
    json_t *list = json_array(), *names = json_object();
    for (size_t i = 0; i < under->variants; i++) {
        const struct test_variant *variant = &under->variant[i];
        bool failed = variant->outcome == TEST_FAILED;
        json_t *json = json_pack("{s:s, s:s, s:I}", "readings", test_variant_text(under, variant, text), "result",
                                 failed ? "fail" : "pass", "t_us", (json_int_t)variant->result.tick);
        if (failed)
            json_object_set_new(json, "failure", failure_json(&variant->result));
        json_array_append_new(list, json);
        for (unsigned part = 0; part < 2 && variant->choice[part].at != TEST_NO_READING; part++)
            json_object_set_new(names, under->readings->name(variant->choice[part].at), json_true());
    }
    json_t *depends = json_array();
    const char *name;
    json_t *value;
    json_object_foreach(names, name, value)
        json_array_append_new(depends, json_string(name));
    json_decref(names);
    return json_pack("{s:I, s:I, s:o, s:o}", "runs", (json_int_t)under->runs, "passed", (json_int_t)under->passed, "depends_on",
                     depends, "otherwise", list);
}

static json_t *case_json(const struct test_case *test)
{
    static const char *const outcomes[] = {
        [TEST_NOT_RUN] = "not_run", [TEST_PASSED] = "pass", [TEST_FAILED] = "fail", [TEST_BROKEN] = "broken"};
    const struct scenario_result *result = &test->result;
    json_t *json = json_pack("{s:o, s:o, s:s, s:I, s:f}", "file", text_json(test->file), "name", text_json(test_case_name(test)),
                             "result", outcomes[test->outcome], "t_us", (json_int_t)result->tick, "seconds", test->seconds);
    if (json != NULL && test->under != NULL)
        json_object_set_new(json, "readings", readings_runs_json(test->under));
    if (json == NULL || test->outcome != TEST_FAILED)
        return json;
    json_t *failure = failure_json(result);
    json_object_set_new(failure, "record", text_json(test->record));
    json_object_set_new(json, "failure", failure);
    return json;
}

bool test_report_json(FILE *out, const struct test_case *tests, size_t count)
{
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++)
        json_array_append_new(list, case_json(&tests[i]));
    json_t *json = json_pack("{s:I, s:I, s:I, s:I, s:o}", "scenarios", (json_int_t)count, "passed",
                             (json_int_t)test_report_count(tests, count, TEST_PASSED), "failed",
                             (json_int_t)test_report_count(tests, count, TEST_FAILED), "dependent",
                             (json_int_t)test_report_dependent(tests, count), "results", list);
    bool ok = json != NULL && json_dumpf(json, out, JSON_INDENT(2)) == 0 && fputc('\n', out) != EOF;
    json_decref(json);
    return ok;
}
