/* SPDX-License-Identifier: MIT */
/* test_program_text.c: program texts as people write them. One test alone: CK_RUN_CASE=texts ./test_program_text */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/program_text.h"

static void ck_mapped(const char *from, const char *to)
{
    size_t length = strlen(from);
    char *copy = malloc(length > 0 ? length : 1);
    ck_assert_ptr_nonnull(copy);
    memcpy(copy, from, length);
    size_t mapped = program_text_map(copy, length);
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

START_TEST(a_file_is_read_whole_whatever_its_length)
{
    static const size_t lengths[] = {0, 1, 4095, 4096, 4097, 8192, 100000};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        char path[] = "/tmp/program_text_XXXXXX";
        int fd = mkstemp(path);
        ck_assert_int_ge(fd, 0);
        FILE *file = fdopen(fd, "w");
        for (size_t n = 0; n < lengths[i]; n++)
            fputc('0' + (int)(n % 10), file);
        ck_assert_int_eq(fclose(file), 0);

        struct program_text text;
        const char *wrong = program_text_read(&text, path);
        remove(path);
        ck_assert_ptr_null(wrong);
        ck_assert_uint_eq(text.length, lengths[i]);
        for (size_t n = 0; n < lengths[i]; n++)
            ck_assert_int_eq(text.text[n], '0' + (int)(n % 10));
        program_text_free(&text);
    }
}
END_TEST

START_TEST(what_cannot_be_read_says_why)
{
    struct program_text text;
    ck_assert_str_eq(program_text_read(&text, "/no/such/file"), "No such file or directory");
    program_text_free(&text);
    ck_assert_str_eq(program_text_read(&text, "/"), "Is a directory");
    program_text_free(&text);
}
END_TEST

static Suite *text_suite(void)
{
    Suite *suite = suite_create("program_text");
    TCase *mapped = tcase_create("texts");
    tcase_add_test(mapped, typographic_apostrophes_are_the_call);
    tcase_add_test(mapped, a_byte_order_mark_at_the_beginning_is_dropped);
    tcase_add_test(mapped, all_other_bytes_stay_as_they_are);
    tcase_add_test(mapped, a_file_is_read_whole_whatever_its_length);
    tcase_add_test(mapped, what_cannot_be_read_says_why);
    suite_add_tcase(suite, mapped);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(text_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=texts ./test_program_text");
    return failed > 0;
}
