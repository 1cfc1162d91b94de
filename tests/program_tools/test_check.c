/* SPDX-License-Identifier: MIT */
/* test_check.c: what is found in programs: errors with places and hints, every warning, what is not found in good programs.
 * One case alone: CK_RUN_CASE=warnings ./test_check */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "program_tools/program_tools.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct diagnostics found;
static struct check_options options;
static char names[2048];

/* Check a text, copied to size for the sanitizer to watch its end. Returns "name@line:column", a blank between. */
static const char *check_bytes(const char *bytes, size_t length)
{
    char *text = malloc(length + (length == 0));
    ck_assert_ptr_nonnull(text);
    memcpy(text, bytes, length);
    const struct program_source source = {.name = "f.rks", .text = text, .length = length, .motor = 1};
    diagnostics_free(&found);
    ck_assert(check_programs(&source, 1, &options, &found));
    size_t at = 0;
    names[0] = '\0';
    for (size_t i = 0; i < found.count && at < sizeof names - 64; i++) {
        const struct diagnostic *one = &found.list[i];
        ck_assert_uint_le(one->offset + one->length, length);
        at += (size_t)snprintf(names + at, sizeof names - at, "%s%s@%zu:%zu", i > 0 ? " " : "", one->name, one->line,
                               one->column);
    }
    free(text);
    return names;
}

static const char *check(const char *text)
{
    return check_bytes(text, strlen(text));
}

static void set_up(void)
{
    options = (struct check_options){0};
}

static void tear_down(void)
{
    diagnostics_free(&found);
}

/* ---- Errors --------------------------------------------------------------------------------------------------------- */

START_TEST(every_error_is_found_at_its_place)
{
    ck_assert_str_eq(check("F1000 V99999 R\n\tq { a }\nI01X5 W"),
                     "bad-value@1:7 unknown-command@2:2 bad-value@3:1 bad-value@3:7");
    ck_assert_uint_eq(found.errors, 4);
    ck_assert_str_eq(found.list[0].message, "expected a number 1..16000 after V, found 99999");
    ck_assert_uint_eq(found.list[0].offset, 6);
    ck_assert_uint_eq(found.list[0].length, 6);
}
END_TEST

START_TEST(a_slip_is_answered_with_what_may_have_been_meant)
{
    static const struct {
        const char *text, *name, *hint; /* of the first error */
    } slips[] = {
        {"F1O00 R", "bad-value@1:3", "O is a letter; did you mean the digit 0?"},
        {"FO R", "bad-value@1:1", "O is a letter; did you mean the digit 0?"},
        {"F1l0 R", "unknown-command@1:3", "l is a letter; did you mean the digit 1?"},
        {"F10 R100", "unknown-command@1:6", "R takes no number; F or B set the steps: F1000 R"},
        {"F10 L2 R E2", "unknown-command@1:11", "E takes no number; L sets the number of passes: L3 ... E"},
        {"F10; R", "unknown-command@1:4", "no separator is needed between commands; a blank is possible"},
        {"# a", "unknown-command@1:1", "comments are written in braces: { text }"},
        {"F-100 R", "bad-value@1:1", "did you mean B, which moves back?"},
        {"@5 J@5", "bad-value@1:4", "write the number alone: J5 jumps to @5"},
        {"{ a", "open-comment@1:1", "everything after it is a comment"},
        {"@1 \x92" "1", "unknown-command@1:4", "a typographic apostrophe of code page 1250; the call is '"},
    };
    for (size_t i = 0; i < COUNT(slips); i++) {
        check(slips[i].text);
        size_t at = 0;
        while (at < found.count && found.list[at].severity != DIAGNOSTIC_ERROR)
            at++;
        ck_assert_msg(at < found.count, "%s: no error", slips[i].text);
        ck_assert_msg(strstr(names, slips[i].name) != NULL, "%s: %s", slips[i].text, names);
        ck_assert_msg(found.list[at].hint != NULL, "%s: no hint", slips[i].text);
        ck_assert_str_eq(found.list[at].hint, slips[i].hint);
    }
}
END_TEST

START_TEST(places_count_in_the_text_as_given)
{
    /* Byte order mark, a call with an apostrophe of three bytes, a letter of two bytes in a comment. */
    ck_assert_str_eq(check("\xEF\xBB\xBF{\xC4\x8D} \xE2\x80\x99" "1 q J2 @1 ."),
                     "apostrophe@1:6 unknown-command@1:9 missing-label@1:11");
    ck_assert_uint_eq(found.list[0].offset, 8);
    ck_assert_uint_eq(found.list[1].offset, 13);
}
END_TEST

START_TEST(errors_without_number_are_counted_and_kept_up_to_a_limit)
{
    char *text = malloc(5000);
    ck_assert_ptr_nonnull(text);
    memset(text, 'q', 5000);
    check_bytes(text, 5000);
    free(text);
    ck_assert_uint_eq(found.count, DIAGNOSTICS_MAX);
    ck_assert_uint_eq(found.errors, 5000);
}
END_TEST

START_TEST(a_negative_position_is_an_error_where_the_unit_has_that_reading)
{
    ck_assert_str_eq(check("=-5"), "");
    options.readings.negative_position = RKM04_NEGATIVE_POSITION_NO;
    ck_assert_str_eq(check("=-5"), "bad-value@1:1");
}
END_TEST

/* ---- Warnings ------------------------------------------------------------------------------------------------------- */

static const struct {
    const char *text, *names;
} warned[] = {
    {"F9999 R J5", "missing-label@1:9"},
    {"F9999 R I03H5", "missing-label@1:9"},
    {"@1 F9999 R J1 @1 W5", "duplicate-label@1:1"},
    {"@1 F9999 R @1 W5 J1", "duplicate-label@1:1"},
    {"@3 F9999 R", "unused-label@1:1"},
    {"F9999 R E", "loop-end@1:9"},
    {"F9999 L3 R", "open-loop@1:7"},
    {"F9999 @1 L3 R J1", "open-loop@1:10"},
    {"F9999 L2 L2 L2 L2 L2 L2 L2 L2 L2 R E E E E E E E E E", "loop-depth@1:31"},
    {"F9999 R .", "stray-return@1:9"},
    {"F9999 '1 @1 R .", "run-into@1:10"},
    {"F9999 @1 R '1 .", "run-into@1:7 call-depth@1:12"},
    {"F9999 J1 R @1 W5", "unreachable@1:10"},
    {"F9999 R J2 @7 R W1 @2 W5", "unreachable@1:12"},
    {"T01 C01 \\ F9999 R", "unreachable@1:1"},
    {"G+ F9999 R", "unreachable@1:4"},
    {"@1 J1", "busy-loop@1:1"},
    {"@1 T01 '2 J1 @2 C01 .", "busy-loop@1:1"},
    {"R", "no-steps@1:1"},
    {"G9999 R", "moves-again@1:7"},
    {"F9999 H R", "moves-again@1:9"},
    {"F9999 Y B9999 Y R", "mixed-directions@1:15"},
    {"F9999 Y D Y R", "mixed-directions@1:11"},
    {"F9999 Y Y Y Y Y Y Y Y Y Y Y R", "too-many-segments@1:27"},
    {"Y F9999 Y R", "empty-segment@1:1"},
    {"F9999 Y T53 Y R C03", "late-mark@1:9"},
    {"S100 V100 F9999 R", "no-ramp@1:17"},
    {"S100 A2000 F1000 V3000 R", "speed-not-reached@1:24"},
    {"C100 G5 G999", "speed-not-reached@1:6"},
    {"S100 V500 A2000 F2000 Y V2000 Y V500 F5000 Y V3000 A1000 Y V1500 F2000 Y V500 Y R", "speed-not-reached@1:58"},
    {"F9999 R K", "stand-alone@1:9"},
    {"K C75", "stand-alone@1:1 stand-alone@1:3"},
    {"G+ V500", "stand-alone@1:4 unreachable@1:4"},
    {"[ F9999 R", "open-block@1:1"},
    {"] [ F9999 R", "open-block@1:3"},
    {"F9999 R M05", "unused-guard@1:9"},
    {"M05 U F9999 R", "unused-guard@1:1"},
    {"M05 F9999 L3 R E", "used-guard@1:1"},
    {"T03 F9999 R", "output-stays@1:1"},
    {"T52 F9999 Y R", "output-stays@1:1"},
    {"{nolint no-stps} F9999 R", "unknown-nolint@1:9"},
};

START_TEST(each_warning_is_found_where_it_is_deserved)
{
    ck_assert_str_eq(check(warned[_i].text), warned[_i].names);
    ck_assert_uint_eq(found.errors, 0);
    ck_assert_uint_eq(found.warnings, found.count);
}
END_TEST

START_TEST(a_program_of_more_than_700_commands_is_noticed)
{
    char text[2 * 701 + 1];
    for (size_t i = 0; i < 701; i++)
        memcpy(text + 2 * i, "D ", 3);
    ck_assert_str_eq(check_bytes(text, 1400), "");
    ck_assert_str_eq(check(text), "memory-full@1:1401");
}
END_TEST

START_TEST(nothing_is_said_about_good_programs)
{
    static const char *const good[] = {
        "",
        "K",
        " C75 {go on}",
        "\\C100 S100 V1000 A2000 F5000 R W100 B5000 R",
        "C100 G5000 W10 H",
        "S100 A2000 F1000 V1000 L3 R W200 E B3000 R",
        "@1 O01 F5000 R J1",
        "@1 I01H2 W1 J1 @2 F5000 R",
        "'1 '1 J2 @1 F5000 R '3 . @3 W5 . @2 W1",
        "L2 '1 E J9 @1 L2 L2 F5000 R E E . @9 W1",
        "@1 M05 F5000 R J1",
        "M05 G+ T01 C01",
        "[ F5000 R ]",
        "F5000 Y Y R B5000 Y Y R",
        "T51 F5000 Y F5000 Y R W500 C01",
        "@1 W1 J1",
        "X04 F5000 L3 R E",
    };
    for (size_t i = 0; i < COUNT(good); i++)
        ck_assert_msg(strcmp(check(good[i]), "") == 0, "%s: %s", good[i], names);
}
END_TEST

START_TEST(a_warning_can_be_switched_off)
{
    options.off = UINT64_C(1) << CHECK_NO_STEPS;
    ck_assert_str_eq(check("R J5"), "missing-label@1:3");
    ck_assert_uint_eq(found.warnings, 1);
    options.off = UINT64_MAX;
    ck_assert_str_eq(check("R J5 q"), "unknown-command@1:6");
}
END_TEST

START_TEST(a_comment_switches_a_warning_off)
{
    ck_assert_str_eq(check("R {nolint no-steps}\nR\nJ5"), "no-steps@2:1 missing-label@3:1");
    ck_assert_str_eq(check("{nolint no-steps, missing-label}\n\nR J5\nR"), "unreachable@4:1");
    ck_assert_str_eq(check("{ nolint-file no-steps }\nR\nR J5"), "missing-label@3:3");
    ck_assert_str_eq(check("{nolint-me no-steps} R"), "no-steps@1:22");
    ck_assert_str_eq(check("{nolint no-steps} q"), "unknown-command@1:19");
}
END_TEST

/* ---- Several motors ------------------------------------------------------------------------------------------------- */

static const char *check_two(const char *first, const char *second)
{
    const struct program_source sources[] = {{"x", first, strlen(first), 1}, {"y", second, strlen(second), 2}};
    size_t at = 0;
    diagnostics_free(&found);
    ck_assert(check_programs(sources, 2, &options, &found));
    names[0] = '\0';
    for (size_t i = 0; i < found.count; i++)
        at += (size_t)snprintf(names + at, sizeof names - at, "%s%s:%s@%zu", i > 0 ? " " : "", sources[found.list[i].source].name,
                               found.list[i].name, found.list[i].column);
    return names;
}

START_TEST(motors_that_wait_for_each_other_are_found)
{
    ck_assert_str_eq(check_two("O80 T81", "O81 T80"), "x:deadlock@1 y:deadlock@1");
    ck_assert_str_eq(found.list[0].message, "motor 1 waits for VAR 80, which motor 2 sets only after its wait for VAR 81");
    ck_assert_str_eq(check_two("T81 O80 C81", "O81 T80 Z81 C80"), "");
    ck_assert_str_eq(check_two("O80 F9999 R", "W5"), "x:variable-never-set@1");
    ck_assert_str_eq(check_two("@1 I80H2 W1 J1 @2 W5", "W5"), "x:variable-never-set@4");
    ck_assert_str_eq(check_two("O80 O82", "T80 L2 W1 E T82"), "");
}
END_TEST

START_TEST(a_program_by_itself_may_wait_for_any_variable)
{
    ck_assert_str_eq(check("O80 F9999 R"), "");
}
END_TEST

START_TEST(sources_for_one_motor_are_one_program)
{
    const char *first = "J1", *second = "@1 F9999 R";
    const struct program_source sources[] = {{"x", first, strlen(first), 1}, {"y", second, strlen(second), 1}};
    diagnostics_free(&found);
    ck_assert(check_programs(sources, 2, &options, &found));
    ck_assert_uint_eq(found.count, 0);
}
END_TEST

START_TEST(what_precedes_a_reset_in_several_sources_is_told_where_it_begins)
{
    const char *first = "W500 F9999 R", *second = "R \\ W5";
    const struct program_source sources[] = {{"x", first, strlen(first), 1}, {"y", second, strlen(second), 1}};
    diagnostics_free(&found);
    ck_assert(check_programs(sources, 2, &options, &found));
    ck_assert_uint_eq(found.count, 1);
    ck_assert_uint_eq(found.list[0].offset, 0);
    ck_assert_uint_eq(found.list[0].length, strlen(first));
}
END_TEST

START_TEST(a_source_for_all_motors_is_part_of_each_program_and_told_once)
{
    const char *all = "@1 F9999 R R q", *one = "J1", *other = "J2";
    const struct program_source sources[] = {
        {"x", all, strlen(all), 0}, {"y", one, strlen(one), 1}, {"z", other, strlen(other), 3}};
    diagnostics_free(&found);
    ck_assert(check_programs(sources, 3, &options, &found));
    ck_assert_uint_eq(found.errors, 1);
    ck_assert_uint_eq(found.count, 3);
    ck_assert_str_eq(found.list[0].name, "unused-label"); /* of motors 2 to 4 */
    ck_assert_str_eq(found.list[1].name, "unknown-command");
    ck_assert_str_eq(found.list[2].name, "missing-label");
    ck_assert_uint_eq(found.list[2].source, 2);
}
END_TEST

/* ---- Limits --------------------------------------------------------------------------------------------------------- */

START_TEST(programs_made_to_take_long_are_given_up_in_time)
{
    static char text[120000];
    size_t at = 0;
    for (unsigned i = 1; i <= 79; i++) { /* every subroutine calls all others, in loops of its own */
        at += (size_t)snprintf(text + at, sizeof text - at, "@%u L2 ", i);
        for (unsigned k = 1; k <= 79; k += 2)
            at += (size_t)snprintf(text + at, sizeof text - at, "L3 '%u I01H%u ", k, (i + k) % 79 + 1);
        at += (size_t)snprintf(text + at, sizeof text - at, ". ");
    }
    check(text);
    ck_assert_uint_eq(found.errors, 0);
}
END_TEST

/* Processor time, which a machine with other work does not stretch. */
START_TEST(thousands_of_nolint_comments_in_a_line_do_not_take_seconds)
{
    static char text[250001];
    for (size_t at = 0; at + 10 < sizeof text; at += 10)
        memcpy(text + at, "{nolint x}", 10);
    const clock_t before = clock();
    check(text);
    ck_assert_uint_eq(found.warnings, 25000);
    ck_assert_msg(clock() - before < CLOCKS_PER_SEC, "%ld ms", (long)((clock() - before) / (CLOCKS_PER_SEC / 1000)));
}
END_TEST

static Suite *check_suite(void)
{
    Suite *suite = suite_create("check");
    TCase *errors = tcase_create("errors"), *warnings = tcase_create("warnings"), *limits = tcase_create("limits");
    tcase_add_checked_fixture(errors, set_up, tear_down);
    tcase_add_test(errors, every_error_is_found_at_its_place);
    tcase_add_test(errors, a_slip_is_answered_with_what_may_have_been_meant);
    tcase_add_test(errors, places_count_in_the_text_as_given);
    tcase_add_test(errors, errors_without_number_are_counted_and_kept_up_to_a_limit);
    tcase_add_test(errors, a_negative_position_is_an_error_where_the_unit_has_that_reading);
    tcase_add_checked_fixture(warnings, set_up, tear_down);
    tcase_add_loop_test(warnings, each_warning_is_found_where_it_is_deserved, 0, COUNT(warned));
    tcase_add_test(warnings, a_program_of_more_than_700_commands_is_noticed);
    tcase_add_test(warnings, nothing_is_said_about_good_programs);
    tcase_add_test(warnings, a_warning_can_be_switched_off);
    tcase_add_test(warnings, a_comment_switches_a_warning_off);
    tcase_add_test(warnings, motors_that_wait_for_each_other_are_found);
    tcase_add_test(warnings, a_program_by_itself_may_wait_for_any_variable);
    tcase_add_test(warnings, sources_for_one_motor_are_one_program);
    tcase_add_test(warnings, what_precedes_a_reset_in_several_sources_is_told_where_it_begins);
    tcase_add_test(warnings, a_source_for_all_motors_is_part_of_each_program_and_told_once);
    tcase_add_checked_fixture(limits, set_up, tear_down);
    tcase_set_timeout(limits, 60);
    tcase_add_test(limits, programs_made_to_take_long_are_given_up_in_time);
    tcase_add_test(limits, thousands_of_nolint_comments_in_a_line_do_not_take_seconds);
    suite_add_tcase(suite, errors);
    suite_add_tcase(suite, warnings);
    suite_add_tcase(suite, limits);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(check_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=warnings ./test_check");
    return failed > 0;
}
