/* SPDX-License-Identifier: MIT */
/* test_parse.c: reading the command language, section 5 of the specification.
 *
 * One case alone: CK_RUN_CASE=numbers ./test_parse */
#include <check.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/text.h>

#include "texts.h"

/* ---- Numbers ------------------------------------------------------------------------------------------------------- */

static void check_number(char op, int64_t value)
{
    char text[40];
    snprintf(text, sizeof text, "%c%" PRId64, op, value);
    if (legal(op, value))
        expect_command(text, op, (uint32_t)value);
    else
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
}

START_TEST(S5_a_number_is_taken_from_its_lowest_to_its_highest_and_refused_beside)
{
    const struct limits *row = &numbers[_i];
    ck_assert(legal(row->op, row->low) && legal(row->op, row->high));
    ck_assert(!legal(row->op, row->low - 1) && !legal(row->op, row->high + 1));
    for (int64_t beside = -1; beside <= 1; beside++) {
        if (row->low + beside >= 0 || row->op == '=')
            check_number(row->op, row->low + beside);
        check_number(row->op, row->high + beside);
    }
}
END_TEST

START_TEST(S5_no_number_outside_the_ranges_is_taken)
{
    char op = NUMBER_COMMANDS[_i];
    for (int64_t value = 0; value <= 70000; value++)
        check_number(op, value);
    for (int bit = 16; bit < 62; bit++)
        for (int64_t beside = -2; beside <= 2; beside++)
            check_number(op, (INT64_C(1) << bit) + beside);
    for (int64_t power = 10; power < INT64_MAX / 10; power *= 10)
        for (int64_t beside = -2; beside <= 2; beside++)
            check_number(op, power + beside);
}
END_TEST

START_TEST(S5_a_number_too_long_for_32_bits_is_a_bad_value)
{
    /* Modulo 2^32 and 2^64 these are 1, 5 and the like, which would be legal. */
    static const char *const too_long[] = {
        "4294967295",  "4294967296",  "4294967297",  "4294967301", "42949672961", "8589934593", "10000000001",
        "18446744073709551615", "18446744073709551616", "18446744073709551617", "36893488147419103233",
        "340282366920938463463374607431768211457", "99999999999999999999999999999999999999999999999999999999999999",
    };
    char op = NUMBER_COMMANDS[_i], text[100];
    for (size_t i = 0; i < COUNT(too_long); i++) {
        snprintf(text, sizeof text, "%c%s", op, too_long[i]);
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
    }
    for (int64_t n = 1; n <= 100; n++) { /* what the G+ and G- of the interface are encoded as, too */
        snprintf(text, sizeof text, "%c%" PRId64, op, (INT64_C(1) << 32) - n);
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
    }
}
END_TEST

START_TEST(S5_a_number_missing_is_a_bad_value)
{
    char op = NUMBER_COMMANDS[_i], text[20];
    static const char *const behind[] = {"", "R", "x5", "{}5", "\\", "!", "'1", "]", "H20"};
    for (size_t i = 0; i < COUNT(behind); i++) {
        snprintf(text, sizeof text, "%c%s", op, behind[i]);
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
        snprintf(text, sizeof text, " %c\r\n%s", op, behind[i]);
        expect_error(text, RKM04_READ_BAD_VALUE, 1, 4);
    }
}
END_TEST

START_TEST(S5_leading_zeros_are_allowed_and_one_digit_will_do)
{
    expect_command("Z3", 'Z', 3);
    expect_command("Z03", 'Z', 3);
    expect_command("F000000000000000000000000000000000000000000000000000100", 'F', 100);
    expect_command("G0002000000000", 'G', 2000000000);
    expect_command("=-00000000000000005", '=', (uint32_t)-5);
    expect_command("@080", '@', 80);
    expect_command("C0100", 'C', 100);
    expect_command("I1H1", 'I', 1 | 1 << 8 | 1 << 16);
    expect_command("I0080L0080", 'I', 80 | 80 << 16);
    expect_error("F000", RKM04_READ_BAD_VALUE, 0, 1);
}
END_TEST

START_TEST(S5_the_position_may_be_negative_and_nothing_else)
{
    expect_command("=0", '=', 0);
    expect_command("=-0", '=', 0);
    expect_command("=-1", '=', UINT32_MAX);
    expect_command("=-2000000000", '=', (uint32_t)-2000000000);
    expect_error("=-2000000001", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("=-4294967295", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("= -3000000000", RKM04_READ_BAD_VALUE, 0, 2);
    expect_error("= \r\n3000000000", RKM04_READ_BAD_VALUE, 0, 4);
    expect_error("=+5", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("=--5", RKM04_READ_BAD_VALUE, 0, 2);
    expect_error("=-", RKM04_READ_BAD_VALUE, 0, 2);
    expect_error("=- R", RKM04_READ_BAD_VALUE, 0, 3);
    for (const char *op = "@ABCFJLMNOSTVWXZ)('I"; *op; op++) {
        char text[] = {*op, '-', '5', 0};
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
        text[1] = '+';
        expect_error(text, RKM04_READ_BAD_VALUE, 0, 1);
    }
}
END_TEST

START_TEST(S5_endless_motion_is_a_sign_alone)
{
    expect_command("G+", 'G', RKM04_G_FORWARD);
    expect_command("G-", 'G', RKM04_G_BACK);
    ck_assert_reads("G+G-G5", "G+ G- G5");
    ck_assert_reads("G+5", "G+ ?2");
    ck_assert_reads("G-+", "G- ?2");
}
END_TEST

START_TEST(S5_a_jump_on_a_bit_takes_inputs_variables_and_labels)
{
    char text[30];
    for (unsigned bit = 0; bit <= 300; bit++)
        for (unsigned label = 0; label <= 300; label++) {
            unsigned level = (bit + label) & 1;
            bool bit_legal = (1 <= bit && bit <= 8) || (80 <= bit && bit <= 95);
            snprintf(text, sizeof text, "I%u%c%u", bit, level ? 'H' : 'L', label);
            if (bit_legal && 1 <= label && label <= 80)
                expect_command(text, 'I', bit | level << 8 | label << 16);
            else
                expect_error(text, RKM04_READ_BAD_VALUE, 0, bit_legal ? strcspn(text, "HL") + 1 : 1);
        }
    expect_error("I4294967297H20", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("I01H4294967297", RKM04_READ_BAD_VALUE, 0, 4);
    expect_error("I", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("IH20", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("I01", RKM04_READ_BAD_VALUE, 0, 3);
    expect_error("I01X5", RKM04_READ_BAD_VALUE, 0, 3);
    expect_error("I01h20", RKM04_READ_BAD_VALUE, 0, 3);
    expect_error("I01H", RKM04_READ_BAD_VALUE, 0, 4);
    expect_error("I01HR", RKM04_READ_BAD_VALUE, 0, 4);
    expect_error("I01HL20", RKM04_READ_BAD_VALUE, 0, 4);
    expect_error("I01 20", RKM04_READ_BAD_VALUE, 0, 4);
}
END_TEST

/* ---- Characters ---------------------------------------------------------------------------------------------------- */

START_TEST(S5_every_character_that_is_no_command_is_unknown)
{
    for (unsigned character = 0; character <= 0xFF; character++) {
        uint8_t text[] = {' ', (uint8_t)character};
        struct rkm04_reader reader = begin_text(text, sizeof text);
        struct rkm04_command command = UNTOUCHED;
        enum rkm04_read got = rkm04_read(&reader, &command), expected = RKM04_READ_UNKNOWN;
        if (character <= 0x20)
            expected = RKM04_READ_END;
        else if (strchr(PLAIN_COMMANDS, (int)character))
            expected = RKM04_READ_COMMAND;
        else if (strchr(NUMBER_COMMANDS, (int)character) || character == 'I' || character == 0x22 || character == 0xB4 ||
                 character == 0x84)
            expected = RKM04_READ_BAD_VALUE;
        ck_assert_msg(got == expected, "character %02X: %d instead of %d", character, got, expected);
        if (got == RKM04_READ_COMMAND)
            ck_assert(command.op == character && command.argument == 0);
        else
            ck_assert(command.op == UNTOUCHED.op && command.argument == UNTOUCHED.argument);
        ck_assert_uint_eq(reader.at, 2);
        if (got == RKM04_READ_UNKNOWN)
            ck_assert(reader.start == 1 && reader.wrong == 1);
        ck_assert(rkm04_read(&reader, &command) == RKM04_READ_END);
    }
}
END_TEST

START_TEST(S5_commands_without_a_number_take_none)
{
    for (const char *op = PLAIN_COMMANDS; *op; op++) {
        char text[] = {*op, '1', 0};
        struct rkm04_reader reader = begin_text(text, 2);
        struct rkm04_command command;
        ck_assert(rkm04_read(&reader, &command) == RKM04_READ_COMMAND);
        ck_assert(command.op == (uint8_t)*op && command.argument == 0);
        ck_assert(rkm04_read(&reader, &command) == RKM04_READ_UNKNOWN);
        ck_assert_uint_eq(reader.start, 1);
    }
}
END_TEST

START_TEST(S5_the_call_is_taken_in_every_typesetting_of_the_manual)
{
    static const uint8_t calls[] = {0x27, 0x22, 0xB4, 0x84};
    for (size_t i = 0; i < COUNT(calls); i++) {
        expect_command((char[]){(char)calls[i], '0', '3', 0}, '\'', 3);
        expect_command((char[]){(char)calls[i], ' ', '8', '0', 0}, '\'', 80);
        expect_error((char[]){(char)calls[i], '8', '1', 0}, RKM04_READ_BAD_VALUE, 0, 1);
    }
    ck_assert_reads("\"1\xB4""2\x84""3'4", "'1 '2 '3 '4");
}
END_TEST

START_TEST(S5_lower_case_digits_and_signs_are_unknown_commands)
{
    for (const char *character = "abcdefghijklmnopqrstuvwxyz0123456789+-,;:!?/*}PQ\x7F\x80\xFF"; *character; character++)
        expect_error((char[]){' ', *character, '5', 0}, RKM04_READ_UNKNOWN, 1, 1);
    ck_assert_reads("F1 000", "F1 ?3");
    ck_assert_reads("F1.5", "F1 . ?3");
    ck_assert_reads("=5-3", "=5 ?2");
}
END_TEST

/* ---- Blanks and comments ------------------------------------------------------------------------------------------- */

START_TEST(S5_every_character_up_to_blank_separates)
{
    static const struct {
        const char *text; /* '_' stands for the character */
        char op;
        uint32_t argument;
    } places[] = {
        {"_F_100_", 'F', 100},
        {"__R__", 'R', 0},
        {"_I_01_H_20_", 'I', 1 | 1 << 8 | 20 << 16},
        {"I__95__L__80", 'I', 95 | 80 << 16},
        {"_G_+_", 'G', RKM04_G_FORWARD},
        {"G__-", 'G', RKM04_G_BACK},
        {"_=_-_5_", '=', (uint32_t)-5},
        {"=__7", '=', 7},
        {"'_3", '\'', 3},
        {")_08", ')', 8},
    };
    char text[20];
    for (size_t i = 0; i < COUNT(places); i++) {
        size_t length = strlen(places[i].text);
        for (size_t at = 0; at < length; at++)
            text[at] = places[i].text[at] == '_' ? (char)_i : places[i].text[at];
        ck_assert(is_command(text, length, places[i].op, places[i].argument));
    }
}
END_TEST

START_TEST(S5_a_number_ends_at_a_blank)
{
    char text[] = "F1_0R";
    text[2] = (char)_i;
    struct rkm04_reader reader = begin_text(text, 5);
    struct rkm04_command command;
    ck_assert(rkm04_read(&reader, &command) == RKM04_READ_COMMAND && command.op == 'F' && command.argument == 1);
    ck_assert(rkm04_read(&reader, &command) == RKM04_READ_UNKNOWN && reader.start == 3);
    ck_assert(rkm04_read(&reader, &command) == RKM04_READ_COMMAND && command.op == 'R');
    ck_assert(rkm04_read(&reader, &command) == RKM04_READ_END);
}
END_TEST

START_TEST(S5_blanks_inside_the_numbers_of_a_jump_are_refused)
{
    expect_error("I8 0H20", RKM04_READ_BAD_VALUE, 0, 3);
    expect_error("I0 1H20", RKM04_READ_BAD_VALUE, 0, 1);
    ck_assert_reads("I01H2 0", "I01H2 ?6");
}
END_TEST

START_TEST(S5_commands_need_no_separator)
{
    ck_assert_reads("\\S100V1000A2000L5F10RB20RE@1I01H1M05", "\\ S100 V1000 A2000 L5 F10 R B20 R E @1 I01H1 M05");
    ck_assert_reads("U'1.=-5G-[]KG100C75", "U '1 . =-5 G- [ ] K G100 C75");
    ck_assert_reads("", "");
    ck_assert_reads(" \t\r\n\x01\x1F", "");
}
END_TEST

START_TEST(S5_comments_may_be_anywhere_between_commands)
{
    static const char *const comments[] = {"{}", "{x}", "{ F1 R { \\ ' }", "{}{}{}", " { } ", "{\r\n\x01\x80\xFF}", "{{{{}",
                                            "\n{0}\n"};
    for (size_t i = 0; i < COUNT(comments); i++) {
        char text[200];
        const char *c = comments[i];
        snprintf(text, sizeof text, "%s\\%sF100%sI01H20%sG+%s=-5%sR%s", c, c, c, c, c, c, c);
        ck_assert_reads(text, "\\ F100 I01H20 G+ =-5 R");
        ck_assert_reads(c, "");
    }
    const char with_zero[] = "{\0}R{\0";
    struct rkm04_reader reader = begin_text(with_zero, 4);
    struct rkm04_command command;
    ck_assert(rkm04_read(&reader, &command) == RKM04_READ_COMMAND && command.op == 'R');
}
END_TEST

START_TEST(S5_a_comment_may_not_be_inside_a_command)
{
    expect_error("F{}100", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("G {}+", RKM04_READ_BAD_VALUE, 0, 2);
    expect_error("={}-5", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("=-{}5", RKM04_READ_BAD_VALUE, 0, 2);
    expect_error("I{}01H20", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("I01{}H20", RKM04_READ_BAD_VALUE, 0, 3);
    expect_error("I01H{}20", RKM04_READ_BAD_VALUE, 0, 4);
    ck_assert_reads("F1{}00", "F1 ?4");
}
END_TEST

START_TEST(S5_comments_do_not_nest)
{
    ck_assert_reads("{ a { b } R }", "R ?12");
    ck_assert_reads("R } R", "R ?2 R");
}
END_TEST

START_TEST(S5_a_comment_never_closed_is_an_unknown_command_at_its_place)
{
    expect_error("{", RKM04_READ_UNKNOWN, 0, 0);
    expect_error("  { F100 R", RKM04_READ_UNKNOWN, 2, 2);
    expect_error("{a}{b", RKM04_READ_UNKNOWN, 3, 3);
    ck_assert_reads("F1 { one } R { two, x F0", "F1 R ?13"); /* and nothing of the rest */
    ck_assert_reads("F{", "!0:1 ?1");
}
END_TEST

/* ---- Errors -------------------------------------------------------------------------------------------------------- */

START_TEST(S5_reading_goes_on_after_an_error_to_find_the_others)
{
    ck_assert_reads("\\ F0 R f100 R V16001 S R A-5 R", "\\ !2:3 R ?7 R !14:15 !21:23 R !25:26 R");
    ck_assert_reads("F0R", "!0:1 R");
    ck_assert_reads("F0xR", "!0:1 ?2 R");
    ck_assert_reads("F0{}R", "!0:1 R");
    ck_assert_reads("FR", "!0:1 R");
    ck_assert_reads("F\\", "!0:1 \\");
    ck_assert_reads("F'1", "!0:1 '1");
    ck_assert_reads("F\"1", "!0:1 '1");
    ck_assert_reads("Fx100R", "!0:1 R");
    ck_assert_reads("=+5R", "!0:1 R");
    ck_assert_reads("F0+5R", "!0:1 R");
    ck_assert_reads("F0-5R", "!0:1 R");
    ck_assert_reads("F  0R", "!0:3 R");
    ck_assert_reads("qR", "?0 R");
    ck_assert_reads("ab", "?0 ?1");
    ck_assert_reads("12 34", "?0 ?3");
    ck_assert_reads("I99H20 R", "!0:1 R");
    ck_assert_reads("I01H81 R", "!0:4 R");
    ck_assert_reads("IH20 R", "!0:1 R");
    ck_assert_reads("I01x20 R", "!0:3 R");
    ck_assert_reads("I01 20 R", "!0:4 R");
    ck_assert_reads("I01X5", "!0:3 X05");
    ck_assert_reads("I01H R", "!0:5 R");
    ck_assert_reads("I R", "!0:2 R");
    ck_assert_reads("F", "!0:1");
    ck_assert_reads("F  ", "!0:3");
    ck_assert_reads("=-", "!0:2");
}
END_TEST

START_TEST(S5_the_first_error_of_a_command_is_the_one_reported)
{
    expect_error("I99x81", RKM04_READ_BAD_VALUE, 0, 1);
    expect_error("I 01 x 81", RKM04_READ_BAD_VALUE, 0, 5);
    expect_error("\r\n F0 f V0", RKM04_READ_BAD_VALUE, 3, 4);
    expect_error("f F0", RKM04_READ_UNKNOWN, 0, 0);
}
END_TEST

static Suite *parse_suite(void)
{
    Suite *suite = suite_create("parse");
    TCase *values = tcase_create("numbers");
    tcase_set_timeout(values, 60);
    tcase_add_loop_test(values, S5_a_number_is_taken_from_its_lowest_to_its_highest_and_refused_beside, 0, NUMBER_ROWS);
    tcase_add_loop_test(values, S5_no_number_outside_the_ranges_is_taken, 0, sizeof NUMBER_COMMANDS - 1);
    tcase_add_loop_test(values, S5_a_number_too_long_for_32_bits_is_a_bad_value, 0, sizeof NUMBER_COMMANDS - 1);
    tcase_add_loop_test(values, S5_a_number_missing_is_a_bad_value, 0, sizeof NUMBER_COMMANDS - 1);
    tcase_add_test(values, S5_leading_zeros_are_allowed_and_one_digit_will_do);
    tcase_add_test(values, S5_the_position_may_be_negative_and_nothing_else);
    tcase_add_test(values, S5_endless_motion_is_a_sign_alone);
    tcase_add_test(values, S5_a_jump_on_a_bit_takes_inputs_variables_and_labels);
    suite_add_tcase(suite, values);

    TCase *characters = tcase_create("characters");
    tcase_add_test(characters, S5_every_character_that_is_no_command_is_unknown);
    tcase_add_test(characters, S5_commands_without_a_number_take_none);
    tcase_add_test(characters, S5_the_call_is_taken_in_every_typesetting_of_the_manual);
    tcase_add_test(characters, S5_lower_case_digits_and_signs_are_unknown_commands);
    tcase_add_loop_test(characters, S5_every_character_up_to_blank_separates, 0, 0x21);
    tcase_add_loop_test(characters, S5_a_number_ends_at_a_blank, 0, 0x21);
    tcase_add_test(characters, S5_blanks_inside_the_numbers_of_a_jump_are_refused);
    tcase_add_test(characters, S5_commands_need_no_separator);
    tcase_add_test(characters, S5_comments_may_be_anywhere_between_commands);
    tcase_add_test(characters, S5_a_comment_may_not_be_inside_a_command);
    tcase_add_test(characters, S5_comments_do_not_nest);
    tcase_add_test(characters, S5_a_comment_never_closed_is_an_unknown_command_at_its_place);
    suite_add_tcase(suite, characters);

    TCase *errors = tcase_create("errors");
    tcase_add_test(errors, S5_reading_goes_on_after_an_error_to_find_the_others);
    tcase_add_test(errors, S5_the_first_error_of_a_command_is_the_one_reported);
    suite_add_tcase(suite, errors);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(parse_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=numbers|characters|errors ./test_parse\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
