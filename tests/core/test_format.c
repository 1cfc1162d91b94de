/* SPDX-License-Identifier: MIT */
/* test_format.c: canonical text (P8), valid commands, and the reader on random texts.
 *
 * One case alone: CK_RUN_CASE=canonical ./test_format */
#include <check.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/text.h>

#include "texts.h"

/* ---- Canonical text, validity, forms ------------------------------------------------------------------------------- */

START_TEST(P8_canonical_text_has_two_digits_for_bits_and_no_leading_zeros_elsewhere)
{
    ck_assert_reads("m5 {no} M5 N5 O5 Z5 X5 )5 (5 C5 T5", "?0 M05 N05 O05 Z05 X05 )05 (05 C05 T05");
    ck_assert_reads("O80 Z95 C40 C58 C75 C80 C100 T40 T58 T95", "O80 Z95 C40 C58 C75 C80 C100 T40 T58 T95");
    ck_assert_reads("I1H7 I008L080 I80H01 I 95 L 1", "I01H7 I08L80 I80H1 I95L1");
    ck_assert_reads("@07 A007 B09 F08 G01 J05 L03 S020 V0100 W06 '04 \"4", "@7 A7 B9 F8 G1 J5 L3 S20 V100 W6 '4 '4");
    ck_assert_reads("G + G - =0 =-0 =007 = - 0010", "G+ G- =0 =0 =7 =-10");
    ck_assert_reads("F16000000 G2000000000 =2000000000 =-2000000000", "F16000000 G2000000000 =2000000000 =-2000000000");
    for (const char *op = PLAIN_COMMANDS; *op; op++)
        ck_assert_reads(((char[]){*op, 0}), ((char[]){*op, 0}));
}
END_TEST

START_TEST(P8_what_is_no_command_has_its_character_for_a_text)
{
    char text[RKM04_COMMAND_TEXT_MAX];
    ck_assert_uint_eq(rkm04_format((struct rkm04_command){'q', 5}, text), 1);
    ck_assert_int_eq(text[0], 'q');
}
END_TEST

START_TEST(P8_canonical_text_is_that_of_the_number)
{
    const struct limits *row = &numbers[_i];
    int64_t values[] = {row->low, row->low + 1, (row->low + row->high) / 2, row->high - 1, row->high};
    for (size_t i = 0; i < COUNT(values); i++) {
        char text[40];
        if (!legal(row->op, values[i]))
            continue; /* beside a range of one number */
        int length = snprintf(text, sizeof text, "%c%0*" PRId64, row->op, row->digits, values[i]);
        char canonical[RKM04_COMMAND_TEXT_MAX];
        struct rkm04_command command = {(uint8_t)row->op, (uint32_t)values[i]};
        ck_assert(rkm04_command_valid(command));
        ck_assert_uint_eq(rkm04_format(command, canonical), (size_t)length);
        ck_assert_mem_eq(canonical, text, (size_t)length);
        ck_assert(is_command(canonical, (size_t)length, row->op, command.argument));
    }
}
END_TEST

/* A command is valid exactly if the reader gives it for some text; its canonical text is such a one. */
static void check_validity(uint8_t op, uint32_t argument, bool valid)
{
    struct rkm04_command command = {op, argument};
    if (rkm04_command_valid(command) != valid)
        ck_abort_msg("%02X with argument %08" PRIX32 " counts as %s", op, argument, valid ? "not valid" : "valid");
    if (!valid)
        return;
    char text[RKM04_COMMAND_TEXT_MAX];
    size_t length = rkm04_format(command, text);
    if (length < 1 || length > RKM04_COMMAND_TEXT_MAX || !is_command(text, length, (char)op, argument))
        ck_abort_msg("%c with argument %08" PRIX32 " is written as %.*s", op, argument, (int)length, text);
}

START_TEST(P8_exactly_the_commands_that_can_be_read_are_valid)
{
    for (unsigned op = 1; op <= 0xFF; op++) {
        if (op == 'I')
            continue;
        for (uint32_t argument = 0; argument <= 300; argument++) {
            check_validity((uint8_t)op, argument, legal_argument((uint8_t)op, argument));
            check_validity((uint8_t)op, 0 - argument, legal_argument((uint8_t)op, 0 - argument));
        }
        for (size_t i = 0; i < NUMBER_ROWS; i++)
            for (int64_t beside = -2; beside <= 2; beside++) {
                uint32_t low = (uint32_t)(numbers[i].low + beside), high = (uint32_t)(numbers[i].high + beside);
                check_validity((uint8_t)op, low, legal_argument((uint8_t)op, low));
                check_validity((uint8_t)op, high, legal_argument((uint8_t)op, high));
            }
    }
    ck_assert(!rkm04_command_valid((struct rkm04_command){0, 0}));
}
END_TEST

START_TEST(P8_exactly_the_jumps_that_can_be_read_are_valid)
{
    for (uint32_t bit = 0; bit <= 0xFF; bit++)
        for (uint32_t level = 0; level <= 3; level++)
            for (uint32_t label = 0; label <= 0xFF; label++) {
                bool valid = ((1 <= bit && bit <= 8) || (80 <= bit && bit <= 95)) && level <= 1 && 1 <= label && label <= 80;
                check_validity('I', bit | level << 8 | label << 16, valid);
            }
    check_validity('I', 1u | 1u << 8 | 257u << 16, false);
    check_validity('I', 1u | 0xFFu << 8 | 1u << 16, false);
    check_validity('I', UINT32_MAX, false);
}
END_TEST

START_TEST(S5_the_form_of_every_command_can_be_looked_up)
{
    enum rkm04_form form;
    struct rkm04_range ranges[RKM04_RANGES_MAX];
    for (unsigned op = 0; op <= 0xFF; op++) {
        bool call = op == 0x27 || op == 0x22 || op == 0xB4 || op == 0x84;
        int known = rkm04_form_of((uint8_t)op, &form, ranges), expected = -1;
        if (op != 0 && strchr(PLAIN_COMMANDS, (int)op))
            expected = 0;
        else if (op == 'I')
            expected = 3;
        else
            for (size_t i = 0; i < NUMBER_ROWS; i++)
                if (numbers[i].op == (char)op || (call && numbers[i].op == '\'')) {
                    expected = expected < 0 ? 0 : expected;
                    ck_assert_int_lt(expected, known);
                    ck_assert_int_eq(ranges[expected].low, numbers[i].low);
                    ck_assert_int_eq(ranges[expected].high, numbers[i].high);
                    expected++;
                }
        ck_assert_msg(known == expected, "%02X: %d ranges instead of %d", op, known, expected);
        if (known >= 0)
            ck_assert_int_eq(form, known == 0     ? RKM04_FORM_NONE
                                   : op == 'I'    ? RKM04_FORM_JUMP_IF
                                   : op == 'G'    ? RKM04_FORM_ABSOLUTE
                                   : op == '='    ? RKM04_FORM_SIGNED
                                                  : RKM04_FORM_NUMBER);
    }
    ck_assert_int_eq(rkm04_form_of('I', &form, ranges), 3);
    ck_assert(ranges[0].low == 1 && ranges[0].high == 8 && ranges[1].low == 80 && ranges[1].high == 95);
    ck_assert(ranges[2].low == 1 && ranges[2].high == 80);
}
END_TEST

/* ---- Random texts -------------------------------------------------------------------------------------------------- */

static uint32_t seed;

static uint32_t random_below(uint32_t limit)
{
    seed = seed * 1664525u + 1013904223u;
    return (uint32_t)((uint64_t)(seed >> 8) * limit >> 24);
}

/* Reads all of a text, errors included, and checks what must hold of any. Returns the number of steps it took. */
static size_t read_all(const uint8_t *text, size_t length)
{
    struct rkm04_reader reader = begin_text(text, length);
    size_t steps = 0, last = 0;
    enum rkm04_read got;
    do {
        struct rkm04_command command = UNTOUCHED;
        got = rkm04_read(&reader, &command);
        bool ok = last <= reader.start && reader.start <= reader.at && reader.at <= length && ++steps <= length + 1;
        if (got == RKM04_READ_END)
            ok = ok && reader.at == length;
        else
            ok = ok && reader.at > reader.start;
        if (got == RKM04_READ_COMMAND)
            ok = ok && rkm04_command_valid(command);
        else
            ok = ok && command.op == UNTOUCHED.op && command.argument == UNTOUCHED.argument;
        if (got == RKM04_READ_BAD_VALUE)
            ok = ok && reader.wrong > reader.start && reader.wrong <= length;
        if (got == RKM04_READ_UNKNOWN)
            ok = ok && reader.wrong == reader.start;
        if (!ok)
            ck_abort_msg("result %d, start %zu, wrong %zu, at %zu of %.*s", got, reader.start, reader.wrong, reader.at,
                         (int)length, (const char *)text);
        last = reader.at;
    } while (got != RKM04_READ_END);
    return steps;
}

START_TEST(S5_any_bytes_are_read_to_their_end_and_never_beyond)
{
    static const char likely[] = "\\@ABCDEFGHIJKLMNORSTUVWXYZ)(='.[]{}{} \t\r\n+-0123456789012345678901234567890HLxq\"\xB4\x84";
    uint8_t text[400];
    seed = 20090306u + (uint32_t)_i;
    for (int round = 0; round < 20000; round++) {
        size_t length = random_below(round % 100 ? 30 : sizeof text);
        for (size_t at = 0; at < length; at++)
            text[at] = _i % 2 ? (uint8_t)random_below(256) : (uint8_t)likely[random_below(sizeof likely)];
        read_all(text, length);
    }
}
END_TEST

START_TEST(S5_every_text_of_two_bytes_and_every_prefix_of_a_program_is_read_to_its_end)
{
    for (unsigned pair = 0; pair <= 0xFFFF; pair++)
        read_all((uint8_t[]){(uint8_t)(pair >> 8), (uint8_t)pair}, 2);
    static const char program[] = "\\ S100 { start } V1000 I 01 H 20 G + = - 5 '3 C100 F16000000 {open";
    for (size_t length = 0; length < sizeof program; length++)
        read_all((const uint8_t *)program, length);
}
END_TEST

START_TEST(L4_a_hostile_text_as_long_as_a_message_takes_no_more_steps_than_bytes)
{
    static const char *const patterns[] = {"{", "{}", "I", "=-", "9", "F9", "\xFF", " ", "}", "I99", "G"};
    static uint8_t text[9216];
    for (size_t i = 0; i < COUNT(patterns); i++) {
        for (size_t at = 0; at < sizeof text; at++)
            text[at] = (uint8_t)patterns[i][at % strlen(patterns[i])];
        ck_assert_uint_le(read_all(text, sizeof text), sizeof text + 1);
    }
}
END_TEST

static struct rkm04_command random_command(void)
{
    static const uint8_t bits[] = {1, 2, 3, 4, 5, 6, 7, 8, 80, 81, 82, 83, 84, 85, 86, 87, 88, 89, 90, 91, 92, 93, 94, 95};
    uint32_t kind = random_below(10);
    if (kind < 3)
        return (struct rkm04_command){(uint8_t)PLAIN_COMMANDS[random_below(sizeof PLAIN_COMMANDS - 1)], 0};
    if (kind == 3)
        return (struct rkm04_command){'I', bits[random_below(24)] | random_below(2) << 8 | (1 + random_below(80)) << 16};
    if (kind == 4)
        return (struct rkm04_command){'G', random_below(2) ? RKM04_G_FORWARD : RKM04_G_BACK};
    const struct limits *row = &numbers[random_below(NUMBER_ROWS)];
    int64_t span = row->high - row->low + 1;
    int64_t value = row->low + (int64_t)((uint64_t)random_below(1u << 24) * (uint64_t)span >> 24);
    return (struct rkm04_command){(uint8_t)row->op, (uint32_t)value};
}

/* Blanks, or comments too, or nothing. */
static size_t put_space(char *text, bool comments)
{
    size_t length = 0;
    for (uint32_t n = random_below(3); n > 0; n--) {
        text[length++] = (char)random_below(0x21);
        if (comments && random_below(3) == 0)
            length += (size_t)sprintf(text + length, "{ F%u \\ x { }", random_below(10));
    }
    return length;
}

/* The command as a careless author might write it. */
static size_t put_command(char *text, struct rkm04_command command)
{
    char canonical[RKM04_COMMAND_TEXT_MAX];
    size_t length = 0, of = rkm04_format(command, canonical);
    bool in_number = false;
    for (size_t i = 0; i < of; i++) {
        bool digit = i > 0 && '0' <= canonical[i] && canonical[i] <= '9';
        if (i > 0 && !in_number)
            length += put_space(text + length, false);
        if (digit && !in_number)
            for (uint32_t zeros = random_below(3) * random_below(8); zeros > 0; zeros--)
                text[length++] = '0';
        in_number = digit;
        if (i > 0 && !digit)
            length += put_space(text + length, false);
        text[length++] = canonical[i] == '\'' ? "'\"\xB4\x84"[random_below(4)] : canonical[i];
    }
    return length;
}

START_TEST(P8_a_program_written_in_any_way_reads_as_written_and_its_canonical_text_reads_the_same)
{
    static struct rkm04_command program[RKM04_PROGRAM_MAX];
    static char text[RKM04_PROGRAM_MAX * 160], canonical[RKM04_PROGRAM_MAX * (RKM04_COMMAND_TEXT_MAX + 1)];
    seed = 4711u + (uint32_t)_i;
    size_t length = 0, canonical_length = 0;
    for (size_t i = 0; i < COUNT(program); i++) {
        program[i] = random_command();
        length += put_space(text + length, true);
        length += put_command(text + length, program[i]);
        canonical_length += rkm04_format(program[i], canonical + canonical_length);
        canonical[canonical_length++] = ' ';
    }
    ck_assert_uint_lt(length, sizeof text);
    for (int way = 0; way < 2; way++) {
        struct rkm04_reader reader = way ? begin_text(canonical, canonical_length - 1) : begin_text(text, length);
        struct rkm04_command command;
        for (size_t i = 0; i < COUNT(program); i++) {
            ck_assert(rkm04_read(&reader, &command) == RKM04_READ_COMMAND);
            ck_assert(command.op == program[i].op && command.argument == program[i].argument);
        }
        ck_assert(rkm04_read(&reader, &command) == RKM04_READ_END);
    }
}
END_TEST

static Suite *format_suite(void)
{
    Suite *suite = suite_create("format");
    TCase *canonical = tcase_create("canonical");
    tcase_set_timeout(canonical, 60);
    tcase_add_test(canonical, P8_what_is_no_command_has_its_character_for_a_text);
    tcase_add_test(canonical, P8_canonical_text_has_two_digits_for_bits_and_no_leading_zeros_elsewhere);
    tcase_add_loop_test(canonical, P8_canonical_text_is_that_of_the_number, 0, NUMBER_ROWS);
    tcase_add_test(canonical, P8_exactly_the_commands_that_can_be_read_are_valid);
    tcase_add_test(canonical, P8_exactly_the_jumps_that_can_be_read_are_valid);
    tcase_add_test(canonical, S5_the_form_of_every_command_can_be_looked_up);
    suite_add_tcase(suite, canonical);

    TCase *random = tcase_create("random");
    tcase_set_timeout(random, 120);
    tcase_add_loop_test(random, S5_any_bytes_are_read_to_their_end_and_never_beyond, 0, 6);
    tcase_add_test(random, S5_every_text_of_two_bytes_and_every_prefix_of_a_program_is_read_to_its_end);
    tcase_add_test(random, L4_a_hostile_text_as_long_as_a_message_takes_no_more_steps_than_bytes);
    tcase_add_loop_test(random, P8_a_program_written_in_any_way_reads_as_written_and_its_canonical_text_reads_the_same, 0, 20);
    suite_add_tcase(suite, random);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(format_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        printf("One case alone: CK_RUN_CASE=canonical|random ./test_format\n");
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
