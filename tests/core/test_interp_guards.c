/* SPDX-License-Identifier: MIT */
/* test_interp_guards.c: the guards M, N, U, the total stop X and limit moves: C5, C6, R5 of the specification. */
#include <check.h>

#include "rig.h"

static struct rig rig;

static void setup(void)
{
    rig_power_up(&rig, NULL);
}

static void teardown(void)
{
    rig_free(&rig);
}

static void expect_steps(size_t steps)
{
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), steps);
}

/* A stop at constant speed, S100 V1000 A2000, t ms after the slot of R: x = 247.5 + t - 450 there, and 247.5 more down to S. */
static size_t stop_steps(uint64_t t)
{
    return (size_t)(t - 450 + 495);
}


START_TEST(C5_M_stops_a_motion_when_its_input_is_1_and_the_program_goes_on)
{
    rig_accept(&rig, '1', "M05 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 5, true);
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, stop_steps(1000), true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1454 * MS);
}
END_TEST

START_TEST(C5_N_stops_a_motion_when_its_input_is_0)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "N05 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 5, false);
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, stop_steps(1000), true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1454 * MS);
}
END_TEST

START_TEST(C5_an_input_between_two_slots_is_not_seen)
{
    rig_accept(&rig, '1', "M05 F5000 R");
    rig_input_at(&rig, 1003001, 5, true);
    rig_input_at(&rig, 1003999, 5, false);
    rig_to(&rig, 10 * SECOND);
    expect_steps(5000);
}
END_TEST

START_TEST(C5_a_guard_that_is_true_at_the_beginning_allows_no_step_and_is_used_up)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "M05 F1000 R T01 R");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 4 * MS); /* the motion takes its one slot */
    expect_steps(1000);
    ck_assert_uint_eq(recorder_step(&rig.record, 1, 1000), 5 * MS + move_ticks(100, 1000, 2000, 1000));
}
END_TEST

START_TEST(C5_both_guards_true_are_both_used_up)
{
    rig_input_at(&rig, 0, 5, true); /* and input 6 is 0 */
    rig_accept(&rig, '1', "M05 N06 F1000 R R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(1000);
}
END_TEST

START_TEST(C5_both_guards_becoming_true_in_one_slot_are_both_used_up)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', "M05 N06 F5000 R R");
    rig_to(&rig, 1004 * MS);
    rkm04_set_inputs(&rig.unit, 0x10);
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000) + 5000);
}
END_TEST

START_TEST(C5_one_guard_true_leaves_the_other_armed)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', "M05 N06 F5000 R R");
    rig_input_at(&rig, 1004 * MS, 5, true); /* M stops the first motion; the second begins in slot 1455 000 */
    rig_input_at(&rig, 2455 * MS, 6, false);
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000) * 2);
}
END_TEST

START_TEST(C5_no_guard_is_checked_during_a_stop_ramp)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', "M05 N06 F5000 R R");
    rig_input_at(&rig, 1004 * MS, 5, true);
    rig_input_at(&rig, 1104 * MS, 6, false); /* in the ramp */
    rig_input_at(&rig, 1304 * MS, 6, true);
    rig_input_at(&rig, 2455 * MS, 6, false); /* still armed in the second motion */
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000) * 2);
}
END_TEST

START_TEST(C5_a_guard_stays_armed_until_it_has_stopped_a_motion)
{
    rig_accept(&rig, '1', "M05 F1000 R R W10 F5000 R");
    uint64_t slot = slot_behind(3 * MS + move_ticks(100, 1000, 2000, 1000));
    slot = slot_behind(slot + move_ticks(100, 1000, 2000, 1000)) + 11 * MS; /* W to F, R */
    rig_input_at(&rig, slot - 2 * MS, 5, true);                             /* in the dwell: nothing to stop */
    rig_input_at(&rig, slot - 1 * MS, 5, false);
    rig_input_at(&rig, slot + 1000 * MS, 5, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(2000 + stop_steps(1000));
}
END_TEST

START_TEST(C5_a_guard_may_be_armed_again)
{
    rig_accept(&rig, '1', "M05 F5000 R M05 R T01");
    rig_input_at(&rig, 1003 * MS, 5, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000)); /* the second motion has no step: the input is still 1 */
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C5_a_new_M_replaces_the_old_one)
{
    rig_accept(&rig, '1', "M05 M06 F5000 R");
    rig_input_at(&rig, 504 * MS, 5, true);
    rig_input_at(&rig, 1004 * MS, 6, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000));
}
END_TEST

START_TEST(C5_M_and_N_may_watch_the_same_input)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "N05 F5000 R M05 R");
    rig_input_at(&rig, 1003 * MS, 5, false);
    rig_to(&rig, 1454 * MS); /* the second R is executed in slot 1455 000 */
    rig_input_at(&rig, 2455 * MS, 5, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000) * 2);
}
END_TEST

START_TEST(C5_guards_act_on_every_kind_of_motion)
{
    static const char *const text[] = {"M05 F9000 R", "M05 G9000", "M05 =9000 H", "M05 G+", "M05 G-", "M05 V1000 F3000 Y Y Y R"};
    static const uint64_t begin[] = {3, 2, 3, 2, 2, 7};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', text[i]);
        rig_input_at(&rig, (begin[i] + 1000) * MS, 5, true);
        rig_to(&rig, 20 * SECOND);
        expect_steps(stop_steps(1000));
        rig_expect_state(&rig, 1, RKM04_IDLE);
    }
}
END_TEST

/* At S from slot 2000 on: x = 49.9 in slot 501 000, x = 50 in slot 502 000. */
START_TEST(C5_a_guard_stops_a_limit_move_at_the_next_whole_step)
{
    rig_accept(&rig, '1', "M05 )06 T01");
    rig_input_at(&rig, 501 * MS, 5, true);
    rig_to(&rig, 2 * SECOND);
    expect_steps(50);
    ck_assert_uint_eq(recorder_step(&rig.record, 1, 50), 502 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 503 * MS);
}
END_TEST

START_TEST(C5_a_motion_without_steps_does_not_use_a_guard_up)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "M05 R H F1000 R");
    rig_to(&rig, 20 * SECOND);
    expect_steps(0); /* R and H had no steps to do; the guard was there for the second R */
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 30 * SECOND);
    expect_steps(1000);
}
END_TEST

START_TEST(C5_U_cancels_M_and_N)
{
    rig_accept(&rig, '1', "M05 N06 U F1000 R");
    rig_input_at(&rig, 0, 5, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(1000);
}
END_TEST

START_TEST(C5_the_guards_of_one_motor_are_not_those_of_another)
{
    rig_accept(&rig, '1', "M05 F1000 R");
    rig_accept(&rig, '2', "M06 F1000 R");
    rig_input_at(&rig, 0, 5, true);
    rig_to(&rig, 20 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(recorder_steps(&rig.record, 2), 1000);
}
END_TEST

START_TEST(C5_on_the_rising_ramp_a_stop_goes_down_from_the_speed_reached)
{
    rig_accept(&rig, '1', "M05 F5000 R");
    rig_input_at(&rig, 203 * MS, 5, true); /* 0.2 s: x = 60, v = 500 */
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 403 * MS, 120, true);
}
END_TEST

START_TEST(C5_on_the_final_ramp_the_motion_runs_to_its_own_end)
{
    rig_accept(&rig, '1', "M05 F5000 R");
    rig_input_at(&rig, 5203 * MS, 5, true);
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 1, 3 * MS, 3 * MS + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST


START_TEST(C6_X_stops_a_motion_on_a_ramp_and_ends_the_program)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, stop_steps(1000), true);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_X_ends_the_program_in_dwell_wait_and_block)
{
    static const char *const text[] = {"X04 W1000 T01", "X04 O01 T01", "X04 Z02 T01", "X04 O80 T01", "X04 [ T01"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_input_at(&rig, 0, 2, true);
        rig_accept(&rig, '1', text[i]);
        rig_input_at(&rig, 100 * MS, 4, true);
        rig_to(&rig, 100 * MS + 1);
        rig_expect_state(&rig, 1, RKM04_ENDED);
        rkm04_set_inputs(&rig.unit, 1);
        rig_accept(&rig, '1', "]");
        rig_to(&rig, 5 * SECOND);
        ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    }
}
END_TEST

START_TEST(C6_X_ends_the_program_between_commands)
{
    rig_accept(&rig, '1', "X04 U U U U T01");
    rig_input_at(&rig, 3001, 4, true); /* slot 4000 sees it before its U */
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rig_ran(&rig, 3, 1), 3 * MS);
    ck_assert_uint_eq(rig_ran(&rig, 4, 1), RKM04_NEVER);
}
END_TEST

START_TEST(C6_X_is_checked_from_the_slot_after_its_own)
{
    rig_input_at(&rig, 0, 4, true);
    rig_accept(&rig, '1', "T01 X04 T02");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

START_TEST(C6_X_in_a_stop_ramp_of_a_guard_ends_the_program_after_it)
{
    rig_accept(&rig, '1', "X04 M05 F5000 R T01");
    rig_input_at(&rig, 1004 * MS, 5, true);
    rig_input_at(&rig, 1204 * MS, 4, true);
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 4 * MS, 1454 * MS, stop_steps(1000), true);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_X_in_the_ramp_of_K_ends_the_program_after_it)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_to(&rig, 1003 * MS);
    rig_accept(&rig, '1', "K");
    rig_input_at(&rig, 1203 * MS, 4, true);
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 10 * SECOND);
    expect_steps(stop_steps(1000));
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_X_in_a_hold_ends_the_program)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_accept_at(&rig, 1003 * MS, "K");
    rig_input_at(&rig, 3 * SECOND, 4, true);
    rig_accept_at(&rig, 4 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    expect_steps(stop_steps(1000));
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

START_TEST(C6_K_and_X_in_one_slot_end_the_program)
{
    rig_accept(&rig, '1', "X04 W1000 T01");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_to(&rig, 200 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

START_TEST(C6_X_wins_over_M_and_N)
{
    rig_accept(&rig, '1', "X04 M05 N06 F5000 R T01");
    rig_input_at(&rig, 0, 6, true);
    rig_to(&rig, 1005 * MS);
    rkm04_set_inputs(&rig.unit, 0x18); /* 4 and 5 at 1, 6 at 0 */
    rig_to(&rig, 10 * SECOND);
    expect_steps(stop_steps(1000));
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_U_does_not_cancel_X)
{
    rig_accept(&rig, '1', "X04 U W1000 T01");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_to(&rig, 2 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_X_of_an_idle_motor_stays_armed)
{
    rig_accept(&rig, '1', "X04");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_input_at(&rig, 200 * MS, 4, false);
    rig_to(&rig, 300 * MS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
    rig_accept(&rig, '1', "T01 W1000 T02"); /* not fired: this runs */
    rig_input_at(&rig, 400 * MS, 4, true);  /* still armed: this ends it */
    rig_to(&rig, 3 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

START_TEST(C6_X_fires_before_the_first_command_for_an_idle_motor)
{
    rig_accept(&rig, '1', "X04");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_accept_at(&rig, 200 * MS, "T01");
    rig_to(&rig, 300 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C6_X_last_in_the_text_with_its_input_at_1_leaves_the_motor_idle)
{
    rig_input_at(&rig, 0, 4, true);
    rig_accept(&rig, '1', "X04");
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C6_X_stays_armed_and_ends_new_commands_while_its_input_is_1)
{
    rig_accept(&rig, '1', "X04 W1000");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_accept_at(&rig, 200 * MS, "T01 F1000 R");
    rig_to(&rig, 1 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    rig_input_at(&rig, 1 * SECOND, 4, false);
    rig_accept(&rig, '1', "T02 F1000 R T03");
    rig_input_at(&rig, 2 * SECOND, 4, true);
    rig_to(&rig, 5 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C6_X_ends_what_arrives_on_its_ramp_while_its_input_is_1)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_accept_at(&rig, 1100 * MS, "T02");
    rig_input_at(&rig, 1200 * MS, 4, false);
    rig_to(&rig, 5 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(U6_X_and_C75_in_one_slot_leave_the_LED_off)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_accept_at(&rig, 1001 * MS, "K");
    rig_to(&rig, 3 * SECOND + 1);
    size_t records = rig.record.count;
    rig_accept(&rig, '1', "C75");
    rig_input_at(&rig, 3 * SECOND + 2, 4, true);
    rig_to(&rig, 4 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rig.record.count, records + 1); /* no command any more; no motion, no LED */
}
END_TEST

START_TEST(C5_a_held_limit_move_whose_input_is_1_takes_its_one_slot)
{
    rig_accept(&rig, '1', ")05 T01");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_input_at(&rig, 500 * MS, 5, true);
    rig_accept_at(&rig, 1 * SECOND, "C75");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1 * SECOND + 1 * MS);
}
END_TEST


START_TEST(C6_a_limit_move_stops_at_its_input_without_another_pulse)
{
    for (uint64_t slot = 490; slot <= 510; slot++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', "(05 T01"); /* pulse k at 1000 + 10 000 k */
        rig_input_at(&rig, slot * MS, 5, true);
        rig_to(&rig, 1 * SECOND);
        expect_steps((size_t)((slot - 1) / 10));
        ck_assert_int_eq(rig_motor(&rig, 1).position, -(int32_t)((slot - 1) / 10));
        uint64_t next = rig_outputs_became(&rig, 1, 1);
        ck_assert_uint_ge(next, slot * MS);
        ck_assert_uint_le(next, (slot + 1) * MS);
    }
}
END_TEST

START_TEST(C6_a_limit_move_whose_input_is_there_already_takes_no_step)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', ")05 (05 T01");
    rig_to(&rig, 1 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 3 * MS);
}
END_TEST

START_TEST(R5_the_input_of_a_limit_move_ends_it_on_the_way_to_the_last_step_of_a_stop)
{
    rig_accept(&rig, '1', "S1 )06 T01"); /* a step a second */
    rig_accept_at(&rig, 100 * MS, "K");
    rig_input_at(&rig, 500 * MS, 6, true);
    rig_input_at(&rig, 550 * MS, 6, false);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept_at(&rig, 600 * MS, "C75");
    rig_to(&rig, 5 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 600 * MS); /* nothing is left of the move */
}
END_TEST

START_TEST(R5_a_guard_and_the_input_of_a_limit_move_in_one_slot_end_it_without_another_pulse)
{
    rig_accept(&rig, '1', "S1 M06 )06 T01");
    rig_input_at(&rig, 500 * MS, 6, true);
    rig_to(&rig, 5 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 500 * MS);
}
END_TEST

START_TEST(R5_X_stops_a_limit_move_at_the_next_whole_step)
{
    rig_accept(&rig, '1', "X04 )06 T01");
    rig_input_at(&rig, 501 * MS, 4, true);
    rig_to(&rig, 2 * SECOND);
    expect_steps(50);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

static Suite *interp_guards_suite(void)
{
    Suite *suite = suite_create("interp_guards");

    TCase *guards = tcase_create("guards");
    tcase_add_checked_fixture(guards, setup, teardown);
    tcase_add_test(guards, C5_M_stops_a_motion_when_its_input_is_1_and_the_program_goes_on);
    tcase_add_test(guards, C5_N_stops_a_motion_when_its_input_is_0);
    tcase_add_test(guards, C5_an_input_between_two_slots_is_not_seen);
    tcase_add_test(guards, C5_a_guard_that_is_true_at_the_beginning_allows_no_step_and_is_used_up);
    tcase_add_test(guards, C5_both_guards_true_are_both_used_up);
    tcase_add_test(guards, C5_both_guards_becoming_true_in_one_slot_are_both_used_up);
    tcase_add_test(guards, C5_one_guard_true_leaves_the_other_armed);
    tcase_add_test(guards, C5_no_guard_is_checked_during_a_stop_ramp);
    tcase_add_test(guards, C5_a_guard_stays_armed_until_it_has_stopped_a_motion);
    tcase_add_test(guards, C5_a_guard_may_be_armed_again);
    tcase_add_test(guards, C5_a_new_M_replaces_the_old_one);
    tcase_add_test(guards, C5_M_and_N_may_watch_the_same_input);
    tcase_add_test(guards, C5_guards_act_on_every_kind_of_motion);
    tcase_add_test(guards, C5_a_guard_stops_a_limit_move_at_the_next_whole_step);
    tcase_add_test(guards, C5_a_motion_without_steps_does_not_use_a_guard_up);
    tcase_add_test(guards, C5_U_cancels_M_and_N);
    tcase_add_test(guards, C5_the_guards_of_one_motor_are_not_those_of_another);
    tcase_add_test(guards, C5_on_the_rising_ramp_a_stop_goes_down_from_the_speed_reached);
    tcase_add_test(guards, C5_on_the_final_ramp_the_motion_runs_to_its_own_end);
    suite_add_tcase(suite, guards);

    TCase *total_stop = tcase_create("total_stop");
    tcase_add_checked_fixture(total_stop, setup, teardown);
    tcase_add_test(total_stop, C6_X_stops_a_motion_on_a_ramp_and_ends_the_program);
    tcase_add_test(total_stop, C6_X_ends_the_program_in_dwell_wait_and_block);
    tcase_add_test(total_stop, C6_X_ends_the_program_between_commands);
    tcase_add_test(total_stop, C6_X_is_checked_from_the_slot_after_its_own);
    tcase_add_test(total_stop, C6_X_in_a_stop_ramp_of_a_guard_ends_the_program_after_it);
    tcase_add_test(total_stop, C6_X_in_the_ramp_of_K_ends_the_program_after_it);
    tcase_add_test(total_stop, C6_X_in_a_hold_ends_the_program);
    tcase_add_test(total_stop, C6_K_and_X_in_one_slot_end_the_program);
    tcase_add_test(total_stop, C6_X_wins_over_M_and_N);
    tcase_add_test(total_stop, C6_U_does_not_cancel_X);
    tcase_add_test(total_stop, C6_X_of_an_idle_motor_stays_armed);
    tcase_add_test(total_stop, C6_X_fires_before_the_first_command_for_an_idle_motor);
    tcase_add_test(total_stop, C6_X_last_in_the_text_with_its_input_at_1_leaves_the_motor_idle);
    tcase_add_test(total_stop, C6_X_stays_armed_and_ends_new_commands_while_its_input_is_1);
    tcase_add_test(total_stop, C6_X_ends_what_arrives_on_its_ramp_while_its_input_is_1);
    tcase_add_test(total_stop, U6_X_and_C75_in_one_slot_leave_the_LED_off);
    suite_add_tcase(suite, total_stop);

    TCase *limit_moves = tcase_create("limit_moves");
    tcase_add_checked_fixture(limit_moves, setup, teardown);
    tcase_add_test(limit_moves, C6_a_limit_move_stops_at_its_input_without_another_pulse);
    tcase_add_test(limit_moves, C6_a_limit_move_whose_input_is_there_already_takes_no_step);
    tcase_add_test(limit_moves, C5_a_held_limit_move_whose_input_is_1_takes_its_one_slot);
    tcase_add_test(limit_moves, R5_X_stops_a_limit_move_at_the_next_whole_step);
    tcase_add_test(limit_moves, R5_the_input_of_a_limit_move_ends_it_on_the_way_to_the_last_step_of_a_stop);
    tcase_add_test(limit_moves, R5_a_guard_and_the_input_of_a_limit_move_in_one_slot_end_it_without_another_pulse);
    suite_add_tcase(suite, limit_moves);

    return suite;
}

int main(void)
{
    return rig_run(interp_guards_suite(), "./test_interp_guards");
}
