/* SPDX-License-Identifier: MIT */
/* test_programs_stops.c: the example programs of the manual's section 7 that stop, wait, guard or limit, run as printed; where
 * print, prose and figure differ, section 7 of the specification says what counts. Times: see test_programs.c. */
#include <check.h>
#include <string.h>

#include "manual_rig.h"

START_TEST(M7_17_K_stops_on_a_ramp_and_C75_does_the_rest)
{
    rig_accept(&rig, '1', "S100 V1000 A2000 F5000 R");
    rig_accept_at(&rig, 1005 * MS, "K"); /* x = 247.5 + 550 = 797.5, and 247.5 more in 0.45 s */
    rig_accept_at(&rig, 4 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, ++seen, 5 * MS, 1455 * MS, 1045, true);
    moved(4 * SECOND, 1000, 5000 - 1045, true);
    expect_rest(5000);
}
END_TEST

START_TEST(M7_17_K_and_C75_in_a_block_are_ignored)
{
    rig_accept(&rig, '1', "S100 V1000 A2000 F5000 R K C75 F1");
    rig_accept_at(&rig, 1005 * MS, "K U");
    rig_to(&rig, 20 * SECOND);
    moved(5 * MS, 1000, 5000, true);
    ck_assert_str_eq(rig_program(&rig, 1), "S100 V1000 A2000 F5000 R F1 U");
    expect_rest(5000);
}
END_TEST

/* R in slot 5000. After 0.5 s x = 297.5, the stop takes 247.5 steps and 0.45 s. */
static void guarded(const char *text, bool resting, bool reacting)
{
    rig_input_at(&rig, 0, 5, resting);
    rig_accept(&rig, '1', text);
    if (reacting)
        rig_input_at(&rig, 505 * MS, 5, !resting);
    rig_to(&rig, 5 * SECOND);
    uint64_t slot;
    if (reacting) {
        rig_expect_motion_near(&rig, 1, ++seen, 5 * MS, 955 * MS, 545, true);
        slot = slot_behind(955 * MS);
    } else {
        slot = moved(5 * MS, 1000, 1000, true);
    }
    ck_assert_uint_eq(rig_ran(&rig, 6, 1), slot);
    expect_rest(reacting ? 545 : 1000);
}

START_TEST(M7_19_input_5_stays_false_and_the_whole_motion_is_done)
{
    guarded("S100 A2000 F1000\nM05 R B200", false, false);
}
END_TEST

START_TEST(M7_19_input_5_becomes_true_and_ends_the_motion_on_a_ramp)
{
    guarded("S100 A2000 F1000\nM05 R B200", false, true);
}
END_TEST

START_TEST(M7_20_input_5_stays_true_and_the_whole_motion_is_done)
{
    guarded("S100 A2000 F1000\nN05 R B200", true, false);
}
END_TEST

START_TEST(M7_20_input_5_becomes_false_and_ends_the_motion_on_a_ramp)
{
    guarded("S100 A2000 F1000\nN05 R B200", true, true);
}
END_TEST

START_TEST(M7_21_U_takes_the_guard_away)
{
    guarded("S100 A2000 F1000\nN05 R U", true, false);
    rig_input_at(&rig, 5 * SECOND, 5, false);
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 10 * SECOND);
    moved(5 * SECOND, 1000, 1000, true);
    expect_rest(2000);
}
END_TEST

START_TEST(M7_21_U_after_the_stop)
{
    guarded("S100 A2000 F1000\nN05 R U", true, true);
}
END_TEST

/* A1000, whatever the prose says: T = 1.81 s. */
START_TEST(M7_22_and_M7_30_run_with_acceleration_1000)
{
    rig_accept(&rig, '1', "S100 A1000 F1000\nL2 R W200 E\nB300");
    rig_to(&rig, 6 * SECOND);
    uint64_t slot = 5 * MS;
    for (size_t pass = 1; pass <= 2; pass++) {
        uint64_t end = slot + move_ticks(100, 1000, 1000, 1000);
        ck_assert_uint_eq(end, slot + 1810 * MS);
        rig_expect_motion(&rig, 1, pass, slot, end, 1000, true);
        slot = slot_behind(end) + 201 * MS;
    }
    seen = 2;
    ck_assert_uint_eq(rig_ran(&rig, 8, 1), slot);
    expect_rest(2000);
}
END_TEST

START_TEST(M7_23_waits_for_input_3_true)
{
    rig_accept(&rig, '1', "O03");
    rig_accept(&rig, '1', "T01");
    rig_input_at(&rig, 500 * MS + 1, 3, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 502 * MS);
}
END_TEST

START_TEST(M7_24_a_motion_and_home_again)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\nR H");
    rig_to(&rig, 5 * SECOND);
    moved(moved(4 * MS, 1000, 1000, true), 1000, 1000, false);
    expect_rest(0);
}
END_TEST

START_TEST(M7_25_start_speed_100)
{
    rig_accept(&rig, '1', "S500 F1000");
    rig_accept(&rig, '1', "S100");
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 5 * SECOND);
    moved(4 * MS, 1000, 1000, true);
    expect_rest(1000);
}
END_TEST

START_TEST(M7_26_output_06_on)
{
    rig_accept(&rig, '1', "T06");
    rig_to(&rig, 5 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x20, 1), 1 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x20);
}
END_TEST

START_TEST(M7_27_variable_86_on)
{
    rig_accept(&rig, '1', "T86");
    rig_to(&rig, 1 * MS);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0);
    rig_to(&rig, 1 * MS + 1);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 0x40);
}
END_TEST

START_TEST(M7_28_maximum_speed_3000)
{
    rig_accept(&rig, '1', "V3000");
    rig_accept(&rig, '1', "F20000 R");
    rig_to(&rig, 20 * SECOND);
    moved(3 * MS, 3000, 20000, true);
    expect_rest(20000);
}
END_TEST

START_TEST(M7_29_6000_during_a_motion_holds_for_this_motion_only)
{
    rig_accept(&rig, '1', "V3000 F50000 R F20000 R");
    rig_accept_at(&rig, 3 * SECOND, "V6000");
    rig_to(&rig, 6 * SECOND); /* from 3000 to 6000 at 2000 steps/s^2 in 1.5 s */
    ck_assert_uint_eq(rig_motor(&rig, 1).speed, 6000);
    rig_to(&rig, 60 * SECOND);
    const struct record *end = recorder_event(&rig.record, 1, RKM04_EVENT_MOTION, 0, 1);
    ck_assert_ptr_nonnull(end);
    rig_expect_motion(&rig, 1, ++seen, 3 * MS, end->tick, 50000, true);
    moved(slot_behind(end->tick) + 1 * MS, 3000, 20000, true);
    ck_assert_str_eq(rig_program(&rig, 1), "V3000 F50000 R F20000 R");
    expect_rest(70000);
}
END_TEST

START_TEST(M7_31_input_5_stays_false_and_the_program_goes_to_its_end)
{
    guarded("S100 A2000 F1000\nX05 R B300", false, false);
}
END_TEST

START_TEST(M7_31_input_5_becomes_true_and_ends_motion_and_program)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\nX05 R B300");
    rig_input_at(&rig, 505 * MS, 5, true);
    rig_to(&rig, 5 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 5 * MS, 955 * MS, 545, true);
    ck_assert_uint_eq(rig_ran(&rig, 6, 1), RKM04_NEVER);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_ENDED);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 545);
}
END_TEST

START_TEST(M7_32_waits_for_input_3_false)
{
    rig_input_at(&rig, 0, 3, true);
    rig_accept(&rig, '1', "Z03");
    rig_accept(&rig, '1', "T01");
    rig_input_at(&rig, 500 * MS, 3, false);
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 501 * MS);
}
END_TEST

/* At S from slot 4000 on: pulse k at 4000 + 10 000 k; the 99th comes before 1 000 000, the 100th never. */
static void limit_move(const char *text, bool forward)
{
    rig_accept(&rig, '1', text);
    rig_input_at(&rig, 1 * SECOND, 5, true);
    rig_to(&rig, 3 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 99);
    for (uint64_t k = 1; k <= 99; k++)
        ck_assert_uint_eq(recorder_step(&rig.record, 1, (size_t)k), 4 * MS + 10 * MS * k);
    ck_assert_int_eq(rig_motor(&rig, 1).position, forward ? 99 : -99);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}

START_TEST(M7_33_forward_to_the_limit_switch)
{
    limit_move("S100 A2000 F1000\n)05", true);
}
END_TEST

START_TEST(M7_34_back_to_the_limit_switch)
{
    limit_move("S100 A2000 F1000\n(05", false);
}
END_TEST

START_TEST(M7_35_the_counter_is_5000)
{
    rig_accept(&rig, '1', "=5000");
    rig_to(&rig, 10 * MS);
    expect_rest(5000);
}
END_TEST

START_TEST(M7_39_the_program_waits_for_its_end)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\n[ X05 R B300");
    rig_to(&rig, 100 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_BLOCK);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 4);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 0);
}
END_TEST

START_TEST(M7_40_the_program_runs_when_its_end_arrives)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\n[ X05 R B300");
    rig_accept_at(&rig, 10 * SECOND, "]"); /* [ passes in this slot, X is next, then R */
    rig_to(&rig, 20 * SECOND);
    moved(10 * SECOND + 2 * MS, 1000, 1000, true);
    expect_rest(1000);
}
END_TEST

START_TEST(M7_40_the_program_with_its_end_runs_at_once)
{
    rig_accept(&rig, '1', "S100 A2000 F1000\n[ X05 R B300 ]");
    rig_to(&rig, 5 * SECOND);
    moved(6 * MS, 1000, 1000, true); /* S A F [ X R */
    expect_rest(1000);
}
END_TEST

static Suite *programs_stops_suite(void)
{
    Suite *suite = suite_create("programs_stops");

    TCase *stops = tcase_create("stops");
    tcase_add_checked_fixture(stops, setup, teardown);
    tcase_add_test(stops, M7_17_K_stops_on_a_ramp_and_C75_does_the_rest);
    tcase_add_test(stops, M7_17_K_and_C75_in_a_block_are_ignored);
    tcase_add_test(stops, M7_19_input_5_stays_false_and_the_whole_motion_is_done);
    tcase_add_test(stops, M7_19_input_5_becomes_true_and_ends_the_motion_on_a_ramp);
    tcase_add_test(stops, M7_20_input_5_stays_true_and_the_whole_motion_is_done);
    tcase_add_test(stops, M7_20_input_5_becomes_false_and_ends_the_motion_on_a_ramp);
    tcase_add_test(stops, M7_21_U_takes_the_guard_away);
    tcase_add_test(stops, M7_21_U_after_the_stop);
    tcase_add_test(stops, M7_22_and_M7_30_run_with_acceleration_1000);
    tcase_add_test(stops, M7_23_waits_for_input_3_true);
    tcase_add_test(stops, M7_24_a_motion_and_home_again);
    tcase_add_test(stops, M7_25_start_speed_100);
    tcase_add_test(stops, M7_26_output_06_on);
    tcase_add_test(stops, M7_27_variable_86_on);
    tcase_add_test(stops, M7_28_maximum_speed_3000);
    tcase_add_test(stops, M7_29_6000_during_a_motion_holds_for_this_motion_only);
    tcase_add_test(stops, M7_31_input_5_stays_false_and_the_program_goes_to_its_end);
    tcase_add_test(stops, M7_31_input_5_becomes_true_and_ends_motion_and_program);
    tcase_add_test(stops, M7_32_waits_for_input_3_false);
    tcase_add_test(stops, M7_33_forward_to_the_limit_switch);
    tcase_add_test(stops, M7_34_back_to_the_limit_switch);
    tcase_add_test(stops, M7_35_the_counter_is_5000);
    tcase_add_test(stops, M7_39_the_program_waits_for_its_end);
    tcase_add_test(stops, M7_40_the_program_runs_when_its_end_arrives);
    tcase_add_test(stops, M7_40_the_program_with_its_end_runs_at_once);
    suite_add_tcase(suite, stops);

    return suite;
}

int main(void)
{
    return rig_run(programs_stops_suite(), "./test_programs_stops");
}
