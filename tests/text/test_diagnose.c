/* SPDX-License-Identifier: MIT */
/* test_diagnose.c: what is reported about a text that the unit would refuse (P1, specification section 5).
 * One case alone: CK_RUN_CASE=messages ./test_diagnose */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "text/diagnose.h"

/* What is said about a text, "\n" after each error; the text is copied to size for the sanitizer to watch its end. */
static char *said;
static int errors;

static const char *diagnose_bytes(const char *bytes, size_t length)
{
    char *text = malloc(length + (length == 0));
    size_t size;
    free(said);
    said = NULL;
    ck_assert_ptr_nonnull(text);
    memcpy(text, bytes, length);
    FILE *out = open_memstream(&said, &size);
    ck_assert_ptr_nonnull(out);
    errors = diagnose_text("f.rks", text, length, out);
    fclose(out);
    free(text);
    return said;
}

static const char *diagnose(const char *text)
{
    return diagnose_bytes(text, strlen(text));
}

static void drop_said(void)
{
    free(said);
    said = NULL;
}

/* One error for the text: at 1:1, this message. */
static void assert_says(const char *text, const char *message)
{
    char expected[200];
    snprintf(expected, sizeof expected, "f.rks:1:1: error: %s\n", message);
    ck_assert_str_eq(diagnose(text), expected);
    ck_assert_int_eq(errors, 1);
}

/* ---- Messages ----------------------------------------------------------------------------------------------------- */

START_TEST(P1_nothing_is_said_about_a_text_that_the_unit_takes)
{
    static const char *const texts[] = {
        "", " \r\n\t", "{ F99999999 q }", "\\ C100 S100 V1000 A2000 F5000 R [ '3 ] G+ =-5 I 01 H 20",
    };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        ck_assert_str_eq(diagnose(texts[i]), "");
        ck_assert_int_eq(errors, 0);
    }
}
END_TEST

START_TEST(P1_a_bad_value_is_answered_with_what_was_expected_and_what_was_found)
{
    assert_says("V99999", "expected a number 1..16000 after V, found 99999");
    assert_says("A0", "expected a number 1..60000 after A, found 0");
    assert_says("F R", "expected a number 1..16000000 after F, found 'R'");
    assert_says("W", "expected a number 1..16000000 after W, found the end of the text");
    assert_says("C74", "expected a number 1..8, 40..58, 75, 80..95 or 100 after C, found 74");
    assert_says("O9", "expected a number 1..8 or 80..95 after O, found 9");
    assert_says("\"81", "expected a number 1..80 after ', found 81");
    assert_says("=+5", "expected a number -2000000000..2000000000 after =, found +5");
    assert_says("=-2000000001", "expected a number -2000000000..2000000000 after =, found -2000000001");
    assert_says("G*", "expected a number 1..2000000000, + or - after G, found '*'");
    assert_says("F999999999999999999999999999999", "expected a number 1..16000000 after F, found 999999999999999999999999...");
}
END_TEST

START_TEST(P1_a_conditional_jump_is_told_which_part_is_wrong)
{
    assert_says("I9H1", "expected an input or variable 1..8 or 80..95 after I, found 9");
    assert_says("I H1", "expected an input or variable 1..8 or 80..95 after I, found 'H'");
    assert_says("I01 20", "expected H or L after the input of I, found 20");
    assert_says("I01X5", "expected H or L after the input of I, found 'X'");
    assert_says("I01L81", "expected a label 1..80 after H or L of I, found 81");
    assert_says("I80H", "expected a label 1..80 after H or L of I, found the end of the text");
}
END_TEST

START_TEST(P1_an_unknown_command_is_shown)
{
    assert_says("#", "expected a command, found '#'");
    assert_says("r", "expected a command, found 'r'; commands are capital letters: R");
    assert_says("q", "expected a command, found 'q'");
    assert_says("5", "expected a command, found 5");
    assert_says("}", "expected a command, found '}'; no comment is open here");
    assert_says("{ F1 R", "expected a } that ends this comment");
}
END_TEST

START_TEST(P1_a_letter_of_several_bytes_is_one_error)
{
    assert_says("\xC3\xA9", "expected a command, found '\xC3\xA9'");
    assert_says("\xE2\x82\xAC", "expected a command, found '\xE2\x82\xAC'");
}
END_TEST

START_TEST(P1_characters_that_cannot_be_seen_are_named)
{
    assert_says("\xC2\xA0", "expected a command, found a no-break space (U+00A0)");
    assert_says("\xE2\x80\x8B", "expected a command, found a zero-width space (U+200B)");
    assert_says("F\xC2\xA0", "expected a number 1..16000000 after F, found a no-break space (U+00A0)");
}
END_TEST

START_TEST(P1_bytes_that_a_terminal_would_obey_are_not_printed)
{
    assert_says("\x7F", "expected a command, found byte 7F");
    assert_says("\xC2\x9B", "expected a command, found byte C2");
    assert_says("\xFF", "expected a command, found byte FF");
}
END_TEST

/* ---- Places ------------------------------------------------------------------------------------------------------- */

START_TEST(P1_every_error_has_a_line_of_its_own)
{
    ck_assert_str_eq(diagnose("S1 S3000 q\nR\n\n  V0 R"), "f.rks:1:4: error: expected a number 1..2000 after S, found 3000\n"
                                                          "f.rks:1:10: error: expected a command, found 'q'\n"
                                                          "f.rks:4:3: error: expected a number 1..16000 after V, found 0\n");
    ck_assert_int_eq(errors, 3);
}
END_TEST

START_TEST(P1_a_text_of_another_kind_does_not_fill_the_terminal)
{
    char text[5001];
    memset(text, 'q', sizeof text - 1u);
    text[sizeof text - 1u] = '\0';
    const char *lines = diagnose(text), *end = lines;
    size_t count = 0;
    for (const char *at = lines; (at = strchr(at, '\n')) != NULL; at++, count++)
        end = at[1] != '\0' ? at + 1 : end;
    ck_assert_uint_eq(count, 1001);
    ck_assert_str_eq(end, "f.rks: 4000 more errors are not shown\n");
    ck_assert_int_eq(errors, 5000);
}
END_TEST

START_TEST(P1_columns_count_characters_as_an_editor_does)
{
    static const char message[] = "f.rks:2:8: error: expected a command, found 'q'\n";
    ck_assert_str_eq(diagnose("R\r\n{\xC5\xBE\xC3\xAD} F5q"), message);  /* UTF-8 */
    ck_assert_str_eq(diagnose("R\r\n{\x9E\xED} F5q"), message);          /* code page 1250 */
    ck_assert_str_eq(diagnose("R\r\n{\xED\xE8} F5q"), message);          /* its bytes that look like the beginning of UTF-8 */
}
END_TEST

START_TEST(P1_any_bytes_are_judged_without_harm)
{
    char text[40];
    uint32_t random = 7;
    for (unsigned round = 0; round < 20000; round++) {
        size_t length = round % sizeof text;
        for (size_t i = 0; i < length; i++) {
            random = random * 1664525u + 1013904223u;
            char often = " 09+-IHLVGC={}\xC2\xE2\xF0\x84"[(random >> 16) % 18];
            text[i] = (random >> 8 & 3) == 0 ? (char)(random >> 24) : often;
        }
        diagnose_bytes(text, length);
        int lines = 0;
        for (const char *c = said; *c != '\0'; c++)
            lines += *c == '\n';
        ck_assert_int_eq(lines, errors);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("diagnose");
    TCase *messages = tcase_create("messages");
    tcase_add_checked_fixture(messages, NULL, drop_said);
    tcase_add_test(messages, P1_nothing_is_said_about_a_text_that_the_unit_takes);
    tcase_add_test(messages, P1_a_bad_value_is_answered_with_what_was_expected_and_what_was_found);
    tcase_add_test(messages, P1_a_conditional_jump_is_told_which_part_is_wrong);
    tcase_add_test(messages, P1_an_unknown_command_is_shown);
    tcase_add_test(messages, P1_a_letter_of_several_bytes_is_one_error);
    tcase_add_test(messages, P1_characters_that_cannot_be_seen_are_named);
    tcase_add_test(messages, P1_bytes_that_a_terminal_would_obey_are_not_printed);
    suite_add_tcase(suite, messages);
    TCase *places = tcase_create("places");
    tcase_add_checked_fixture(places, NULL, drop_said);
    tcase_set_timeout(places, 60);
    tcase_add_test(places, P1_every_error_has_a_line_of_its_own);
    tcase_add_test(places, P1_a_text_of_another_kind_does_not_fill_the_terminal);
    tcase_add_test(places, P1_columns_count_characters_as_an_editor_does);
    tcase_add_test(places, P1_any_bytes_are_judged_without_harm);
    suite_add_tcase(suite, places);

    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=messages|places ./test_diagnose\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
