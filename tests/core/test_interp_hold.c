/* SPDX-License-Identifier: MIT */
/* test_interp_hold.c: K and C75, C3 of the specification. */
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

/* The command after T01 at the latest one slot after `slot`. */
static void expect_output_about(uint64_t slot)
{
    uint64_t tick = rig_outputs_became(&rig, 1, 1);
    ck_assert_msg(tick == slot || tick == slot + 1 * MS, "T01 at %llu, not in or one slot after %llu", (unsigned long long)tick,
                  (unsigned long long)slot);
}

/* "F5000 R T01" at tick 0: R in slot 2000. K one second later finds x = 247.5 + 550 = 797.5; 247.5 steps and 0.45 s down to S. */
#define HELD_STEPS 1045
#define HELD_AT (1452 * MS)

static void hold_in_motion(const char *text)
{
    rig_accept(&rig, '1', text);
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_to(&rig, 2 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, HELD_AT, HELD_STEPS, true);
    rig_expect_state(&rig, 1, RKM04_HELD);
}


START_TEST(C3_blanks_and_comments_may_be_around_a_lone_K_and_C75)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1002 * MS, " \r\n{ stop } K { now }\n");
    rig_to(&rig, 2 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "{ on }\tC75 ");
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_MOVING);
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R");
}
END_TEST

START_TEST(C3_inside_a_longer_text_both_are_accepted_ignored_and_not_stored)
{
    rig_accept(&rig, '1', "F1000 K R C75");
    rig_accept_at(&rig, 500 * MS, "K K");
    rig_accept_at(&rig, 510 * MS, "K C75");
    rig_accept_at(&rig, 520 * MS, "T01 K");
    ck_assert_str_eq(rig_program(&rig, 1), "F1000 R T01");
    rig_to(&rig, 5 * SECOND);
    rig_expect_motion(&rig, 1, 1, 2 * MS, 2 * MS + move_ticks(100, 1000, 2000, 1000), 1000, true);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C3_K_of_an_idle_motor_is_nothing)
{
    rig_accept(&rig, '1', "K");
    rig_accept_at(&rig, 10 * MS, "F1000 R");
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 1000);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 4 * SECOND);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_K_after_a_total_stop_and_at_a_fault_is_nothing)
{
    rig_input_at(&rig, 0, 4, true);
    rig_accept(&rig, '1', "X04 U");
    rig_accept_at(&rig, 10 * MS, "K");
    rig_to(&rig, 20 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    rig_input_at(&rig, 20 * MS, 4, false);
    rig_accept(&rig, '1', "E");
    rig_accept_at(&rig, 30 * MS, "K");
    rig_to(&rig, 40 * MS);
    rig_expect_state(&rig, 1, RKM04_FAULTY);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_LOOP);
}
END_TEST

START_TEST(C3_a_second_K_in_a_hold_is_nothing)
{
    hold_in_motion("F5000 R T01");
    rig_accept(&rig, '1', "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 10 * SECOND);
    uint64_t end = 3 * SECOND + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS);
    rig_expect_motion(&rig, 1, 2, 3 * SECOND, end, 5000 - HELD_STEPS, true);
}
END_TEST

START_TEST(C3_C75_without_a_hold_is_nothing)
{
    rig_accept(&rig, '1', "C75");
    rig_accept_at(&rig, 5 * MS, "F1000 R W100 T01");
    rig_accept_at(&rig, 500 * MS, "C75"); /* in the motion */
    uint64_t end = 6 * MS + move_ticks(100, 1000, 2000, 1000);
    rig_accept_at(&rig, end + 50 * MS, "C75"); /* in the dwell */
    rig_to(&rig, 3 * SECOND);
    rig_expect_motion(&rig, 1, 1, 6 * MS, end, 1000, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), slot_behind(end) + 100 * MS);
    ck_assert_str_eq(rig_program(&rig, 1), "F1000 R W100 T01");
}
END_TEST


START_TEST(C3_between_commands_K_holds_before_the_next_one)
{
    rig_accept(&rig, '1', "U U T01 U");
    rig_accept_at(&rig, 2001, "K");
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept_at(&rig, 100 * MS + 1, "C75");
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
}
END_TEST

START_TEST(C3_in_a_wait_K_holds_there)
{
    rig_accept(&rig, '1', "O03 T01");
    rig_accept_at(&rig, 50 * MS, "K");
    rig_input_at(&rig, 60 * MS, 3, true);
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 1);
    rig_accept(&rig, '1', "C75"); /* the wait is checked in this slot */
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
}
END_TEST

START_TEST(C3_a_wait_goes_on_waiting_after_a_hold)
{
    rig_accept(&rig, '1', "O03 T01");
    rig_accept_at(&rig, 50 * MS, "K");
    rig_accept_at(&rig, 60 * MS, "C75");
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_WAIT);
    rig_input_at(&rig, 100 * MS, 3, true);
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
}
END_TEST

START_TEST(C3_an_open_block_goes_on_waiting_after_a_hold)
{
    rig_accept(&rig, '1', "[ T01");
    rig_accept_at(&rig, 50 * MS, "K");
    rig_to(&rig, 60 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_BLOCK);
    rig_accept(&rig, '1', "]");
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
}
END_TEST

/* W in slot 1000, T01 would come in slot 101 000; held in slot 31 000, 70 slots are left. */
START_TEST(C3_in_a_dwell_the_remaining_slots_are_kept)
{
    rig_accept(&rig, '1', "W100 T01");
    rig_accept_at(&rig, 31 * MS, "K");
    rig_to(&rig, 500 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 570 * MS);
}
END_TEST

START_TEST(C3_a_dwell_may_be_held_several_times)
{
    rig_accept(&rig, '1', "W100 T01");
    rig_accept_at(&rig, 31 * MS, "K"); /* 70 left */
    rig_accept_at(&rig, 500 * MS, "C75");
    rig_accept_at(&rig, 569 * MS, "K"); /* 1 left */
    rig_accept_at(&rig, 600 * MS, "C75");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 601 * MS);
}
END_TEST

START_TEST(C3_in_a_motion_K_stops_on_a_ramp_and_C75_does_the_rest_from_S)
{
    hold_in_motion("F5000 R T01");
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_OFF);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept_at(&rig, 5 * SECOND + 1, "C75");
    rig_to(&rig, 20 * SECOND);
    uint64_t begin = 5 * SECOND + 1 * MS, end = begin + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS);
    rig_expect_motion(&rig, 1, 2, begin, end, 5000 - HELD_STEPS, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), slot_behind(end));
    ck_assert_int_eq(rig_motor(&rig, 1).position, 5000);
}
END_TEST

START_TEST(C3_a_motion_held_many_times_has_exactly_its_steps)
{
    rig_accept(&rig, '1', "B5000 R T01");
    for (uint64_t tick = 100500; tick < 20 * SECOND; tick += 777777) {
        rig_accept_at(&rig, tick, "K");
        rig_accept_at(&rig, tick + 600000, "C75");
    }
    rig_to(&rig, 40 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 5000);
    ck_assert_int_eq(rig_motor(&rig, 1).position, -5000);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    ck_assert_uint_gt(rig_motions(&rig, 1), 5);
}
END_TEST

/* 0.2 s of rising: x = 60, v = 500, and the same way down. */
START_TEST(C3_K_on_the_rising_ramp)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 202 * MS, "K");
    rig_to(&rig, 2 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, 402 * MS, 120, true);
}
END_TEST

/* T = 5.405 s, the final ramp begins 0.45 s before. */
START_TEST(C3_on_the_final_ramp_the_motion_runs_to_its_own_end_and_is_held_with_no_rest)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 5202 * MS, "K");
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion(&rig, 1, 1, 2 * MS, 5407 * MS, 5000, true);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 11 * SECOND);
    expect_output_about(10 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 5000);
}
END_TEST

/* M stops in slot 1003 (R in slot 3000): 1045 steps, 0.45 s. */
START_TEST(C3_in_a_stop_ramp_of_a_guard_the_hold_falls_after_the_motion)
{
    rig_accept(&rig, '1', "M05 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 5, true);
    rig_accept_at(&rig, 1203 * MS, "K");
    rig_to(&rig, 5 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, HELD_STEPS, true);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), HELD_STEPS); /* no rest */
    expect_output_about(5 * SECOND);
}
END_TEST

/* V and S are both 100: no ramp, the next whole step is the last. */
START_TEST(C3_K_stops_a_limit_move_at_the_next_step_and_C75_goes_on_with_it)
{
    rig_accept(&rig, '1', ")05 T01");
    rig_accept_at(&rig, 500 * MS, "K"); /* x = 49.9 */
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 50);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 1500 * MS + 1);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 100);
    rig_input_at(&rig, 1500 * MS + 1, 5, true);
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C3_an_endless_motion_goes_on_endlessly_after_a_hold)
{
    rig_accept(&rig, '1', "G-");
    rig_accept_at(&rig, 1001 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 100 * SECOND + 1);
    /* the constant part again after 0.45 s and 247.5 steps: x = 247.5 + (97 - 0.45) 1000 */
    ck_assert_int_eq(rig_motor(&rig, 1).position, -(1045 + 96797));
}
END_TEST


START_TEST(C3_C75_during_the_ramp_is_remembered)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, HELD_AT, HELD_STEPS, true);
    uint64_t begin = slot_behind(HELD_AT), end = begin + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS);
    rig_expect_motion(&rig, 1, 2, begin, end, 5000 - HELD_STEPS, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), slot_behind(end));
}
END_TEST

START_TEST(C3_a_K_after_it_cancels_the_remembered_C75)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "C75");
    rig_accept_at(&rig, 1302 * MS, "K");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    rig_expect_state(&rig, 1, RKM04_HELD);
}
END_TEST

START_TEST(C3_a_second_K_during_the_ramp_leaves_the_rest_to_be_done)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    uint64_t end = 3 * SECOND + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS);
    rig_expect_motion(&rig, 1, 2, 3 * SECOND, end, 5000 - HELD_STEPS, true);
}
END_TEST

START_TEST(C6_K_during_the_ramp_of_X_holds_nothing)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_accept_at(&rig, 1203 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 4 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C3_K_and_C75_in_one_slot_act_in_order_of_arrival)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1001 * MS + 1, "K");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 2);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, HELD_AT, HELD_STEPS, true);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 5000);

    rig_power_up(&rig, NULL);
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1001 * MS + 1, "C75");
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 20 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
}
END_TEST

START_TEST(C3_any_number_of_requests_in_one_slot_keep_their_meaning)
{
    for (unsigned last_is_K = 0; last_is_K < 2; last_is_K++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', "U U T01");
        rig_to(&rig, 2001);
        for (int i = 0; i < 10; i++) {
            rig_accept(&rig, '1', "K");
            rig_accept(&rig, '1', i % 3 ? "C75" : "K");
        }
        rig_accept(&rig, '1', last_is_K ? "K" : "C75");
        rig_to(&rig, 10 * MS);
        if (last_is_K)
            rig_expect_state(&rig, 1, RKM04_HELD);
        else
            ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 3 * MS);
    }
}
END_TEST

START_TEST(C3_C75_K_C75_in_one_slot_stop_a_motion_and_let_it_go_on)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1001 * MS + 1, "C75");
    rig_accept(&rig, '1', "K");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, HELD_AT, HELD_STEPS, true);
    uint64_t begin = slot_behind(HELD_AT), end = begin + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS);
    rig_expect_motion(&rig, 1, 2, begin, end, 5000 - HELD_STEPS, true);
}
END_TEST

START_TEST(C3_C4_a_change_of_speed_between_K_C75_and_a_second_K_is_dropped_by_it)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1001 * MS + 1, "K");
    rig_accept(&rig, '1', "C75");
    rig_accept(&rig, '1', "V300");
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, HELD_AT, HELD_STEPS, true);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 2, 3 * SECOND, 3 * SECOND + move_ticks(100, 1000, 2000, 5000 - HELD_STEPS), 5000 - HELD_STEPS,
                      true);
}
END_TEST

START_TEST(C3_K_after_C75_in_the_slot_after_the_last_command_holds_nothing)
{
    rig_accept(&rig, '1', "T01");
    rig_accept_at(&rig, 1 * MS + 500, "C75");
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 10 * MS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 12 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 3);
}
END_TEST

/* "F5000 R" with a guard that stops it at 1002 ms; K comes 100 ms later. */
static void hold_in_the_ramp_of_a_guard(const char *text)
{
    rig_accept(&rig, '1', text);
    rig_input_at(&rig, 1003 * MS, 1, true);
    rig_accept_at(&rig, 1103 * MS, "K");
}

START_TEST(C3_C75_during_the_ramp_of_a_guard_is_remembered_for_the_hold_after_it)
{
    hold_in_the_ramp_of_a_guard("M01 F5000 R T01");
    rig_accept_at(&rig, 1203 * MS, "C75");
    rig_to(&rig, 1300 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_to(&rig, 3 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_int_eq(rig_motor(&rig, 1).position, HELD_STEPS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(P9_held_after_the_last_command_the_index_stays_at_it)
{
    hold_in_the_ramp_of_a_guard("M01 F5000 R");
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 3);
    rig_accept(&rig, '1', "T01"); /* new commands end the hold */
    rig_to(&rig, 3 * SECOND + 5 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C5_a_guard_that_has_become_true_in_a_hold_lets_the_rest_do_no_step)
{
    rig_accept(&rig, '1', "M01 F5000 R T01 F10 R");
    rig_accept_at(&rig, 1003 * MS, "K");
    rig_input_at(&rig, 2 * SECOND, 1, true);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 3 * SECOND + 2 * MS);
    expect_output_about(3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, HELD_STEPS);
    rig_to(&rig, 5 * SECOND); /* the guard is used up: it does not stop the next motion */
    ck_assert_int_eq(rig_motor(&rig, 1).position, HELD_STEPS + 10);
}
END_TEST

START_TEST(R5_a_held_limit_move_whose_input_came_meanwhile_does_no_further_step)
{
    rig_accept(&rig, '1', ")03 T01");
    rig_accept_at(&rig, 500 * MS, "K");
    rig_to(&rig, 1 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    int32_t position = rig_motor(&rig, 1).position;
    rig_input_at(&rig, 1 * SECOND, 3, true);
    rig_accept_at(&rig, 2 * SECOND, "C75");
    rig_to(&rig, 3 * SECOND);
    expect_output_about(2 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, position);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

static Suite *interp_hold_suite(void)
{
    Suite *suite = suite_create("interp_hold");

    TCase *alone = tcase_create("alone");
    tcase_add_checked_fixture(alone, setup, teardown);
    tcase_add_test(alone, C3_blanks_and_comments_may_be_around_a_lone_K_and_C75);
    tcase_add_test(alone, C3_inside_a_longer_text_both_are_accepted_ignored_and_not_stored);
    tcase_add_test(alone, C3_K_of_an_idle_motor_is_nothing);
    tcase_add_test(alone, C3_K_after_a_total_stop_and_at_a_fault_is_nothing);
    tcase_add_test(alone, C3_a_second_K_in_a_hold_is_nothing);
    tcase_add_test(alone, C3_C75_without_a_hold_is_nothing);
    suite_add_tcase(suite, alone);

    TCase *by_state = tcase_create("by_state");
    tcase_add_checked_fixture(by_state, setup, teardown);
    tcase_add_test(by_state, C3_between_commands_K_holds_before_the_next_one);
    tcase_add_test(by_state, C3_in_a_wait_K_holds_there);
    tcase_add_test(by_state, C3_a_wait_goes_on_waiting_after_a_hold);
    tcase_add_test(by_state, C3_an_open_block_goes_on_waiting_after_a_hold);
    tcase_add_test(by_state, C3_in_a_dwell_the_remaining_slots_are_kept);
    tcase_add_test(by_state, C3_a_dwell_may_be_held_several_times);
    tcase_add_test(by_state, C3_in_a_motion_K_stops_on_a_ramp_and_C75_does_the_rest_from_S);
    tcase_add_test(by_state, C3_a_motion_held_many_times_has_exactly_its_steps);
    tcase_add_test(by_state, C3_K_on_the_rising_ramp);
    tcase_add_test(by_state, C3_on_the_final_ramp_the_motion_runs_to_its_own_end_and_is_held_with_no_rest);
    tcase_add_test(by_state, C3_in_a_stop_ramp_of_a_guard_the_hold_falls_after_the_motion);
    tcase_add_test(by_state, C3_K_stops_a_limit_move_at_the_next_step_and_C75_goes_on_with_it);
    tcase_add_test(by_state, C3_an_endless_motion_goes_on_endlessly_after_a_hold);
    tcase_add_test(by_state, C3_K_after_C75_in_the_slot_after_the_last_command_holds_nothing);
    tcase_add_test(by_state, P9_held_after_the_last_command_the_index_stays_at_it);
    tcase_add_test(by_state, C5_a_guard_that_has_become_true_in_a_hold_lets_the_rest_do_no_step);
    tcase_add_test(by_state, R5_a_held_limit_move_whose_input_came_meanwhile_does_no_further_step);
    suite_add_tcase(suite, by_state);

    TCase *order = tcase_create("order");
    tcase_add_checked_fixture(order, setup, teardown);
    tcase_add_test(order, C3_C75_during_the_ramp_is_remembered);
    tcase_add_test(order, C3_a_K_after_it_cancels_the_remembered_C75);
    tcase_add_test(order, C3_a_second_K_during_the_ramp_leaves_the_rest_to_be_done);
    tcase_add_test(order, C6_K_during_the_ramp_of_X_holds_nothing);
    tcase_add_test(order, C3_K_and_C75_in_one_slot_act_in_order_of_arrival);
    tcase_add_test(order, C3_any_number_of_requests_in_one_slot_keep_their_meaning);
    tcase_add_test(order, C3_C75_K_C75_in_one_slot_stop_a_motion_and_let_it_go_on);
    tcase_add_test(order, C3_C4_a_change_of_speed_between_K_C75_and_a_second_K_is_dropped_by_it);
    tcase_add_test(order, C3_C75_during_the_ramp_of_a_guard_is_remembered_for_the_hold_after_it);
    suite_add_tcase(suite, order);

    return suite;
}

int main(void)
{
    return rig_run(interp_hold_suite(), "./test_interp_hold");
}
