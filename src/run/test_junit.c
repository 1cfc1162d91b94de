/* SPDX-License-Identifier: MIT */
/* JUnit XML. There is no standard; this is what Jenkins, GitLab and the publishers of GitHub read. */
#include <inttypes.h>
#include <stdint.h>
#include <string.h>

#include "test_readings.h"
#include "test_report.h"

/* The length of the UTF-8 character at `text` if it is one that XML 1.0 may have; 0: it is not. */
static size_t character_length(const unsigned char *text)
{
    static const uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
    size_t length = *text < 0x80 ? 1 : *text >> 5 == 6 ? 2 : *text >> 4 == 14 ? 3 : *text >> 3 == 30 ? 4 : 0;
    uint32_t code = length < 2 ? *text : *text & (0x7Fu >> length);
    for (size_t i = 1; i < length; i++) {
        if (text[i] >> 6 != 2)
            return 0;
        code = code << 6 | (text[i] & 0x3Fu);
    }
    if (length == 0 || code < least[length] || code > 0x10FFFF)
        return 0;
    if (code < 0x20)
        return code == '\t' || code == '\n' || code == '\r' ? 1 : 0;
    return (code >= 0xD800 && code < 0xE000) || code == 0xFFFE || code == 0xFFFF ? 0 : length;
}

static void print_escaped(FILE *out, const char *text)
{
    static const char special[] = "&<>\"'\t\n\r";
    static const char *const escapes[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;", "&#9;", "&#10;", "&#13;"};
    while (*text != '\0') {
        size_t length = character_length((const unsigned char *)text);
        const char *found = strchr(special, *text);
        if (length == 0)
            fputs("\xEF\xBF\xBD", out); /* no character: U+FFFD in its place */
        else if (found != NULL)
            fputs(escapes[found - special], out);
        else
            fwrite(text, 1, length, out);
        text += length > 0 ? length : 1;
    }
}

static void print_attribute(FILE *out, const char *name, const char *value)
{
    fprintf(out, " %s=\"", name);
    print_escaped(out, value);
    fputc('"', out);
}

static void print_failure(FILE *out, const struct test_case *test)
{
    const struct scenario_result *result = &test->result;
    fputs("      <failure type=\"expectation\" message=\"expected ", out);
    print_escaped(out, result->expected);
    fputs("; seen ", out);
    print_escaped(out, result->seen);
    fprintf(out, "; at tick %" PRIu64 "\">", result->tick);
    print_escaped(out, test->file);
    fprintf(out, ":%zu:%zu", result->line, result->column);
    if (result->label != NULL) {
        fputs("\nstep: ", out);
        print_escaped(out, result->label);
    }
    fputs("\nexpected: ", out);
    print_escaped(out, result->expected);
    fputs("\nseen: ", out);
    print_escaped(out, result->seen);
    fprintf(out, "\ntick: %" PRIu64, result->tick);
    if (test->record != NULL) {
        fputs("\nrecord: ", out);
        print_escaped(out, test->record);
    }
    fputs("</failure>\n", out);
}

/* A failure of its own kind: the scenario passes, but not under all readings. */
static void print_dependence(FILE *out, const struct test_case *test)
{
    char text[TEST_READINGS_TEXT_SIZE];
    fprintf(out, "      <failure type=\"readings\" message=\"%s\"/>\n", test_readings_text(test->under, text));
}

static void print_readings(FILE *out, const struct test_case *test)
{
    char text[TEST_READINGS_TEXT_SIZE];
    fprintf(out, "\nreadings: %s", test_readings_text(test->under, text));
    for (size_t i = 0; i < test->under->variants; i++) {
        const struct test_variant *variant = &test->under->variant[i];
        fprintf(out, "\n%s: ", test_variant_text(test->under, variant, text));
        if (variant->outcome == TEST_FAILED) {
            print_escaped(out, test->file);
            fprintf(out, ":%zu:%zu: expected ", variant->result.line, variant->result.column);
            print_escaped(out, variant->result.expected);
            fputs("; seen ", out);
            print_escaped(out, variant->result.seen);
            fprintf(out, "; at tick %" PRIu64, variant->result.tick);
        } else {
            fputs("pass", out);
        }
    }
}

static void print_case(FILE *out, const struct test_case *test, bool strict)
{
    fputs("    <testcase", out);
    print_attribute(out, "classname", test->file); /* two scenarios may have one name; a test is both together */
    print_attribute(out, "name", test_case_name(test));
    print_attribute(out, "file", test->file);
    fprintf(out, " time=\"%.6f\">\n", test->seconds);
    if (test->outcome == TEST_FAILED)
        print_failure(out, test);
    else if (test->outcome == TEST_BROKEN)
        fputs("      <error type=\"memory\" message=\"out of memory\"/>\n", out);
    else if (test->outcome == TEST_NOT_RUN)
        fputs("      <skipped message=\"interrupted\"/>\n", out);
    else if (strict && test_readings_depends(test))
        print_dependence(out, test);
    fprintf(out, "      <system-out>virtual time: %" PRIu64 " us", test->result.tick);
    if (test->under != NULL)
        print_readings(out, test);
    fputs("</system-out>\n    </testcase>\n", out);
}

static void print_counts(FILE *out, const struct test_case *tests, size_t count, bool strict)
{
    double seconds = 0;
    size_t failures = test_report_count(tests, count, TEST_FAILED);
    for (size_t i = 0; i < count; i++) {
        seconds += tests[i].seconds;
        failures += strict && tests[i].outcome == TEST_PASSED && test_readings_depends(&tests[i]);
    }
    fprintf(out, " name=\"rkm04 test\" tests=\"%zu\" failures=\"%zu\" errors=\"%zu\" skipped=\"%zu\" time=\"%.6f\">\n", count,
            failures, test_report_count(tests, count, TEST_BROKEN),
            test_report_count(tests, count, TEST_NOT_RUN), seconds);
}

void test_report_junit(FILE *out, const struct test_case *tests, size_t count, bool strict)
{
    fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites", out);
    print_counts(out, tests, count, strict);
    fputs("  <testsuite", out);
    print_counts(out, tests, count, strict);
    for (size_t i = 0; i < count; i++)
        print_case(out, &tests[i], strict);
    fputs("  </testsuite>\n</testsuites>\n", out);
}
