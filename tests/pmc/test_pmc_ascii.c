/* SPDX-License-Identifier: MIT */
/* Lines of text (section 9). AX: an example of the specification. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "face_rig.h"

static struct face_rig rig;
static const struct pmc_config two = {.face = &pmc_ascii_face, .axes = 2}, one = {.face = &pmc_ascii_face, .axes = 1};

static struct pmc_ignored *ignored(void)
{
    return &rig.unit.face.ascii.ignored;
}

static struct pmc_axis_state state_of(unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(&rig.unit, axis, &state);
    return state;
}

static const char *line(const char *text)
{
    return face_line(&rig, text);
}

/* A line that has no answer. */
static void tell(const char *text)
{
    ck_assert_str_eq(line(text), "");
}

static void expect_position(int32_t x, int32_t y)
{
    ck_assert_int_eq(face_position(&rig, 0), x);
    ck_assert_int_eq(face_position(&rig, 1), y);
}

START_TEST(ax41_bytes_of_lines)
{
    static const uint8_t pab[] = {0x50, 0x41, 0x42, 0x20, 0x31, 0x30, 0x2C, 0x2D, 0x31, 0x0D};
    static const uint8_t pic[] = {0x50, 0x49, 0x43, 0x20, 0x2D, 0x31, 0x30, 0x0D};
    static const uint8_t spd[] = {0x53, 0x50, 0x44, 0x20, 0x32, 0x30, 0x30, 0x30, 0x2C, 0x31, 0x30, 0x30, 0x0D};
    static const uint8_t pos[] = {0x50, 0x4F, 0x53, 0x0D};
    uint8_t answer[64];
    face_begin(&rig, &two);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, spd, sizeof spd), sizeof spd);
    ck_assert_str_eq(line("SPD"), "SPD 2000,100\n\r");
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, pab, sizeof pab), sizeof pab);
    face_wait(&rig, 1000);
    expect_position(10, -1);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, pic, sizeof pic), sizeof pic);
    face_wait(&rig, 1000);
    expect_position(0, -1);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, pos, sizeof pos), sizeof pos);
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, answer, sizeof answer), 22);
    ck_assert_mem_eq(answer, "POS 00000000,FFFFFFFF\r", 22);
}
END_TEST

START_TEST(ax42_positions)
{
    static const uint8_t back[] = {0x50, 0x4F, 0x53, 0x20, 0x46, 0x46, 0x46, 0x46, 0x46, 0x46, 0x46,
                                   0x36, 0x2C, 0x30, 0x30, 0x30, 0x30, 0x30, 0x30, 0x30, 0x30, 0x0D};
    face_begin(&rig, &two);
    tell("SPD 8000");
    tell("PAB 100000");
    face_wait(&rig, 60000);
    ck_assert_str_eq(line("POS"), "POS 000186A0,00000000\r");
    tell("CLL X");
    tell("PIC -10");
    face_wait(&rig, 1000);
    ck_assert_mem_eq(line("POS"), back, sizeof back);
    rig.unit.axis[0].commanded = -8388608;
    rig.unit.axis[1].commanded = 8388607;
    ck_assert_str_eq(line("POS"), "POS FF800000,007FFFFF\r");
    face_begin(&rig, &one);
    tell("PIC -10");
    face_wait(&rig, 1000);
    ck_assert_str_eq(line("POS"), "POS FFFFFFF6\r");
}
END_TEST

START_TEST(ax43_operands)
{
    face_begin(&rig, &two);
    tell("JOG X Axis");
    face_wait(&rig, 100);
    ck_assert(state_of(0).moving && state_of(0).forward && !state_of(1).moving);
    tell("STO XY Axis");
    face_wait(&rig, 1000);
    ck_assert(!state_of(0).moving);
    tell("JOG -X-Y");
    face_wait(&rig, 100);
    ck_assert(state_of(0).moving && !state_of(0).forward && state_of(1).moving && !state_of(1).forward);
    tell("STO X");
    face_wait(&rig, 1000);
    ck_assert(!state_of(0).moving && state_of(1).moving);
    tell("STO Y");
    face_wait(&rig, 1000);
    tell("CLL XY");
    tell("PAB ,1000");
    face_wait(&rig, 60000);
    expect_position(0, 1000);
    tell("PAB 10, -1");
    face_wait(&rig, 60000);
    expect_position(10, -1);
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 0);
}
END_TEST

START_TEST(ax44_ignored_lines_are_counted)
{
    face_begin(&rig, &two);
    tell("pos");
    tell("PRG X5");
    tell("PRG X64");
    tell("SPD 0");
    tell("JOG Z");
    tell("PAB 8388608");
    tell("0123456789012345678901234567890123456789012345678901234567890123");
    face_wait(&rig, 10);
    ck_assert(!state_of(0).moving && !state_of(1).moving);
    tell("JOG X");
    face_wait(&rig, 10);
    tell("PIC 1");
    tell("PIC 1,1");
    face_wait(&rig, 10);
    ck_assert(!state_of(1).moving);
    ck_assert_uint_eq(ignored()->unknown, 1);
    ck_assert_uint_eq(ignored()->operand, 2);
    ck_assert_uint_eq(ignored()->range, 3);
    ck_assert_uint_eq(ignored()->too_long, 1);
    ck_assert_uint_eq(ignored()->busy, 2);
    ck_assert_str_eq(line("ERD X"), "ERD 00\n\r");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 9);
    ck_assert_uint_eq(rig.unit.face.reply.counters.requests, 2);
}
END_TEST

START_TEST(ax45_driving_and_errors)
{
    static const uint8_t erd[] = {0x45, 0x52, 0x44, 0x20, 0x30, 0x31, 0x0A, 0x0D, 0};
    face_begin(&rig, &two);
    pmc_set_parameter(&rig.unit, 0, PMC_SOFT_PLUS, 500);
    tell("SPD 1000");
    tell("PIC 501");
    face_wait(&rig, 20);
    ck_assert_str_eq(line("INR X"), "INR X 1\r");
    ck_assert_str_eq(line("INR Y"), "INR Y 0\r");
    face_wait(&rig, 1000);
    ck_assert_str_eq(line("ERD X"), (const char *)erd);
    ck_assert_str_eq(line("ERD Y"), "ERD 00\n\r");
    ck_assert_str_eq(line("INR X"), "INR X 0\r");
    tell("PRG X00");
    ck_assert_str_eq(line("INR X"), "INR X 2\r");
    tell("HOM Y");
    face_wait(&rig, 20);
    ck_assert_str_eq(line("INR Y"), "INR Y 5\r");
}
END_TEST

START_TEST(ax57_stop_drops_a_start_that_waits)
{
    face_begin(&rig, &two);
    tell("JOG X");
    ck_assert_str_eq(line("INR X"), "INR X 1\r");
    tell("STO X");
    ck_assert_str_eq(line("INR X"), "INR X 0\r");
    face_wait(&rig, 100);
    ck_assert_uint_eq(rig.pulses[0], 0);
}
END_TEST

START_TEST(ax60_first_answer_is_late)
{
    const struct pmc_config late = {.face = &pmc_ascii_face, .axes = 2, .first_answer_late = 2500};
    uint8_t answer[64];
    face_begin(&rig, &late);
    tell("POS");
    face_wait(&rig, 2499);
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, answer, sizeof answer), 0);
    ck_assert(pmc_ascii_face.has_answer(&rig.unit));
    face_wait(&rig, 1);
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, answer, sizeof answer), 22);
    ck_assert_str_eq(line("POS"), "POS 00000000,00000000\r");
    tell("WPG X00");
    ck_assert_uint_eq(ignored()->unknown, 1);
}
END_TEST

/* ---- What the clauses say besides ------------------------------------------------------------------------------------ */

static void expect_operand(const char *text, bool is_right)
{
    uint32_t before = ignored()->operand;
    (void)line(text);
    ck_assert_msg((ignored()->operand == before) == is_right, "`%s' is %s", text, is_right ? "refused" : "taken");
}

START_TEST(operands_right_and_wrong)
{
    static const char *const right[] = {"STO X Y", "STO YX", "STO X,Y", "JOG +X", "JOG X Axis", "CLL Y and more", "PAB +10",
                                        "PIC 1 ,  2", "PIC ,-0", "PIC 5,", "SPD 9,", "POS X", "RST 1", "INR X Axis", "ERD   Y",
                                        "SCI 19200 Bd", "PRG X Y 05", "PIC 10 20", "STO X -Y"};
    static const char *const wrong[] = {"STO", "STO ", "STO -X", "STO XX", "STO Z", "JOG - X", "JOG X - Y", "JOG X -Z", "JOG",
                                        "PAB", "PAB ,", "PAB -", "PAB - 1", "PAB 1,-", "PAB x", "SPD ,", "SPD x", "INR",
                                        "INR XY", "ERD", "PRG X", "PRG 05", "PRG X005", "PRG X0", "SCI x", "SCI -"};
    face_begin(&rig, &two);
    for (size_t i = 0; i < sizeof right / sizeof *right; i++)
        expect_operand(right[i], true);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        expect_operand(wrong[i], false);
    ck_assert_uint_eq(ignored()->unknown, 0);
}
END_TEST

START_TEST(mnemonics_need_three_capitals_and_a_blank)
{
    static const char *const wrong[] = {"P", "PO", "POSX", "POS,", "pos", "XYZ", " POS", "STOX", "WPR X 1"};
    face_begin(&rig, &two);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        tell(wrong[i]);
    ck_assert_uint_eq(ignored()->unknown, sizeof wrong / sizeof *wrong);
    tell("");
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, sizeof wrong / sizeof *wrong);
}
END_TEST

START_TEST(one_axis_has_x_alone)
{
    static const char *const wrong[] = {"STO Y", "STO XY", "JOG -Y", "PAB 1,1", "PAB ,1", "SPD ,5", "INR Y", "ERD Y", "PRG Y00"};
    face_begin(&rig, &one);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        expect_operand(wrong[i], false);
    expect_operand("PAB 1,", true);
    ck_assert_str_eq(line("SPD"), "SPD 10\n\r");
    ck_assert_str_eq(line("VER"), "VER PMC-1HS 1.00\n\r");
}
END_TEST

START_TEST(ranges)
{
    static const char *const wrong[] = {"SPD 8001", "SPD 1,0", "SPD -5", "PAB -8388609", "PIC 8388608",
                                        "PIC 1,99999999999999999999", "PRG X99", "SCI 9601", "SCI 0", "SCI -9600"};
    face_begin(&rig, &two);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        tell(wrong[i]);
    ck_assert_uint_eq(ignored()->range, sizeof wrong / sizeof *wrong);
    ck_assert_str_eq(line("SPD"), "SPD 10,10\n\r");
    tell("SPD 0000000000008000,1");
    ck_assert_str_eq(line("SPD"), "SPD 8000,1\n\r");
    ck_assert_uint_eq(rig.pulses[0], 0);
}
END_TEST

START_TEST(version_and_speed_of_the_line)
{
    face_begin(&rig, &two);
    ck_assert_str_eq(line("VER"), "VER PMC-2HS 1.00\n\r");
    ck_assert_str_eq(line("SCI"), "SCI 9600\n\r");
    tell("SCI 115200");
    ck_assert_str_eq(line("SCI"), "SCI 9600\n\r");
    tell("RST");
    face_wait(&rig, 2);
    ck_assert_str_eq(line("SCI"), "SCI 115200\n\r");
    tell("RST");
    face_wait(&rig, 2);
    ck_assert_str_eq(line("SCI"), "SCI 115200\n\r");
}
END_TEST

START_TEST(reset_is_as_power_up)
{
    face_begin(&rig, &two);
    tell("SPD 77,78");
    tell("PIC 10");
    face_wait(&rig, 1000);
    tell("RST");
    face_wait(&rig, 2);
    ck_assert_str_eq(line("POS"), "POS 00000000,00000000\r");
    ck_assert_str_eq(line("SPD"), "SPD 10,10\n\r");
}
END_TEST

START_TEST(counters_are_cleared_apart)
{
    face_begin(&rig, &two);
    tell("PIC 10,20");
    face_wait(&rig, 1000);
    tell("CLR X");
    tell("CLL Y");
    face_wait(&rig, 2);
    ck_assert_int_eq(state_of(0).commanded, 10);
    ck_assert_int_eq(state_of(0).actual, 0);
    ck_assert_int_eq(state_of(1).commanded, 0);
    ck_assert_int_eq(state_of(1).actual, 20);
    tell("JOG X");
    tell("CLL XY");
    ck_assert_uint_eq(ignored()->busy, 1);
}
END_TEST

START_TEST(second_question_is_answered_after_the_first)
{
    uint8_t byte[64];
    face_begin(&rig, &two);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, (const uint8_t *)"POS\r", 4), 4);
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, byte, 5), 5);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, (const uint8_t *)"PIC 1\rVER\rJOG X\r", 16), 10); /* VER waits */
    face_wait(&rig, 100);
    ck_assert_uint_eq(rig.pulses[0], 1);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, (const uint8_t *)"J", 1), 0);
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, byte, sizeof byte), 17);
    ck_assert_uint_eq(rig.unit.face.reply.counters.answers, 1);
    ck_assert(pmc_ascii_face.has_answer(&rig.unit));
    ck_assert_uint_eq(pmc_ascii_face.send(&rig.unit, byte, sizeof byte), 18);
    ck_assert_mem_eq(byte, "VER PMC-2HS 1.00\n\r", 18);
    ck_assert_uint_eq(rig.unit.face.reply.counters.answers, 2);
    ck_assert(!pmc_ascii_face.has_answer(&rig.unit));
}
END_TEST

START_TEST(other_control_characters_are_skipped)
{
    face_begin(&rig, &two);
    ck_assert_str_eq(line("\nV\tE\x7fR\n"), "VER PMC-2HS 1.00\n\r");
}
END_TEST

START_TEST(longest_line)
{
    face_begin(&rig, &two);
    (void)line("VER 567890123456789012345678901234567890123456789012345678901234");
    ck_assert_str_eq(rig.answer, "");
    ck_assert_uint_eq(ignored()->too_long, 1);
    ck_assert_str_eq(line("VER 56789012345678901234567890123456789012345678901234567890123"), "VER PMC-2HS 1.00\n\r");
}
END_TEST

START_TEST(line_with_a_lost_byte_is_ignored)
{
    face_begin(&rig, &two);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, (const uint8_t *)"JO", 2), 2);
    pmc_lose_byte(&rig.unit);
    tell(" X");
    ck_assert_uint_eq(ignored()->line, 1);
    ck_assert_str_eq(line("VER"), "VER PMC-2HS 1.00\n\r");
}
END_TEST

START_TEST(start_during_an_emergency_stop_ends_in_its_slot)
{
    face_begin(&rig, &two);
    pmc_set_inputs(&rig.unit, PMC_EMG);
    face_wait(&rig, 2);
    tell("JOG X");
    face_wait(&rig, 2);
    ck_assert_str_eq(line("ERD X"), "ERD 10\n\r");
    ck_assert_uint_eq(rig.pulses[0], 0);
    ck_assert_uint_eq(rig.unit.face.reply.counters.dropped, 0);
}
END_TEST

START_TEST(message_without_the_line)
{
    uint8_t answer[64];
    face_begin(&rig, &two);
    ck_assert_uint_eq(pmc_ascii_face.receive(&rig.unit, (const uint8_t *)"PO", 2), 2);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)"INR X", 5, answer, sizeof answer), 8);
    ck_assert_mem_eq(answer, "INR X 0\r", 8);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)"INR X", 5, answer, 3), 8);
    ck_assert_uint_eq(pmc_exchange(&rig.unit, (const uint8_t *)"inr", 3, answer, sizeof answer), 0);
    ck_assert_uint_eq(ignored()->unknown, 0);
    ck_assert_str_eq(line("S"), "POS 00000000,00000000\r");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("pmc_ascii");
    TCase *one_case = tcase_create("lines");
    tcase_add_test(one_case, ax41_bytes_of_lines);
    tcase_add_test(one_case, ax42_positions);
    tcase_add_test(one_case, ax43_operands);
    tcase_add_test(one_case, ax44_ignored_lines_are_counted);
    tcase_add_test(one_case, ax45_driving_and_errors);
    tcase_add_test(one_case, ax57_stop_drops_a_start_that_waits);
    tcase_add_test(one_case, ax60_first_answer_is_late);
    tcase_add_test(one_case, operands_right_and_wrong);
    tcase_add_test(one_case, mnemonics_need_three_capitals_and_a_blank);
    tcase_add_test(one_case, one_axis_has_x_alone);
    tcase_add_test(one_case, ranges);
    tcase_add_test(one_case, version_and_speed_of_the_line);
    tcase_add_test(one_case, reset_is_as_power_up);
    tcase_add_test(one_case, counters_are_cleared_apart);
    tcase_add_test(one_case, second_question_is_answered_after_the_first);
    tcase_add_test(one_case, other_control_characters_are_skipped);
    tcase_add_test(one_case, longest_line);
    tcase_add_test(one_case, line_with_a_lost_byte_is_ignored);
    tcase_add_test(one_case, start_during_an_emergency_stop_ends_in_its_slot);
    tcase_add_test(one_case, message_without_the_line);
    suite_add_tcase(suite, one_case);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
