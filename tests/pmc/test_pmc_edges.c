/* SPDX-License-Identifier: MIT */
/* The faces of a PMC and its texts at their edges: full queues, lines that wait, numbers that do not fit, bytes that are none. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "face_rig.h"

static struct face_rig rig;
static const struct pmc_config lines = {.face = &pmc_ascii_face, .axes = 2};
static const struct pmc_config bus = {.face = &pmc_modbus_face, .axes = 2, .address = 1, .baud = 9600};

/* ---- Lines of text ---------------------------------------------------------------------------------------------------- */

/* Bytes while an answer goes out. Returns how many were taken. */
static size_t receive(const char *text)
{
    return pmc_ascii_face.receive(&rig.unit, (const uint8_t *)text, strlen(text));
}

static const char *send(size_t room)
{
    static char text[64];
    text[pmc_ascii_face.send(&rig.unit, (uint8_t *)text, room)] = '\0';
    return text;
}

START_TEST(AS1_a_line_that_asks_waits_while_an_answer_goes_out)
{
    static const char *const questions[] = {"POS\r", "SPD\r", "SPD  \r", "SCI\r", "INR X\r"};
    for (size_t i = 0; i < sizeof questions / sizeof *questions; i++) {
        face_begin(&rig, &lines);
        ck_assert_uint_eq(receive("VER\r"), 4);
        ck_assert_uint_eq(receive(questions[i]), strlen(questions[i]));
        ck_assert_uint_eq(receive("POS\r"), 0);
        ck_assert_str_eq(send(6), "VER PM");
        ck_assert_uint_eq(receive("POS\r"), 0);
        ck_assert_str_eq(send(60), "C-2HS 1.00\n\r");
        ck_assert_uint_eq(rig.unit.face.reply.counters.answers, 1);
        ck_assert_msg(strncmp(send(60), questions[i], 3) == 0, "%s", questions[i]);
        ck_assert_uint_eq(receive("POS\r"), 4);
        ck_assert_str_eq(send(60), "POS 00000000,00000000\r");
    }
}
END_TEST

START_TEST(AS1_commands_and_wrong_lines_do_not_wait)
{
    face_begin(&rig, &lines);
    ck_assert_uint_eq(receive("VER\r"), 4);
    ck_assert_uint_eq(receive("SPD 77\r"), 7);
    ck_assert_uint_eq(receive("SPD  x\r"), 7);
    ck_assert_uint_eq(receive("FOO\r"), 4);
    ck_assert_uint_eq(receive("PO\r"), 3);
    for (unsigned i = 0; i < 70; i++)
        ck_assert_uint_eq(receive("P"), 1);
    ck_assert_uint_eq(receive("\r"), 1);
    ck_assert_uint_eq(receive("PO"), 2);
    pmc_lose_byte(&rig.unit);
    ck_assert_uint_eq(receive("S\r"), 2);
    const struct pmc_ignored *ignored = &rig.unit.face.ascii.ignored;
    ck_assert_uint_eq(ignored->operand, 1);
    ck_assert_uint_eq(ignored->unknown, 2);
    ck_assert_uint_eq(ignored->too_long, 1);
    ck_assert_uint_eq(ignored->line, 1);
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 5);
    ck_assert_uint_eq(rig.unit.face.reply.counters.requests, 2);
    ck_assert_str_eq(send(60), "VER PMC-2HS 1.00\n\r");
    ck_assert_str_eq(face_line(&rig, "SPD"), "SPD 77,10\n\r");
}
END_TEST

START_TEST(a_message_of_more_than_a_line_is_nothing)
{
    char text[PMC_LINE_MAX + 1];
    uint8_t answer[64];
    face_begin(&rig, &lines);
    memset(text, ' ', sizeof text);
    memcpy(text, "POS", 3);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)text, sizeof text - 1, answer, sizeof answer), 22);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)text, sizeof text, answer, sizeof answer), 0);
}
END_TEST

START_TEST(AS2_numbers_of_a_line)
{
    static const struct {
        const char *line, *speeds;
    } cases[] = {{"SPD 1,2", "SPD 1,2\n\r"},           {"SPD +3", "SPD 3,10\n\r"},          {"SPD ,4", "SPD 10,4\n\r"},
                 {"SPD 5 , 6 x", "SPD 5,6\n\r"},      {"SPD 007,8,9", "SPD 7,8\n\r"},     {"SPD 0000000000009", "SPD 9,10\n\r"},
                 {"SPD ,", "SPD 10,10\n\r"},          {"SPD -1", "SPD 10,10\n\r"},        {"SPD 1,-", "SPD 10,10\n\r"},
                 {"SPD 4294967297", "SPD 10,10\n\r"}, {"SPD 30000000001", "SPD 10,10\n\r"}, {"SPD 8000,8001", "SPD 10,10\n\r"},
                 {"SPD 8000.5", "SPD 8000,10\n\r"},   {"SPD x", "SPD 10,10\n\r"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        face_begin(&rig, &lines);
        ck_assert_str_eq(face_line(&rig, cases[i].line), "");
        ck_assert_msg(strcmp(face_line(&rig, "SPD"), cases[i].speeds) == 0, "%s: %s", cases[i].line, rig.answer);
    }
}
END_TEST

/* ---- Modbus ------------------------------------------------------------------------------------------------------------ */

static void expect(const char *request, const char *answer)
{
    const char *found = face_ask(&rig, request);
    ck_assert_msg(strcmp(found, answer) == 0, "%s: expected %s, found %s", request, answer, found);
}

static void ask_y(unsigned kind, int32_t value)
{
    const struct pmc_request request = {.kind = (uint8_t)kind, .axes = 2, .value = {0, value}};
    ck_assert_int_eq(pmc_request(&rig.unit, &request), PMC_OK);
}

/* A message without address and check value, at the present tick. */
static void expect_at_once(const char *request, size_t length, const char *expected, size_t count)
{
    uint8_t answer[PMC_FRAME_MAX];
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)request, length, answer, sizeof answer), count);
    ck_assert_mem_eq(answer, expected, count);
}

/* Eight requests of Y wait for the slot; then nothing of a frame that sets its fifth speed, too, is written. */
START_TEST(AB2_a_full_queue_refuses_a_frame_as_a_whole)
{
    static const char request[] = "\x10\4\x8a\0\4\x8\0\0\0\x63\0\x32\0\7"; /* home_offset 99, speed 50, start 7 */
    face_begin(&rig, &bus);
    for (unsigned i = 0; i < PMC_PENDING_MAX; i++)
        ask_y(i % 2 == 0 ? PMC_CLEAR_ERRORS : PMC_SET_SPEED, 20);
    expect_at_once(request, sizeof request - 1, "\x90\6", 2);
    ck_assert_int_eq(rig.unit.axis[1].parameters.value[PMC_HOME_OFFSET], 0);
    ck_assert_uint_eq(rig.unit.start[1], 0);
    face_wait(&rig, 2);
    expect_at_once(request, sizeof request - 1, "\x10\4\x8a\0\4", 5);
    ck_assert_int_eq(rig.unit.axis[1].parameters.value[PMC_HOME_OFFSET], 99);
    ck_assert_uint_eq(rig.unit.axis[1].speed, 50);
    ck_assert_uint_eq(rig.unit.start[1], 7);
}
END_TEST

START_TEST(AB4_counters_are_cleared_both_or_not_at_all)
{
    face_begin(&rig, &bus);
    rig.unit.axis[1].commanded = rig.unit.axis[1].actual = 9;
    for (unsigned i = 0; i < PMC_PENDING_MAX - 1u; i++)
        ask_y(i % 2 == 0 ? PMC_CLEAR_ERRORS : PMC_SET_SPEED, 20);
    expect_at_once("\6\0\0\x0a\x22", 5, "\x86\6", 2);
    face_wait(&rig, 2);
    ck_assert_int_eq(rig.unit.axis[1].commanded, 9);
    expect_at_once("\6\0\0\x0a\x22", 5, "\6\0\0\x0a\x22", 5);
    face_wait(&rig, 2);
    ck_assert(rig.unit.axis[1].commanded == 0 && rig.unit.axis[1].actual == 0);
}
END_TEST

/* 257 bytes and more are no frame, whatever stands in them. */
START_TEST(AB1_a_frame_that_is_too_long_is_dropped_as_a_whole)
{
    uint8_t bytes[300] = {1, 3, 4, 0x4E, 0, 8, 0x25, 0x2B};
    face_begin(&rig, &bus);
    ck_assert_uint_eq(pmc_modbus_face.receive(&rig.unit, bytes, sizeof bytes), sizeof bytes);
    ck_assert_uint_eq(pmc_modbus_face.receive(&rig.unit, bytes, 8), 8);
    face_wait(&rig, 6);
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 1);
    ck_assert(!pmc_modbus_face.has_answer(&rig.unit));
    ck_assert_msg(rig.stores && rig.flash[0][0] == 0xFF, "bytes were written behind the unit");
    expect("01 03 04 4E 00 01", "01 03 02 00 0A");
}
END_TEST

START_TEST(AB4_counters_and_stops_of_single_axes)
{
    face_begin(&rig, &bus);
    rig.unit.axis[0].commanded = rig.unit.axis[0].actual = rig.unit.axis[1].commanded = rig.unit.axis[1].actual = 9;
    expect("01 06 00 00 0A 10", "01 06 00 00 0A 10");
    expect("01 04 00 00 00 04", "01 04 08 00 00 00 09 00 00 00 00");
    expect("01 06 00 00 0A 02", "01 06 00 00 0A 02");
    expect("01 04 00 10 00 04", "01 04 08 00 00 00 00 00 00 00 09");
    expect("01 06 00 00 0A 00", "01 86 03");
    expect("01 06 00 00 0A 40", "01 86 03");
    expect("01 06 00 00 01 02", "01 06 00 00 01 02"); /* Y+ */
    expect("01 06 00 00 0A 21", "01 86 06");
    face_wait(&rig, 2);
    expect("01 04 00 14 00 02", "01 04 04 00 00 00 64");
    expect("01 06 00 00 0A 01", "01 06 00 00 0A 01");
    expect("01 06 00 00 05 20", "01 06 00 00 05 20");
    face_wait(&rig, 2);
    expect("01 04 00 16 00 01", "01 04 02 00 00");
    expect("01 06 00 00 05 21", "01 06 00 00 05 21");
    expect("01 06 00 00 05 11", "01 86 03");
    expect("01 06 00 00 05 00", "01 86 03");
}
END_TEST

START_TEST(AB5_a_block_has_nine_words_at_most_and_its_own)
{
    face_begin(&rig, &bus);
    expect("01 10 00 01 00 09 12 71 03 00 00 00 01 00 00 00 01 00 00 00 00 00 00 00 00", "01 90 03");
    expect("01 10 00 01 00 0A 14 71 03 00 00 00 01 00 00 00 01 00 00 00 00 00 00 00 00 00 00", "01 90 02");
    expect("01 10 00 01 00 03 06 71 01 00 00 00 01", "01 90 03");
    expect("01 10 00 01 00 03 06 61 01 00 00 00 01", "01 90 03"); /* speed 0 */
    expect("01 10 00 01 00 03 06 61 02 00 00 1F 41", "01 90 03"); /* 8001 */
    expect("01 10 00 01 00 03 06 61 02 00 00 1F 40", "01 10 00 01 00 03");
    expect("01 10 00 01 00 03 06 61 04 00 01 00 01", "01 90 03");
    expect("01 06 00 01 61 01", "01 86 02");
    expect("01 03 00 01 00 01", "01 83 02");
    expect("01 03 00 00 00 01", "01 03 02 00 00");
}
END_TEST

START_TEST(AP5_the_fifth_speed_as_a_register)
{
    face_begin(&rig, &bus);
    expect("01 06 04 84 00 00", "01 86 03");
    expect("01 06 04 84 1F 41", "01 86 03");
    expect("01 06 04 84 1F 40", "01 06 04 84 1F 40");
    expect("01 06 04 8C 00 01", "01 06 04 8C 00 01");
    expect("01 03 04 84 00 02", "01 03 04 1F 40 00 00");
    expect("01 06 04 85 00 3F", "01 06 04 85 00 3F");
    expect("01 06 04 85 00 40", "01 86 03");
    expect("01 03 04 8C 00 02", "01 03 04 00 01 00 00");
}
END_TEST

START_TEST(AB6_homed_not_homed_and_moving)
{
    face_begin(&rig, &bus);
    expect("01 04 00 0B 00 01", "01 04 02 00 00");
    expect("01 10 00 01 00 05 0A 71 03 00 00 03 E8 00 00 00 00", "01 10 00 01 00 05");
    face_wait(&rig, 5);
    expect("01 04 00 0B 00 01", "01 04 02 00 06");
    expect("01 04 00 1B 00 01", "01 04 02 00 02");
    expect("01 06 00 00 05 10", "01 06 00 00 05 10");
    expect("01 06 00 00 09 01", "01 06 00 00 09 01");
    expect("01 06 04 1D 1F 00", "01 06 04 1D 1F 00"); /* no step of the home search is on: error HOM */
    expect("01 06 00 00 06 01", "01 06 00 00 06 01");
    face_wait(&rig, 2);
    expect("01 04 00 08 00 01", "01 04 02 00 40");
    expect("01 06 04 1D 1F 82", "01 06 04 1D 1F 82"); /* step 2, +: home is active already, so one away and back */
    pmc_set_inputs(&rig.unit, PMC_HOME);
    expect("01 06 00 00 06 01", "01 06 00 00 06 01");
    face_wait(&rig, 20);
    pmc_set_inputs(&rig.unit, 0);
    face_wait(&rig, 20);
    pmc_set_inputs(&rig.unit, PMC_HOME);
    face_wait(&rig, 20);
    expect("01 04 00 0B 00 01", "01 04 02 00 01");
    expect("01 04 00 0D 00 01", "01 84 02");
    expect("01 04 00 1C 00 01", "01 04 02 00 00");
    expect("01 04 00 1C 00 02", "01 84 02");
    expect("01 04 FF FF 00 02", "01 84 02");
    expect("01 03 FF FF 00 02", "01 83 02");
    expect("01 10 FF FF 00 02 04 00 00 00 00", "01 90 02");
}
END_TEST

/* ---- Texts ------------------------------------------------------------------------------------------------------------- */

static struct pmc_command program[PMC_AXES][PMC_REGISTERS];
static struct pmc_parameters parameters[PMC_AXES];
static char reported[256];

static void report(void *context, const struct pmc_text_error *error)
{
    (void)context;
    snprintf(reported, sizeof reported, "%u:%u: %s", error->line, error->column, error->text);
}

static void expect_program_error(const char *text, size_t length, const char *error)
{
    ck_assert(!pmc_program_read(text, length, 2, program, report, NULL));
    ck_assert_str_eq(reported, error);
    ck_assert(!pmc_program_read(text, length, 2, program, NULL, NULL));
}

#define EXPECTED_VALUE "expected a value from -8388608 to 8388607, with one decimal place at most"

START_TEST(AF3_numbers_that_are_none)
{
    static const char *const values[] = {"99999999999", "8388608", "1.", "1.x", "1,5", ".5", "-", "+", "--1", "1.23", "1.2x",
                                         "-8388608.1"};
    char text[64];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        snprintf(text, sizeof text, "7 ABS %s V1", values[i]);
        expect_program_error(text, strlen(text), "1:7: " EXPECTED_VALUE);
    }
    expect_program_error("5 REP 99999999999", 17, "1:7: expected a count from 1 to 255");
    expect_program_error("5 REP 2147483648", 16, "1:7: expected a count from 1 to 255");
    expect_program_error("5 REP 1x", 8, "1:7: expected a count from 1 to 255");
    expect_program_error("5 REP -1", 8, "1:7: expected a count from 1 to 255");
    expect_program_error("-1 END", 6, "1:1: expected a register from 0 to 63");
    expect_program_error("1x END", 6, "1:1: expected a register from 0 to 63");
    expect_program_error("1 \t  # x", 8,
                         "1:2: expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP");
    expect_program_error("X:", 2, "1:3: expected a register from 0 to 63");
    expect_program_error("5 END\0", 6,
                         "1:3: expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP");
    expect_program_error("5 JMP 3\0", 8, "1:7: expected a register from 0 to 63");
}
END_TEST

START_TEST(AF1_the_longest_legal_numbers)
{
    static const char text[] = "63 REP 255\n0 ABS 8388607.0 V4 65535\n1 INC -8388608.0 V1 T3\n2 TIM +0065535\n";
    ck_assert(pmc_program_read(text, sizeof text - 1, 1, program, NULL, NULL));
    ck_assert_uint_eq(program[0][63].argument, 255);
    ck_assert_int_eq(program[0][0].value, 83886070);
    ck_assert_uint_eq(program[0][0].ms, 65535);
    ck_assert_int_eq(program[0][1].value, -83886080);
    ck_assert_uint_eq(program[0][1].number, 3);
    ck_assert_uint_eq(program[0][2].ms, 65535);
}
END_TEST

static void expect_parameter_error(const char *text, size_t length, const char *error)
{
    ck_assert(!pmc_parameters_read(text, length, 2, parameters, report, NULL));
    ck_assert_str_eq(reported, error);
    ck_assert(!pmc_parameters_read(text, length, 2, parameters, NULL, NULL));
}

START_TEST(AF2_bits_and_numbers_that_are_none)
{
    static const char *const values[] = {"0x01G3", "0x012",  "0x00123", "0X0123", "1x0123",
                                         "000123", "291", "0x0200", "0x-123"};
    char line[64];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        snprintf(line, sizeof line, "[X]\nflags = %s", values[i]);
        expect_parameter_error(line, strlen(line), "2:9: expected 0x and four hexadecimal digits, up to 0x01FF");
    }
    expect_parameter_error("[X]\nflags = 0x01\0003", 18, "2:9: expected 0x and four hexadecimal digits, up to 0x01FF");
    expect_parameter_error("[X]\nspeed1 = 99999999999", 24, "2:10: expected a number from 1 to 8000");
    expect_parameter_error("[X]\nspeed1 = 10 11", 18, "2:13: expected the end of the line");
    static const char text[] = "[Y]\nflags = 0x01eF\nsteps = 0x1FfF\ndeceleration = follow\n";
    ck_assert_msg(pmc_parameters_read(text, sizeof text - 1, 2, parameters, report, NULL), "%s", reported);
    ck_assert_int_eq(parameters[1].value[PMC_FLAGS], 0x1EF);
    ck_assert_int_eq(parameters[1].value[PMC_STEPS], 0x1FFF);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pmc_edges");
    TCase *text = tcase_create("edges");
    tcase_add_test(text, AS1_a_line_that_asks_waits_while_an_answer_goes_out);
    tcase_add_test(text, AS1_commands_and_wrong_lines_do_not_wait);
    tcase_add_test(text, a_message_of_more_than_a_line_is_nothing);
    tcase_add_test(text, AS2_numbers_of_a_line);
    tcase_add_test(text, AB2_a_full_queue_refuses_a_frame_as_a_whole);
    tcase_add_test(text, AB1_a_frame_that_is_too_long_is_dropped_as_a_whole);
    tcase_add_test(text, AB4_counters_are_cleared_both_or_not_at_all);
    tcase_add_test(text, AB4_counters_and_stops_of_single_axes);
    tcase_add_test(text, AB5_a_block_has_nine_words_at_most_and_its_own);
    tcase_add_test(text, AP5_the_fifth_speed_as_a_register);
    tcase_add_test(text, AB6_homed_not_homed_and_moving);
    tcase_add_test(text, AF3_numbers_that_are_none);
    tcase_add_test(text, AF1_the_longest_legal_numbers);
    tcase_add_test(text, AF2_bits_and_numbers_that_are_none);
    suite_add_tcase(suite, text);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
