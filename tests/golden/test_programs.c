/* SPDX-License-Identifier: MIT */
/* test_programs.c: the example programs of the manual's sections 4.6 and 7 (parameters, jumps, compound motion), run as
 * printed; where print, prose and figure differ, section 7 of the specification says what counts.
 *
 * All times follow from three rules: a text that arrives at tick 0 begins in slot 1000, each command takes one slot, and the
 * command after a motion is executed in the first slot at or after its last pulse + 10 us (K4). A motion of N steps takes
 * 2(V-S)/A + (N - (V^2-S^2)/A)/V seconds, or 2(p-S)/A with p^2 = S^2 + A N where V is not reached (R1): move_ticks(). */
#include <check.h>
#include <string.h>

#include "manual_rig.h"

/* p^2 = 100^2 + 2000 * 1000: 3000 steps/s is not reached, each motion takes 2 (1417.7447 - 100) / 2000 s. */
START_TEST(M4_6_three_motions_with_dwells_and_a_step_count_that_is_not_run)
{
    rig_accept(&rig, '1', "S100 A2000 F1000 V3000\nL3 R W200 E \nB300");
    rig_to(&rig, 10 * SECOND);
    uint64_t slot = 6 * MS; /* of R */
    for (int pass = 1; pass <= 3; pass++) {
        ck_assert_uint_eq(move_ticks(100, 3000, 2000, 1000), 1317745);
        slot = moved(slot, 3000, 1000, true); /* to W */
        slot += 200 * MS;                     /* to E, which continues after L */
        slot += 1 * MS;
    }
    ck_assert_uint_eq(rig_ran(&rig, 9, 1), slot); /* B300 */
    expect_rest(3000);
}
END_TEST


START_TEST(M7_1_reset_alone)
{
    rig_accept(&rig, '1', "V3000 F1000 T01");
    rig_to(&rig, 10 * MS);
    rig_accept(&rig, '1', "\\");
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 0);
    rig_to(&rig, 100 * MS);
    expect_rest(0);
}
END_TEST

START_TEST(M7_2_label_alone)
{
    rig_accept(&rig, '1', "@2");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_ran(&rig, 1, 1), 1 * MS);
    expect_rest(0);
}
END_TEST

START_TEST(M7_3_acceleration_2000)
{
    rig_accept(&rig, '1', "A500 F1000");
    rig_accept(&rig, '1', "A2000");
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 3 * SECOND);
    moved(4 * MS, 1000, 1000, true);
    expect_rest(1000);
}
END_TEST

START_TEST(M7_4_1000_steps_back)
{
    rig_accept(&rig, '1', "B1000");
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 3 * SECOND);
    moved(2 * MS, 1000, 1000, false);
    expect_rest(-1000);
}
END_TEST

START_TEST(M7_5_output_06_off)
{
    rig_accept(&rig, '1', "T06 T05 W5");
    rig_accept(&rig, '1', "C06");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x30, 1), 2 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x10, 1), 8 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x10);
}
END_TEST

START_TEST(M7_6_variable_86_off)
{
    rig_accept(&rig, '1', "T86 T87 W5");
    rig_accept(&rig, '1', "C86");
    rig_to(&rig, 5 * MS);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0xC0);
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0x80);
}
END_TEST

START_TEST(M7_7_position_counter_to_0)
{
    rig_accept(&rig, '1', "F1000 R");
    rig_accept(&rig, '1', "C100");
    rig_to(&rig, 3 * SECOND);
    ck_assert_uint_eq(rig_ran(&rig, 3, 1), moved(2 * MS, 1000, 1000, true));
    expect_rest(0);
}
END_TEST

START_TEST(M7_8_forward_and_after_D_back)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\nR D R");
    rig_to(&rig, 5 * SECOND);
    uint64_t slot = moved(4 * MS, 1000, 1000, true); /* to D */
    moved(slot + 1 * MS, 1000, 1000, false);
    expect_rest(0);
}
END_TEST

START_TEST(M7_9_a_loop_of_two)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\nL2 R W200 E \nB300");
    rig_to(&rig, 5 * SECOND);
    uint64_t slot = 5 * MS;
    slot = moved(slot, 1000, 1000, true) + 201 * MS;
    slot = moved(slot, 1000, 1000, true) + 201 * MS;
    ck_assert_uint_eq(rig_ran(&rig, 8, 1), slot);
    expect_rest(2000);
}
END_TEST

START_TEST(M7_10_1000_steps_forward)
{
    rig_accept(&rig, '1', "F1000");
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 3 * SECOND);
    moved(2 * MS, 1000, 1000, true);
    expect_rest(1000);
}
END_TEST

START_TEST(M7_11_to_absolute_position_10000_from_below)
{
    rig_accept(&rig, '1', "G10000");
    rig_to(&rig, 20 * SECOND);
    moved(1 * MS, 1000, 10000, true);
    expect_rest(10000);
}
END_TEST

START_TEST(M7_11_to_absolute_position_10000_from_above)
{
    rig_accept(&rig, '1', "=12000 G10000");
    rig_to(&rig, 20 * SECOND);
    moved(2 * MS, 1000, 2000, false);
    expect_rest(10000);
}
END_TEST

/* 2.995 s after G+ in slot 5000: x = 247.5 + 1000 (2.995 - 0.45) = 2792.5, and 247.5 more down to S in 0.45 s. */
static void endless(const char *text, bool forward)
{
    rig_accept(&rig, '1', text);
    rig_input_at(&rig, 3 * SECOND, 5, true);
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, ++seen, 5 * MS, 3450 * MS, 3040, forward);
    expect_rest(forward ? 3040 : -3040);
}

START_TEST(M7_12_endless_forward_until_input_5)
{
    endless("S100 A2000 F1000\nM05 G+", true);
}
END_TEST

START_TEST(M7_13_endless_back_until_input_5)
{
    endless("S100 A2000 F1000\nM05 G-", false);
}
END_TEST

START_TEST(M7_14_home)
{
    rig_accept(&rig, '1', "H =700");
    rig_accept(&rig, '1', "H");
    rig_accept(&rig, '1', "=-700 H");
    rig_to(&rig, 5 * SECOND);
    uint64_t slot = moved(3 * MS, 1000, 700, false); /* the first H had no way to go */
    moved(slot + 1 * MS, 1000, 700, true);
    expect_rest(0);
}
END_TEST


static const char M7_15[] = "@19 I01H20 F200 R J21  \n@20 B200 R  \n@21";

START_TEST(M7_15_input_1_at_0_goes_forward_and_over_the_other_branch)
{
    rig_accept(&rig, '1', M7_15);
    rig_to(&rig, 3 * SECOND);
    uint64_t slot = moved(4 * MS, 1000, 200, true);
    ck_assert_uint_eq(rig_ran(&rig, 5, 1), slot);          /* J21 */
    ck_assert_uint_eq(rig_ran(&rig, 9, 1), slot + 1 * MS); /* @21 */
    ck_assert_uint_eq(rig_ran(&rig, 6, 1), RKM04_NEVER);   /* @20 */
    expect_rest(200);
}
END_TEST

START_TEST(M7_15_input_1_at_1_goes_back)
{
    rig_input_at(&rig, 0, 1, true);
    rig_accept(&rig, '1', M7_15);
    rig_to(&rig, 3 * SECOND);
    ck_assert_uint_eq(rig_ran(&rig, 6, 1), 3 * MS); /* @20 */
    uint64_t slot = moved(5 * MS, 1000, 200, false);
    ck_assert_uint_eq(rig_ran(&rig, 9, 1), slot); /* @21 */
    expect_rest(-200);
}
END_TEST

START_TEST(M7_16_a_jump_back_repeats_for_ever)
{
    rig_accept(&rig, '1', "@20 F200 R W500 J20");
    rig_to(&rig, 60 * SECOND);
    uint64_t slot = 3 * MS;
    for (int pass = 1; pass <= 50; pass++)
        slot = moved(slot, 1000, 200, true) + 500 * MS + 3 * MS; /* W to J, then @, F, R */
    ck_assert_int_eq(rig_motor(&rig, 1).state != RKM04_IDLE, true);
}
END_TEST

/* @1 I01L6 F2500 '3 Z3 J1 | @6 B2500 '3 Z4 J1 | @3 R W2000 D R . with the call as printed, byte B4. */
static const char M7_37[] = "@1 I01L6 \nF2500 \xB4"
                            "3 Z3 J1 \n@6 B2500 \xB4"
                            "3 Z4 J1 \n@3 R W2000 D R .";

/* One pass from the slot of R on. Returns the slot of the return. */
static uint64_t there_and_back(uint64_t slot, bool forward)
{
    slot = moved(slot, 1000, 2500, forward) + 2000 * MS; /* W to D */
    return moved(slot + 1 * MS, 1000, 2500, !forward);
}

START_TEST(M7_37_input_1_at_1_calls_the_subroutine_forward_first)
{
    rig_input_at(&rig, 0, 1, true);
    rig_accept(&rig, '1', M7_37);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = there_and_back(6 * MS, true); /* @1 I F ' @3 R */
    ck_assert_uint_eq(rig_ran(&rig, 17, 1), slot);         /* . */
    ck_assert_uint_eq(rig_ran(&rig, 5, 1), slot + 1 * MS); /* Z3, input 3 is 0 */
    ck_assert_uint_eq(rig_ran(&rig, 6, 1), slot + 2 * MS); /* J1 */
    there_and_back(slot + 8 * MS, true);                   /* @1 I F ' @3 R */
    ck_assert_uint_eq(rig_ran(&rig, 7, 1), RKM04_NEVER);   /* @6 */
}
END_TEST

START_TEST(M7_37_input_1_at_0_calls_the_subroutine_back_first)
{
    rig_accept(&rig, '1', M7_37);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = there_and_back(7 * MS, false); /* @1 I @6 B ' @3 R */
    ck_assert_uint_eq(rig_ran(&rig, 10, 1), slot + 1 * MS); /* Z4, input 4 is 0 */
    there_and_back(slot + 9 * MS, false);
    ck_assert_uint_eq(rig_ran(&rig, 3, 1), RKM04_NEVER); /* F2500 */
}
END_TEST

START_TEST(M7_38_after_the_call_the_program_waits_for_input_3)
{
    rig_input_at(&rig, 0, 1, true);
    rig_input_at(&rig, 0, 3, true);
    rig_accept(&rig, '1', M7_37);
    rig_to(&rig, 20 * SECOND);
    there_and_back(6 * MS, true);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 5);
    rig_input_at(&rig, 20 * SECOND + 1, 1, false);
    rig_input_at(&rig, 20 * SECOND + 1, 3, false); /* seen in the next slot; J1, @1, I01L6, @6, B, ', @3, R follow */
    rig_to(&rig, 30 * SECOND);
    there_and_back(20 * SECOND + 9 * MS, false);
}
END_TEST


static const char M7_36[] = "S100 A2000 V500 F2000 Y\nV2000 Y\nV500 F5000 Y\nV3000 A1000 Y \nV1500 F2000 Y\nV500 Y R";

/* Places where the slope changes, and when: 0.2 s up to 500; 3.88 s at 500; 0.75 s up to 2000, 0.0625 s there, 0.75 s down;
 * 10 s at 500; 2 s up to 2500, 1 s down to 1500; 1000/1500 s there, 1 s down to 500; 3.76 s there, 0.4 s down. */
START_TEST(M7_36_the_compound_motion_takes_24_469167_s)
{
    static const struct {
        size_t step; /* the last one before the corner, or on it */
        uint64_t us; /* of the corner, if a step falls on it */
    } corner[] = {{60, 200000},     {2000, 4080000},   {4000, 5642500},   {9000, 15642500},  {12000, 17642500},
                  {14000, 18642500}, {15000, 19309167}, {16000, 20309167}, {17880, 24069167}, {18000, 24469167}};
    rig_accept(&rig, '1', M7_36);
    rig_to(&rig, 60 * SECOND);
    uint64_t begin = 19 * MS; /* R is the nineteenth command */
    rig_expect_motion_near(&rig, 1, ++seen, begin, begin + 24469167, 18000, true);
    for (size_t i = 0; i < sizeof corner / sizeof *corner; i++) {
        uint64_t tick = recorder_step(&rig.record, 1, corner[i].step), wanted = begin + corner[i].us;
        ck_assert_msg(tick + 1 >= wanted && tick <= wanted + 1, "pulse %zu at %llu, not %llu", corner[i].step,
                      (unsigned long long)tick, (unsigned long long)wanted);
    }
    expect_rest(18000);
}
END_TEST

START_TEST(M7_36_its_speed_peaks_at_2500)
{
    uint32_t peak = 0;
    rig_accept(&rig, '1', M7_36);
    for (uint64_t tick = 0; tick < 26 * SECOND; tick += MS) {
        rig_to(&rig, tick);
        uint32_t speed = rig_motor(&rig, 1).speed;
        peak = speed > peak ? speed : peak;
    }
    ck_assert_uint_le(peak, 2500);
    ck_assert_uint_ge(peak, 2498);
}
END_TEST

static Suite *programs_suite(void)
{
    Suite *suite = suite_create("programs");

    TCase *chapter_4 = tcase_create("chapter_4");
    tcase_add_checked_fixture(chapter_4, setup, teardown);
    tcase_add_test(chapter_4, M4_6_three_motions_with_dwells_and_a_step_count_that_is_not_run);
    suite_add_tcase(suite, chapter_4);

    TCase *parameters = tcase_create("parameters");
    tcase_add_checked_fixture(parameters, setup, teardown);
    tcase_add_test(parameters, M7_1_reset_alone);
    tcase_add_test(parameters, M7_2_label_alone);
    tcase_add_test(parameters, M7_3_acceleration_2000);
    tcase_add_test(parameters, M7_4_1000_steps_back);
    tcase_add_test(parameters, M7_5_output_06_off);
    tcase_add_test(parameters, M7_6_variable_86_off);
    tcase_add_test(parameters, M7_7_position_counter_to_0);
    tcase_add_test(parameters, M7_8_forward_and_after_D_back);
    tcase_add_test(parameters, M7_9_a_loop_of_two);
    tcase_add_test(parameters, M7_10_1000_steps_forward);
    tcase_add_test(parameters, M7_11_to_absolute_position_10000_from_below);
    tcase_add_test(parameters, M7_11_to_absolute_position_10000_from_above);
    tcase_add_test(parameters, M7_12_endless_forward_until_input_5);
    tcase_add_test(parameters, M7_13_endless_back_until_input_5);
    tcase_add_test(parameters, M7_14_home);
    suite_add_tcase(suite, parameters);

    TCase *jumps = tcase_create("jumps");
    tcase_add_checked_fixture(jumps, setup, teardown);
    tcase_add_test(jumps, M7_15_input_1_at_0_goes_forward_and_over_the_other_branch);
    tcase_add_test(jumps, M7_15_input_1_at_1_goes_back);
    tcase_add_test(jumps, M7_16_a_jump_back_repeats_for_ever);
    tcase_add_test(jumps, M7_37_input_1_at_1_calls_the_subroutine_forward_first);
    tcase_add_test(jumps, M7_37_input_1_at_0_calls_the_subroutine_back_first);
    tcase_add_test(jumps, M7_38_after_the_call_the_program_waits_for_input_3);
    suite_add_tcase(suite, jumps);

    TCase *compound = tcase_create("compound");
    tcase_add_checked_fixture(compound, setup, teardown);
    tcase_add_test(compound, M7_36_the_compound_motion_takes_24_469167_s);
    tcase_add_test(compound, M7_36_its_speed_peaks_at_2500);
    suite_add_tcase(suite, compound);

    return suite;
}

int main(void)
{
    return rig_run(programs_suite(), "./test_programs");
}
