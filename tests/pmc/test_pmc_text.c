/* SPDX-License-Identifier: MIT */
/* Programs and parameters as text (section 8). AX: an example of the specification. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "pmc/pmc.h"

static struct pmc_command program[PMC_AXES][PMC_REGISTERS];
static struct pmc_parameters parameters[PMC_AXES];
static char text[PMC_PROGRAM_TEXT_MAX + 1];
static char reported[4096];

static void report(void *context, const struct pmc_text_error *error)
{
    size_t length = strlen(reported);
    (void)context;
    snprintf(reported + length, sizeof reported - length, "%u:%u: %s: %s\n", error->line, error->column,
             error->is_warning ? "warning" : "error", error->text);
}

static bool read_program(const char *from, unsigned axes)
{
    reported[0] = '\0';
    return pmc_program_read(from, strlen(from), axes, program, report, NULL);
}

static bool read_parameters(const char *from, unsigned axes)
{
    reported[0] = '\0';
    return pmc_parameters_read(from, strlen(from), axes, parameters, report, NULL);
}

static const char *write_program(unsigned axes)
{
    const struct pmc_command *const all[PMC_AXES] = {program[0], program[1]};
    size_t length = pmc_program_write(all, axes, text, sizeof text - 1);
    ck_assert_uint_lt(length, sizeof text);
    text[length] = '\0';
    return text;
}

static const char *write_parameters(unsigned axes)
{
    const struct pmc_parameters *const all[PMC_AXES] = {&parameters[0], &parameters[1]};
    size_t length = pmc_parameters_write(all, axes, text, sizeof text - 1);
    text[length] = '\0';
    ck_assert_uint_lt(length, PMC_PARAMETER_TEXT_MAX);
    return text;
}

/* ---- Programs ------------------------------------------------------------------------------------------------------- */

START_TEST(ax52_canonical_form)
{
    static const char *const pairs[][2] = {
        {"5 REP 5", "X: 05 REP 5\n"},
        {"Y: 08 INC -20.5 V4", "Y: 08 INC -20.5 V4\n"},
        {"12 INC +3.0 V1 T2", "X: 12 INC 3 V1 T2\n"},
        {"13 ABS -0 V1 0", "X: 13 ABS 0 V1\n"},
        {"11 OTP OUT0 100 WAIT # x", "X: 11 OTP OUT0 100 WAIT\n"},
        {"9 IJP IN0 7", "X: 09 IJP IN0 07\n"},
        {"10 OUT OUT1 ON", "X: 10 OUT OUT1 ON\n"},
        {"0 JMP 5", "X: 00 JMP 05\n"},
        {"7 ABS -8388608 V1", "X: 07 ABS -8388608 V1\n"},
        {"7 INC -0.5 V1 00050", "X: 07 INC -0.5 V1 50\n"},
        {"3 NOP", ""},
        {"  # nothing\n\n\t63\tEND\r\n", "X: 63 END\n"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        ck_assert_msg(read_program(pairs[i][0], 2), "%s: %s", pairs[i][0], reported);
        ck_assert_str_eq(write_program(2), pairs[i][1]);
    }
}
END_TEST

START_TEST(one_axis_has_no_axis_in_its_lines)
{
    ck_assert(read_program("X: 0 HOM\n1 RPE\n", 1));
    ck_assert_str_eq(write_program(1), "00 HOM\n01 RPE\n");
    ck_assert(!read_program("Y: 0 HOM", 1));
    ck_assert_str_eq(reported, "1:1: error: expected axis X, the only one\n");
}
END_TEST

START_TEST(ax53_wrong_lines_are_refused)
{
    static const char *const wrong[][2] = {
        {"64 NOP", "1:1: error: expected a register from 0 to 63\n"},
        {"5 REP 256", "1:7: error: expected a count from 1 to 255\n"},
        {"5 REP 0", "1:7: error: expected a count from 1 to 255\n"},
        {"7 ABS 1 3", "1:9: error: expected a speed, V1 to V4\n"},
        {"7 ABS 1 V0", "1:9: error: expected a speed, V1 to V4\n"},
        {"7 ABS 1 V5", "1:9: error: expected a speed, V1 to V4\n"},
        {"7 ABS 1.25 V3", "1:7: error: expected a value from -8388608 to 8388607, with one decimal place at most\n"},
        {"7 ABS 8388608 V1", "1:7: error: expected a value from -8388608 to 8388607, with one decimal place at most\n"},
        {"7 ABS 8388607.1 V1", "1:7: error: expected a value from -8388608 to 8388607, with one decimal place at most\n"},
        {"7 ABS 1 V1 65536", "1:12: error: expected a dwell of 0 to 65535 ms, T1 to T3, or the end of the line\n"},
        {"7 ABS 1 V1 T4", "1:12: error: expected a dwell of 0 to 65535 ms, T1 to T3, or the end of the line\n"},
        {"7 ABS 1 V1 T1 5", "1:15: error: expected the end of the line\n"},
        {"9 IJP IN2 0", "1:7: error: expected IN0 or IN1\n"},
        {"9 OUT OUT2 ON", "1:7: error: expected OUT0 or OUT1\n"},
        {"9 OUT OUT1 on", "1:12: error: expected ON or OFF\n"},
        {"12 TIM 0", "1:8: error: expected a time from 1 to 65535 ms\n"},
        {"12 JMP 64", "1:8: error: expected a register from 0 to 63\n"},
        {"12 JMP", "1:7: error: expected a register from 0 to 63\n"},
        {"12 END 1", "1:8: error: expected the end of the line\n"},
        {"12 OTP OUT0 5 NOW", "1:15: error: expected WAIT or the end of the line\n"},
        {"012 END", "1:1: error: expected a register from 0 to 63\n"},
        {"+1 END", "1:1: error: expected a register from 0 to 63\n"},
        {"x: 1 END", "1:1: error: expected a register from 0 to 63\n"},
        {"1 end", "1:3: error: expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP\n"},
        {"1", "1:2: error: expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP\n"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ck_assert_msg(!read_program(wrong[i][0], 2), "%s", wrong[i][0]);
        ck_assert_str_eq(reported, wrong[i][1]);
    }
}
END_TEST

START_TEST(all_errors_are_reported_at_once)
{
    ck_assert(!read_program("0 HOM\nX: 0 END\nY: 0 END\n1 FOO\n\n 2 TIM x\n", 2));
    ck_assert_str_eq(reported, "2:4: error: expected a register that no line before has named\n"
                               "4:3: error: expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP\n"
                               "6:8: error: expected a time from 1 to 65535 ms\n");
}
END_TEST

START_TEST(warnings_do_not_refuse)
{
    ck_assert(read_program("2 RPE\n3 REP 1\n4 RPE\nY: 0 NOP\nY: 1 TIM 5\n", 2));
    ck_assert_str_eq(reported, "1:1: warning: RPE without a REP before it\n"
                               "3:1: warning: the program of this axis has no END\n"
                               "5:1: warning: the program of this axis has no END\n");
    ck_assert(read_program("0 REP 1\n1 RPE\n2 END\n", 2));
    ck_assert_str_eq(reported, "");
}
END_TEST

/* Every legal command comes back from its text. */
START_TEST(canonical_text_reads_back)
{
    static const struct pmc_command commands[] = {
        {.op = PMC_ABS, .value = -83886080, .speed = 4, .ms = 65535},
        {.op = PMC_INC, .value = 83886070, .speed = 1, .number = 3},
        {.op = PMC_INC, .value = 1, .speed = 2},
        {.op = PMC_HOM},
        {.op = PMC_IJP, .number = 1, .argument = 63},
        {.op = PMC_OUT, .number = 0, .argument = 0},
        {.op = PMC_OTP, .number = 1, .ms = 65535, .wait = true},
        {.op = PMC_OTP, .number = 1, .ms = 1},
        {.op = PMC_JMP, .argument = 0},
        {.op = PMC_REP, .argument = 255},
        {.op = PMC_RPE},
        {.op = PMC_END},
        {.op = PMC_TIM, .ms = 65535},
    };
    struct pmc_command copy[PMC_AXES][PMC_REGISTERS] = {{{0}}};
    char first[PMC_PROGRAM_TEXT_MAX + 1];
    for (unsigned i = 0; i < PMC_AXES * PMC_REGISTERS; i++) {
        copy[i / PMC_REGISTERS][i % PMC_REGISTERS] = commands[i % (sizeof commands / sizeof *commands)];
        ck_assert(pmc_command_valid(&copy[i / PMC_REGISTERS][i % PMC_REGISTERS]));
    }
    memcpy(program, copy, sizeof program);
    strcpy(first, write_program(2));
    ck_assert(read_program(first, 2));
    for (unsigned i = 0; i < PMC_AXES * PMC_REGISTERS; i++)
        ck_assert_mem_eq(&program[i / PMC_REGISTERS][i % PMC_REGISTERS], &copy[i / PMC_REGISTERS][i % PMC_REGISTERS],
                         sizeof(struct pmc_command));
    ck_assert_str_eq(write_program(2), first);
}
END_TEST

START_TEST(text_that_does_not_fit_is_cut_and_its_length_told)
{
    char small[8];
    ck_assert(read_program("0 INC -20.5 V4 50", 2));
    const struct pmc_command *const all[PMC_AXES] = {program[0], program[1]};
    ck_assert_uint_eq(pmc_program_write(all, 2, small, sizeof small), strlen("X: 00 INC -20.5 V4 50\n"));
    ck_assert_mem_eq(small, "X: 00 IN", sizeof small);
}
END_TEST

/* ---- Parameters ----------------------------------------------------------------------------------------------------- */

static uint32_t crc_of(const char *bytes)
{
    return crc32_update(0, (const uint8_t *)bytes, strlen(bytes));
}

START_TEST(ax59_defaults_in_the_canonical_form)
{
    unsigned lines = 0;
    ck_assert(read_parameters("", 2));
    const char *two = write_parameters(2);
    for (const char *at = two; *at != '\0'; at++)
        lines += *at == '\n';
    ck_assert_uint_eq(lines, 47);
    ck_assert_uint_eq(strlen(two), 701);
    ck_assert_uint_eq(crc_of(two), 0xD644B4F5);
    ck_assert_uint_eq(crc_of(write_parameters(1)), 0x0819A034);
}
END_TEST

START_TEST(parameters_read_back)
{
    const char *given = "# a comment\n[Y]\nspeed1=8000\n deceleration = 77\nlimit_minus = -8388608\n\n[X]\nsteps = 0x1fFf\n";
    char first[PMC_PARAMETER_TEXT_MAX];
    ck_assert_msg(read_parameters(given, 2), "%s", reported);
    ck_assert_int_eq(parameters[1].value[PMC_SPEED1], 8000);
    ck_assert_int_eq(pmc_parameter(&parameters[1], PMC_DECELERATION), 77);
    ck_assert_int_eq(parameters[1].value[PMC_FLAGS], 0x0133);
    ck_assert_int_eq(parameters[0].value[PMC_STEPS], 0x1FFF);
    ck_assert_int_eq(parameters[0].value[PMC_FLAGS], 0x0123);
    strcpy(first, write_parameters(2));
    ck_assert_ptr_nonnull(strstr(first, "deceleration = follow\n"));
    ck_assert_ptr_nonnull(strstr(first, "deceleration = 77\n"));
    ck_assert_msg(read_parameters(first, 2), "%s", reported);
    ck_assert_str_eq(write_parameters(2), first);
}
END_TEST

START_TEST(flag_of_the_deceleration_has_to_agree)
{
    ck_assert(read_parameters("[X]\nflags = 0x0133\ndeceleration = 5\n", 2));
    ck_assert(read_parameters("[X]\nflags = 0x0000\ndeceleration = follow\n", 2));
    ck_assert_int_eq(parameters[0].value[PMC_FLAGS], 0);
    ck_assert(!read_parameters("[X]\ndeceleration = 5\nflags = 0x0123\n", 2));
    ck_assert_str_eq(reported, "3:1: error: expected 0x0010 in flags, as deceleration is a number\n");
    ck_assert(!read_parameters("[X]\nflags = 0x0133\n", 2));
    ck_assert_str_eq(reported, "2:1: error: expected flags without 0x0010, as deceleration follows\n");
}
END_TEST

START_TEST(wrong_parameters_are_refused)
{
    static const char *const wrong[][2] = {
        {"speed1 = 5", "1:1: error: expected a section, [X] or [Y], before the first key\n"},
        {"[Z]", "1:2: error: expected [X] or [Y]\n"},
        {"[X", "1:2: error: expected [X] or [Y]\n"},
        {"[X] 5", "1:5: error: expected the end of the line\n"},
        {"[X]\n[X]", "2:2: error: expected each section once\n"},
        {"[X]\nspeed5 = 1", "2:1: error: expected a key as in the canonical form, multiplier to jerk\n"},
        {"[X]\n= 1", "2:1: error: expected a key as in the canonical form, multiplier to jerk\n"},
        {"[X]\nspeed1 1", "2:8: error: expected =\n"},
        {"[X]\nspeed1 = 0", "2:10: error: expected a number from 1 to 8000\n"},
        {"[X]\nspeed1 = 8001", "2:10: error: expected a number from 1 to 8000\n"},
        {"[X]\nspeed1 =", "2:9: error: expected a number from 1 to 8000\n"},
        {"[X]\nspeed1 = 5 6", "2:12: error: expected the end of the line\n"},
        {"[X]\nspeed1 = 5\nspeed1 = 5", "3:1: error: expected each key once in a section\n"},
        {"[X]\ndeceleration = follow\ndeceleration = follow", "3:1: error: expected each key once in a section\n"},
        {"[X]\ndeceleration = slow", "2:16: error: expected follow, or a number from 1 to 8000\n"},
        {"[X]\nmultiplier = 501", "2:14: error: expected a number from 1 to 500\n"},
        {"[X]\nlimit_plus = 8388608", "2:14: error: expected whole units from -8388608 to 8388607\n"},
        {"[X]\ntimer2 = -1", "2:10: error: expected ms from 0 to 65535\n"},
        {"[X]\nhome_offset = 8388608", "2:15: error: expected pulses from 0 to 8388607\n"},
        {"[X]\nflags = 0x0200", "2:9: error: expected 0x and four hexadecimal digits, up to 0x01FF\n"},
        {"[X]\nsteps = 1F03", "2:9: error: expected 0x and four hexadecimal digits, up to 0x1FFF\n"},
        {"[X]\njerk = 0", "2:8: error: expected a number from 1 to 65535\n"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ck_assert_msg(!read_parameters(wrong[i][0], 2), "%s", wrong[i][0]);
        ck_assert_str_eq(reported, wrong[i][1]);
    }
    ck_assert(!read_parameters("[Y]", 1));
    ck_assert_str_eq(reported, "1:2: error: expected [X], the only axis\n");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pmc_text");
    TCase *programs = tcase_create("programs"), *values = tcase_create("parameters");
    tcase_add_test(programs, ax52_canonical_form);
    tcase_add_test(programs, one_axis_has_no_axis_in_its_lines);
    tcase_add_test(programs, ax53_wrong_lines_are_refused);
    tcase_add_test(programs, all_errors_are_reported_at_once);
    tcase_add_test(programs, warnings_do_not_refuse);
    tcase_add_test(programs, canonical_text_reads_back);
    tcase_add_test(programs, text_that_does_not_fit_is_cut_and_its_length_told);
    tcase_add_test(values, ax59_defaults_in_the_canonical_form);
    tcase_add_test(values, parameters_read_back);
    tcase_add_test(values, flag_of_the_deceleration_has_to_agree);
    tcase_add_test(values, wrong_parameters_are_refused);
    suite_add_tcase(suite, programs);
    suite_add_tcase(suite, values);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
