/* SPDX-License-Identifier: MIT */
/* test_explain.c: programs in words. One case alone: CK_RUN_CASE=explain ./test_explain */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program_tools/program_tools.h"

static struct explanations all;

static void tear_down(void)
{
    explain_free(&all);
}

/* Explain a text. Returns the words for the last command. */
static const char *explain_in(const char *text, enum explain_language language)
{
    const struct program_source source = {"x", text, strlen(text), 1};
    explain_free(&all);
    ck_assert(explain_programs(&source, 1, language, &all));
    ck_assert_uint_gt(all.count, 0);
    return all.list[all.count - 1].text;
}

static const char *explain(const char *text)
{
    return explain_in(text, EXPLAIN_ENGLISH);
}

START_TEST(each_motion_has_its_parameters)
{
    ck_assert_str_eq(explain("F100 R"), "move: 100 steps forward; S100 V1000 A2000");
    ck_assert_str_eq(explain("S50 V500 A900 B7 R"), "move: 7 steps back; S50 V500 A900");
    ck_assert_str_eq(explain("R"), "move: no steps are set: nothing moves; S100 V1000 A2000");
    ck_assert_str_eq(explain("C100 G500 D R"), "move: 500 steps back; S100 V1000 A2000");
    ck_assert_str_eq(explain("=800 G500"), "move to position 500: 300 steps back; S100 V1000 A2000");
    ck_assert_str_eq(explain("H"), "move to position 0; S100 V1000 A2000");
    ck_assert_str_eq(explain("M03 G-"), "move back without end; S100 V1000 A2000, guarded by M03");
    ck_assert_str_eq(explain("V50 (02"), "move back at start/stop speed until input 02 is 1; S100");
    ck_assert_str_eq(explain("V500 F100 Y V900 Y R"), "move: compound motion of 2 segments, 200 steps forward; S100");
    ck_assert_str_eq(explain("V500 F100 Y"), "segment of a compound motion: 100 steps forward; V500 A2000");
}
END_TEST

START_TEST(what_depends_on_the_way_is_left_open)
{
    ck_assert_str_eq(explain("F100 I01H1 V500 B100 @1 R"), "move: 100 steps forward or back; S100 A2000");
    ck_assert_str_eq(explain("F100 I01H1 F200 @1 R"), "move: the steps set before, forward; S100 V1000 A2000");
    ck_assert_str_eq(explain("'1 J2 @1 . F100 R @2"), "label 2");
    ck_assert_str_eq(all.list[2].text, "label 1, subroutine");
    ck_assert_str_eq(all.list[5].text, "move (never executed)");
}
END_TEST

START_TEST(every_command_has_words_in_both_languages)
{
    static const char text[] = "\\ @1 A1 B1 C1 C40 C41 C42 C51 C75 C80 C100 D E F1 G1 G+ G- H I1H1 I80L1 J1 K L1 M1 N1 O1 O80 "
                               "R S1 T1 T40 T41 T42 T51 T80 U V1 W1 X1 Y Z1 Z80 )1 (1 =-1 =1 '1 . [ ]";
    for (unsigned language = 0; language < EXPLAIN_LANGUAGES; language++) {
        explain_in(text, (enum explain_language)language);
        ck_assert_uint_eq(all.count, 51);
        for (size_t i = 0; i < all.count; i++) {
            ck_assert_msg(all.list[i].text[0] != '?', "%.4s", text + all.list[i].offset);
            ck_assert_msg(strchr(all.list[i].text, '%') == NULL, "%s", all.list[i].text);
        }
    }
}
END_TEST

START_TEST(czech_has_the_terms_of_the_manual)
{
    ck_assert_str_eq(explain_in("F100 R", EXPLAIN_CZECH), "proveď pohyb: 100 kroků vpřed; S100 V1000 A2000");
    ck_assert_str_eq(explain_in("I80H5", EXPLAIN_CZECH), "podmíněný skok: je-li proměnná 80 v log. 1, na návěští 5");
    ck_assert_str_eq(explain_in("X05", EXPLAIN_CZECH), "total stop od BI True: vstup 05 v log. 1 ukončí program");
    ck_assert_int_eq(explain_language_named("cs"), EXPLAIN_CZECH);
    ck_assert_int_eq(explain_language_named("de"), EXPLAIN_LANGUAGES);
}
END_TEST

START_TEST(a_place_finds_its_command)
{
    explain("W10 F100R {x}");
    ck_assert_str_eq(explain_at(&all, 0, 0)->text, "dwell 10 ms");
    ck_assert_str_eq(explain_at(&all, 0, 3)->text, "dwell 10 ms");
    ck_assert_str_eq(explain_at(&all, 0, 4)->text, "set 100 steps forward");
    ck_assert_str_eq(explain_at(&all, 0, 8)->text, "move: 100 steps forward; S100 V1000 A2000");
    ck_assert_ptr_null(explain_at(&all, 0, 11));
    ck_assert_ptr_null(explain_at(&all, 1, 0));
}
END_TEST

static Suite *explain_suite(void)
{
    Suite *suite = suite_create("explain");
    TCase *cases = tcase_create("explain");
    tcase_add_checked_fixture(cases, NULL, tear_down);
    tcase_add_test(cases, each_motion_has_its_parameters);
    tcase_add_test(cases, what_depends_on_the_way_is_left_open);
    tcase_add_test(cases, every_command_has_words_in_both_languages);
    tcase_add_test(cases, czech_has_the_terms_of_the_manual);
    tcase_add_test(cases, a_place_finds_its_command);
    suite_add_tcase(suite, cases);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(explain_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=explain ./test_explain");
    return failed > 0;
}
