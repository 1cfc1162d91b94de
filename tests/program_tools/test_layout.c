/* SPDX-License-Identifier: MIT */
/* test_layout.c: the canonical layout of program texts. One case alone: CK_RUN_CASE=layout ./test_layout */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/text.h>

#include "program_tools/program_tools.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static char *laid_out;
static size_t laid_out_length;

static enum format_result lay_out(const char *text, size_t length)
{
    const struct program_source source = {"f.rks", text, length, 1};
    free(laid_out);
    return format_program(&source, &laid_out, &laid_out_length);
}

static void tear_down(void)
{
    free(laid_out);
    laid_out = NULL;
}

static void assert_layout(const char *text, const char *expected)
{
    ck_assert_int_eq(lay_out(text, strlen(text)), FORMAT_DONE);
    ck_assert_uint_eq(strlen(laid_out), laid_out_length);
    ck_assert_str_eq(laid_out, expected);
}

START_TEST(a_text_gets_its_canonical_layout)
{
    static const char *const pairs[][2] = {
        {"", ""},
        {" \n\n", ""},
        {"F 01000 R", "F1000 R\n"},
        {"S100 V500\nF1000 R W10 B5 R", "S100 V500\nF1000 R\nW10\nB5 R\n"},
        {"F5 R\n\n\n\nF6 R\n\n", "F5 R\n\nF6 R\n"},
        {"L3 F5 L2 R E E", "L3\n    F5\n    L2\n        R\n    E\nE\n"},
        {"\\C100 @1 O1 J01", "\\ C100\n@1\nO01\nJ1\n"},
        {"'5 J1 @5 T1 R . @1 W5", "'5\nJ1\n@5\n    T01 R\n    .\n@1\nW5\n"},
        {"'5 @5 I1H6 . @6 W1 . @1 R", "'5\n@5\n    I01H6\n    .\n@6\n    W1\n    .\n@1\nR\n"},
        {"{ a }F5{ b }R{ c }W5", "{ a } F5 { b } R { c }\nW5\n"},
        {"{ a }@1", "{ a }\n@1\n"},
        {"R\n   { b\n  c }F5", "R\n{ b\n  c }\nF5\n"},
        {"[ F5 R ] \"3 G + K C75", "[\n    F5 R\n]\n'3\nG+\nK C75\n"},
        {"{a\nb}F5\r\nR", "{a\nb}\r\nF5\r\nR\r\n"},
        {"F5\r\nR W1\r\n", "F5\r\nR\r\nW1\r\n"},
        {"\xEF\xBB\xBF\xE2\x80\x99" "3 {\xE2\x80\x99}", "'3 {\xE2\x80\x99}\n"},
        {"E E R", "E\nE\nR\n"},
    };
    for (size_t i = 0; i < COUNT(pairs); i++)
        assert_layout(pairs[i][0], pairs[i][1]);
}
END_TEST

START_TEST(a_long_line_is_continued_in_the_next)
{
    char text[4 * 40 + 1];
    for (size_t i = 0; i < 40; i++)
        memcpy(text + 4 * i, "T01 ", 5);
    ck_assert_int_eq(lay_out(text, strlen(text)), FORMAT_DONE);
    for (const char *line = laid_out; *line != '\0'; line = strchr(line, '\n') + 1)
        ck_assert_int_le(strchr(line, '\n') - line, 80);
}
END_TEST

START_TEST(a_text_that_the_unit_refuses_stays)
{
    static const char *const refused[] = {"q", "F", "{ a", "F5 R }", "f5"};
    for (size_t i = 0; i < COUNT(refused); i++) {
        ck_assert_int_eq(lay_out(refused[i], strlen(refused[i])), FORMAT_ERRORS);
        ck_assert_ptr_null(laid_out);
    }
}
END_TEST

/* ---- Random programs ------------------------------------------------------------------------------------------------ */

static uint32_t state = 1;

static uint32_t draw(uint32_t below)
{
    state = state * 1664525u + 1013904223u;
    return (state >> 8) % below;
}

/* A command that the unit takes. */
static struct rkm04_command draw_command(void)
{
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    enum rkm04_form form;
    struct rkm04_command command = {0};
    int count;
    do
        command.op = (uint8_t)draw(128);
    while ((count = rkm04_form_of(command.op, &form, ranges)) < 0 || command.op == '"');
    if (form == RKM04_FORM_JUMP_IF)
        command.argument = (1 + draw(8)) | draw(2) << 8 | (1 + draw(80)) << 16;
    else if (form == RKM04_FORM_ABSOLUTE && draw(3) == 0)
        command.argument = draw(2) ? RKM04_G_FORWARD : RKM04_G_BACK;
    else if (count > 0) {
        const struct rkm04_range *range = &ranges[draw((uint32_t)count)];
        command.argument = (uint32_t)range->low + draw((uint32_t)((int64_t)range->high - range->low < 1 << 23
                                                                      ? range->high - range->low + 1 : 1 << 23));
    }
    return command;
}

static size_t draw_between(char *text)
{
    static const char *const between[] = {"", " ", "\n", "\n\n", "\t", "{ a }", "\n{b}\n", " { c\n d } ", "\r\n"};
    const char *one = between[draw(COUNT(between))];
    memcpy(text, one, strlen(one));
    return strlen(one);
}

static void assert_same_commands(const struct rkm04_command *commands, size_t count)
{
    struct rkm04_reader reader;
    struct rkm04_command command;
    rkm04_read_begin(&reader, laid_out, laid_out_length);
    for (size_t i = 0; i < count; i++) {
        ck_assert_int_eq(rkm04_read(&reader, &command), RKM04_READ_COMMAND);
        ck_assert_msg(command.op == commands[i].op && command.argument == commands[i].argument, "command %zu of %s", i, laid_out);
    }
    ck_assert_int_eq(rkm04_read(&reader, &command), RKM04_READ_END);
}

START_TEST(random_programs_keep_their_commands_and_are_laid_out_once)
{
    static char text[120 * 32];
    static struct rkm04_command commands[120];
    for (unsigned program = 0; program < 10000; program++) {
        const size_t count = draw(COUNT(commands));
        size_t length = draw_between(text);
        for (size_t i = 0; i < count; i++) {
            commands[i] = draw_command();
            ck_assert(rkm04_command_valid(commands[i]));
            length += rkm04_format(commands[i], text + length);
            length += draw_between(text + length);
        }
        ck_assert_int_eq(lay_out(text, length), FORMAT_DONE);
        assert_same_commands(commands, count);
        char *before = laid_out;
        const size_t before_length = laid_out_length;
        laid_out = NULL;
        ck_assert_int_eq(lay_out(before, before_length), FORMAT_DONE);
        ck_assert_str_eq(laid_out, before);
        free(before);
    }
}
END_TEST

static Suite *layout_suite(void)
{
    Suite *suite = suite_create("layout");
    TCase *layout = tcase_create("layout");
    tcase_add_checked_fixture(layout, NULL, tear_down);
    tcase_set_timeout(layout, 120);
    tcase_add_test(layout, a_text_gets_its_canonical_layout);
    tcase_add_test(layout, a_long_line_is_continued_in_the_next);
    tcase_add_test(layout, a_text_that_the_unit_refuses_stays);
    tcase_add_test(layout, random_programs_keep_their_commands_and_are_laid_out_once);
    suite_add_tcase(suite, layout);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(layout_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=layout ./test_layout");
    return failed > 0;
}
