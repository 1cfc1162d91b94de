/* SPDX-License-Identifier: MIT */
/* test_program_argument.c: the arguments [M=]FILE of those subcommands that take programs.
 * One test alone: CK_RUN_CASE=arguments ./test_program_argument */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>

#include "options/program_argument.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

START_TEST(an_argument_names_its_motor_or_means_motor_1)
{
    static const struct {
        const char *argument;
        unsigned motor;
        const char *path;
    } good[] = {
        {"a.rks", 1, "a.rks"}, {"1=a.rks", 1, "a.rks"}, {"0=a.rks", 0, "a.rks"}, {"4=a=b", 4, "a=b"},
        {"2=-", 2, "-"},       {"-", 1, "-"},           {"x=a", 1, "x=a"},       {"./7=a", 1, "./7=a"},
        {"12", 1, "12"},       {"=a", 1, "=a"},         {"3=", 3, ""},
    };
    for (size_t i = 0; i < COUNT(good); i++) {
        unsigned motor = 99;
        const char *path = NULL;
        ck_assert_msg(program_argument_read(good[i].argument, 4, &motor, &path), "'%s' refused", good[i].argument);
        ck_assert_uint_eq(motor, good[i].motor);
        ck_assert_str_eq(path, good[i].path);
    }
}
END_TEST

START_TEST(a_number_that_is_no_motor_is_refused)
{
    static const char *const bad[] = {"5=a", "9=a", "10=a", "01=a", "00=a"};
    for (size_t i = 0; i < COUNT(bad); i++) {
        unsigned motor;
        const char *path;
        ck_assert_msg(!program_argument_read(bad[i], 4, &motor, &path), "'%s' taken", bad[i]);
    }
}
END_TEST

static Suite *program_suite(void)
{
    Suite *suite = suite_create("program_argument");
    TCase *arguments = tcase_create("arguments");
    tcase_add_test(arguments, an_argument_names_its_motor_or_means_motor_1);
    tcase_add_test(arguments, a_number_that_is_no_motor_is_refused);
    suite_add_tcase(suite, arguments);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(program_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=arguments ./test_program_argument");
    return failed > 0;
}
