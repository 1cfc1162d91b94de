/* test_exec_program.c: arguments and texts of `rkm04 exec`. One test alone: CK_RUN_CASE=texts ./test_exec_program */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "host/exec_program.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

START_TEST(an_argument_names_its_motor_or_means_motor_1)
{
    static const struct {
        const char *argument;
        char motor;
        const char *path;
    } good[] = {
        {"a.rks", '1', "a.rks"}, {"1=a.rks", '1', "a.rks"}, {"0=a.rks", '0', "a.rks"}, {"4=a=b", '4', "a=b"},
        {"2=-", '2', "-"},       {"-", '1', "-"},           {"x=a", '1', "x=a"},       {"./7=a", '1', "./7=a"},
        {"12", '1', "12"},       {"=a", '1', "=a"},         {"3=", '3', ""},
    };
    for (size_t i = 0; i < COUNT(good); i++) {
        char motor = '?';
        const char *path = NULL;
        ck_assert_msg(exec_program_argument(good[i].argument, &motor, &path), "'%s' refused", good[i].argument);
        ck_assert_int_eq(motor, good[i].motor);
        ck_assert_str_eq(path, good[i].path);
    }
}
END_TEST

START_TEST(a_number_that_is_no_motor_is_refused)
{
    static const char *const bad[] = {"5=a", "9=a", "10=a", "01=a", "00=a"};
    for (size_t i = 0; i < COUNT(bad); i++) {
        char motor;
        const char *path;
        ck_assert_msg(!exec_program_argument(bad[i], &motor, &path), "'%s' taken", bad[i]);
    }
}
END_TEST

static void ck_mapped(const char *from, const char *to)
{
    size_t length = strlen(from);
    char *copy = malloc(length > 0 ? length : 1);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, from, length);
    size_t mapped = exec_text_map(copy, length);
    ck_assert_uint_eq(mapped, strlen(to));
    ck_assert_mem_eq(copy, to, mapped);
    free(copy);
}

START_TEST(typographic_apostrophes_are_the_call)
{
    ck_mapped("@1 \xC2\xB4" "3 R", "@1 '3 R");
    ck_mapped("\xE2\x80\x98" "3\xE2\x80\x99" "4\xE2\x80\x9E" "5'6", "'3'4'5'6");
    ck_mapped("\xE2\x80\x9E\xE2\x80\x9E\xC2\xB4", "'''");
}
END_TEST

START_TEST(a_byte_order_mark_at_the_beginning_is_dropped)
{
    ck_mapped("\xEF\xBB\xBFR", "R");
    ck_mapped("\xEF\xBB\xBF", "");
    ck_mapped("R\xEF\xBB\xBF", "R\xEF\xBB\xBF");
    ck_mapped("\xEF\xBB\xBF\xEF\xBB\xBF", "\xEF\xBB\xBF");
}
END_TEST

START_TEST(all_other_bytes_stay_as_they_are)
{
    ck_mapped("", "");
    ck_mapped("F1000 R\r\n\t{ krok\xC5\xAF }", "F1000 R\r\n\t{ krok\xC5\xAF }");
    ck_mapped("\xB4" "3 \x84" "3 \"3", "\xB4" "3 \x84" "3 \"3");
    ck_mapped("\xE2\x80\x93 \xC2\xB5 \xE2\x80", "\xE2\x80\x93 \xC2\xB5 \xE2\x80");
    ck_mapped("\xC2", "\xC2");
}
END_TEST

static Suite *program_suite(void)
{
    Suite *suite = suite_create("exec_program");
    TCase *arguments = tcase_create("arguments");
    tcase_add_test(arguments, an_argument_names_its_motor_or_means_motor_1);
    tcase_add_test(arguments, a_number_that_is_no_motor_is_refused);
    suite_add_tcase(suite, arguments);
    TCase *texts = tcase_create("texts");
    tcase_add_test(texts, typographic_apostrophes_are_the_call);
    tcase_add_test(texts, a_byte_order_mark_at_the_beginning_is_dropped);
    tcase_add_test(texts, all_other_bytes_stay_as_they_are);
    suite_add_tcase(suite, texts);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(program_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=arguments|texts ./test_exec_program");
    return failed > 0;
}
