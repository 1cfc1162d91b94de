/* SPDX-License-Identifier: MIT */
/* test_interp_flow.c: time, the tape, loops, calls, jumps and blocks: K2, K4, C2, C7, C8, C9 of the specification. */
#include <check.h>
#include <stdio.h>
#include <string.h>

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

static void expect_fault(enum rkm04_fault fault, unsigned place)
{
    struct rkm04_motor_state state = rig_motor(&rig, 1);
    ck_assert_str_eq(rkm04_fault_name(state.fault), rkm04_fault_name(fault));
    ck_assert_str_eq(rkm04_state_name(state.state), rkm04_state_name(fault ? RKM04_FAULTY : RKM04_IDLE));
    ck_assert_uint_eq(state.index, place);
    ck_assert_int_eq(state.led, RKM04_LED_OFF);
}

/* Run a text for ten seconds: it ends idle, and motor 1 has gone this many steps. For counting what is done how often. */
static void expect_steps(const char *text, int32_t steps)
{
    rig_accept(&rig, '1', text);
    rig_to(&rig, rkm04_now(&rig.unit) + 10 * SECOND);
    expect_fault(RKM04_FAULT_NONE, 0);
    ck_assert_int_eq(rig_motor(&rig, 1).position, steps);
}


START_TEST(K4_a_text_between_two_slots_begins_in_the_next_one)
{
    rig_accept_at(&rig, 1001, "T01");
    rig_to(&rig, 10 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 2 * MS);
}
END_TEST

START_TEST(K4_a_text_at_the_tick_of_a_slot_begins_in_it)
{
    rig_accept_at(&rig, 2000, "T01");
    rig_to(&rig, 10 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 2 * MS);
}
END_TEST

START_TEST(K4_every_command_costs_one_slot)
{
    rig_accept(&rig, '1', "U @1 L1 E [ ] '2 T01 @2 D . T02"); /* to @2 and, by the dot, back to T01, again to @2 */
    rig_to(&rig, 100 * MS);
    static const unsigned order[] = {1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 8, 9, 10, 11};
    size_t times[13] = {0};
    for (size_t i = 0; i < sizeof order / sizeof *order; i++)
        ck_assert_uint_eq(rig_ran(&rig, order[i], ++times[order[i]]), (i + 1) * MS);
    expect_fault(RKM04_FAULT_NO_CALL, 11);
}
END_TEST

START_TEST(K4_a_wait_that_has_passed_is_followed_one_slot_later)
{
    rig_input_at(&rig, 0, 3, true);
    rig_accept(&rig, '1', "O03 Z04 T01");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 3 * MS);
}
END_TEST

START_TEST(K4_a_wait_is_checked_anew_in_each_slot)
{
    rig_accept(&rig, '1', "O03 T01");
    rig_input_at(&rig, 5001, 3, true);
    rig_input_at(&rig, 5999, 3, false); /* between two slots: not seen */
    rig_input_at(&rig, 8000, 3, true);  /* at the tick of a slot: seen in it */
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 9 * MS);
}
END_TEST

START_TEST(K4_the_command_after_a_dwell_of_n_is_executed_n_slots_later)
{
    rig_accept(&rig, '1', "W1 T01 W2 C01 W16000000 T02");
    rig_to(&rig, 6 * MS + 16000 * SECOND + 1);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 2 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0, 1), 5 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 6 * MS + 16000 * SECOND);
}
END_TEST

/* With V <= S step k comes after ceil(10^6 k / V) ticks. */
START_TEST(K4_the_command_after_a_motion_comes_at_the_first_slot_10_us_after_the_last_pulse)
{
    static const struct {
        unsigned v, steps;
        uint64_t last; /* ticks from R to the last pulse */
    } row[] = {{182, 2, 10990}, {412, 7, 16991}, {273, 3, 10990}, {417, 5, 11991}, {1000, 1, 1000}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        char text[64];
        snprintf(text, sizeof text, "S2000 V%u F%u R T01", row[i].v, row[i].steps);
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', text);
        rig_to(&rig, 1 * SECOND);
        rig_expect_motion(&rig, 1, 1, 4000, 4000 + row[i].last, row[i].steps, true);
        ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 4000 + (row[i].last + 10 + 999) / 1000 * 1000);
    }
}
END_TEST

START_TEST(K4_a_motion_without_steps_takes_its_one_slot)
{
    rig_accept(&rig, '1', "R H =5 G5 T01");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 5 * MS);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 0);
}
END_TEST

START_TEST(K2_the_motors_take_their_turns_in_order)
{
    rig_accept(&rig, '1', "U T80");
    rig_accept(&rig, '2', "O80 T02");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 3 * MS); /* seen in slot 2000 already */
}
END_TEST

START_TEST(K2_what_a_later_motor_writes_is_seen_in_the_next_slot)
{
    rig_accept(&rig, '4', "U T95");
    rig_accept(&rig, '1', "O95 T01");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 4 * MS); /* written in 2000, seen in 3000 */
}
END_TEST

START_TEST(K2_four_motors_hand_a_variable_round_within_one_slot)
{
    rig_accept(&rig, '4', "O82 T04");
    rig_accept(&rig, '3', "O81 T82");
    rig_accept(&rig, '2', "O80 T81");
    rig_accept(&rig, '1', "W9 T80");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 8, 1), 13 * MS); /* T80 in 10 000, T81, T82, T04 a slot later each */
}
END_TEST

START_TEST(K2_an_output_written_by_two_motors_in_one_slot_is_what_the_later_one_wrote)
{
    rig_accept(&rig, '1', "T01 C02");
    rig_accept(&rig, '2', "C01 T02");
    rig_to(&rig, 1 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_to(&rig, 2 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(K2_pulses_of_a_tick_come_before_its_slot)
{
    rig_accept(&rig, '1', ")05 T01"); /* pulse 3 at 1000 + 30 000 */
    rig_input_at(&rig, 31 * MS, 5, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 3);
}
END_TEST


START_TEST(C2_commands_are_executed_as_they_arrive)
{
    rig_accept(&rig, '1', "F100");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 0);
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 1 * SECOND);
    rig_expect_motion(&rig, 1, 1, 100 * MS, 100 * MS + move_ticks(100, 1000, 2000, 100), 100, true);
    ck_assert_str_eq(rig_program(&rig, 1), "F100 R");
    ck_assert_uint_eq(rig_ran(&rig, 2, 1), 100 * MS);
}
END_TEST

START_TEST(C2_commands_that_arrive_during_a_motion_follow_it)
{
    rig_accept(&rig, '1', "F1000 R");
    rig_accept_at(&rig, 500 * MS, "B1000");
    rig_accept_at(&rig, 600 * MS, "R");
    rig_to(&rig, 5 * SECOND);
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 1000);
    rig_expect_motion(&rig, 1, 1, 2 * MS, end, 1000, true);
    uint64_t begin = slot_behind(end) + 1 * MS;
    rig_expect_motion(&rig, 1, 2, begin, begin + move_ticks(100, 1000, 2000, 1000), 1000, false);
}
END_TEST

START_TEST(C2_the_motors_run_independently)
{
    rig_accept(&rig, '1', "F100 R");
    rig_accept(&rig, '2', "U B200 R");
    rig_accept(&rig, '4', "W500 F300 R");
    rig_to(&rig, 3 * SECOND);
    rig_expect_motion(&rig, 1, 1, 2 * MS, 2 * MS + move_ticks(100, 1000, 2000, 100), 100, true);
    rig_expect_motion(&rig, 2, 1, 3 * MS, 3 * MS + move_ticks(100, 1000, 2000, 200), 200, false);
    ck_assert_uint_eq(rig_motions(&rig, 3), 0);
    rig_expect_motion(&rig, 4, 1, 502 * MS, 502 * MS + move_ticks(100, 1000, 2000, 300), 300, true);
}
END_TEST

START_TEST(C2_going_idle_is_told)
{
    rig_accept(&rig, '1', "U U");
    rig_to(&rig, 100 * MS);
    const struct record *idle = recorder_event(&rig.record, 1, RKM04_EVENT_COMMAND, 0, 1);
    ck_assert_ptr_nonnull(idle);
    ck_assert_uint_ge(idle->tick, 2 * MS);
    ck_assert_uint_le(idle->tick, 3 * MS);
}
END_TEST


START_TEST(C7_a_loop_body_runs_n_times)
{
    expect_steps("S2000 F1 L1 R E", 1);
    expect_steps("C100 L2 R E", 2);
    expect_steps("C100 L255 R E", 255);
}
END_TEST

START_TEST(C7_the_end_of_a_loop_goes_on_after_its_L)
{
    rig_accept(&rig, '1', "L2 U E T01");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_ran(&rig, 1, 2), RKM04_NEVER);
    ck_assert_uint_eq(rig_ran(&rig, 2, 2), 4 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 6 * MS);
}
END_TEST

START_TEST(C7_eight_levels_of_loops_multiply)
{
    expect_steps("S2000 V2000 F1 L2 L2 L2 L2 L2 L2 L2 L2 R E E E E E E E E", 256);
}
END_TEST

START_TEST(C7_a_ninth_loop_level_is_a_fault)
{
    rig_accept(&rig, '1', "L2 L2 L2 L2 L2 L2 L2 L2 L2 T01");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_LOOP_LEVELS, 9);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C7_an_end_without_a_loop_is_a_fault)
{
    rig_accept(&rig, '1', "L2 E E T01");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_NO_LOOP, 3);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

/* 100 passes through an L that is never closed do not need a ninth level. */
START_TEST(C7_the_same_L_again_restarts_its_loop)
{
    rig_accept(&rig, '1', "@1 L3 I01L1 T01 E T02");
    rig_input_at(&rig, 300 * MS, 1, true);
    rig_to(&rig, 1 * SECOND);
    expect_fault(RKM04_FAULT_NONE, 0);
    ck_assert_uint_eq(rig_ran(&rig, 4, 3) != RKM04_NEVER, true); /* three full passes since the last restart */
    ck_assert_uint_eq(rig_ran(&rig, 4, 4), RKM04_NEVER);
}
END_TEST

/* The inner loop is open whenever the outer L is executed again: were it kept, the ninth time would fail. */
START_TEST(C7_the_same_L_again_closes_the_loops_inside_it)
{
    rig_accept(&rig, '1', "S2000 F1 @1 L2 L3 I01L1 R E E");
    rig_input_at(&rig, 300 * MS, 1, true);
    rig_to(&rig, 10 * SECOND);
    expect_fault(RKM04_FAULT_NONE, 0);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 6);
}
END_TEST

START_TEST(C7_a_loop_inside_a_loop_begins_anew_in_each_pass)
{
    expect_steps("S2000 F1 L3 L2 R E R E", 9);
}
END_TEST

START_TEST(C7_jumping_out_leaves_a_loop_open)
{
    expect_steps("S2000 F1 L2 R J1 T08 @1 E", 2); /* the E at @1 belongs to it */
}
END_TEST

START_TEST(C7_an_end_in_a_subroutine_does_not_see_the_loops_of_its_caller)
{
    rig_accept(&rig, '1', "L2 '1 E J2 @1 E . @2");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_NO_LOOP, 6);
}
END_TEST

/* The subroutine executes the L of its caller: a loop of its own with two passes, in each pass of the
 * caller's. */
START_TEST(C7_the_same_L_in_a_subroutine_is_another_loop)
{
    expect_steps("S2000 F1 @1 L2 R I80H2 T80 '1 @2 E I80L3 C80 . @3", 6);
}
END_TEST


START_TEST(C8_a_return_goes_after_the_call)
{
    expect_steps("S2000 F1 '1 '1 R J2 @1 R R . @2", 5);
}
END_TEST

START_TEST(C8_six_levels_of_calls)
{
    expect_steps("S2000 F1 '1 J9 @1 '2 R . @2 '3 R . @3 '4 R . @4 '5 R . @5 '6 R . @6 R . @9", 6);
}
END_TEST

START_TEST(C7_a_seventh_call_level_is_a_fault)
{
    rig_accept(&rig, '1', "@1 '1");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_CALL_LEVELS, 2);
    ck_assert_uint_ne(rig_ran(&rig, 2, 7), RKM04_NEVER);
    ck_assert_uint_eq(rig_ran(&rig, 2, 8), RKM04_NEVER);
}
END_TEST

START_TEST(C7_a_return_without_a_call_is_a_fault)
{
    rig_accept(&rig, '1', "U . T01");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_NO_CALL, 2);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C8_loops_opened_in_a_subroutine_are_closed_by_its_return)
{
    expect_steps("S2000 F1 L20 '1 R E J2 @1 L5 L5 . @2", 20);
}
END_TEST

START_TEST(C8_of_two_equal_labels_the_one_written_last_counts)
{
    expect_steps("S2000 F1 J1 @1 R R R @1 R", 1);
    expect_steps("C100 @2 R I80H3 T80 J2 @3", 2);
}
END_TEST

START_TEST(C8_a_label_may_be_written_after_the_jump_to_it_has_been_stored)
{
    rig_accept(&rig, '1', "W100 J7");
    rig_accept_at(&rig, 50 * MS, "T01 @7 T02");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C7_a_jump_to_a_missing_label_waits_for_it)
{
    static const char *const text[] = {"U J5 T01", "U '5 T01", "U I01L5 T01", "U I80L5 T01"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', text[i]);
        rig_to(&rig, 100 * MS + 1);
        ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER);
        rig_expect_state(&rig, 1, RKM04_WAIT);
        ck_assert_uint_eq(rig_motor(&rig, 1).index, 2);
        rig_accept(&rig, '1', "T03");
        rig_input_at(&rig, 150 * MS, 1, true); /* I has decided in its slot */
        rig_accept_at(&rig, 200 * MS, "@5 T02");
        rig_to(&rig, 300 * MS);
        ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
        ck_assert_uint_eq(rig_ran(&rig, 5, 1), 201 * MS);
    }
}
END_TEST

START_TEST(C7_a_seventh_call_is_a_fault_also_where_its_label_is_missing)
{
    rig_accept(&rig, '1', "J7 @1 '2 @2 '3 @3 '4 @4 '5 @5 '6 @6 '9 @7 '1");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_CALL_LEVELS, 13);
}
END_TEST

START_TEST(C7_a_jump_that_is_not_taken_needs_no_label)
{
    rig_accept(&rig, '1', "I01H5 I80H5 T01");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_NONE, 0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C7_a_fault_cannot_be_resumed_and_is_told_once)
{
    rig_accept(&rig, '1', "E T01");
    rig_to(&rig, 100 * MS);
    rig_accept(&rig, '1', "K");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 1 * SECOND);
    expect_fault(RKM04_FAULT_NO_LOOP, 1);
    ck_assert_ptr_nonnull(recorder_event(&rig.record, 1, RKM04_EVENT_FAULT, RKM04_FAULT_NO_LOOP, 1));
    ck_assert_ptr_null(recorder_event(&rig.record, 1, RKM04_EVENT_FAULT, RKM04_FAULT_NO_LOOP, 2));
}
END_TEST

START_TEST(C7_conditional_jumps_follow_inputs_and_variables)
{
    rig_input_at(&rig, 0, 8, true);
    rig_accept(&rig, '1', "I08H1 T01 @1 I08L2 T02 @2 T95 I95H3 T03 @3 I95L4 T04 @4");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x0A);
}
END_TEST


START_TEST(C9_a_block_with_its_end_runs_at_once)
{
    rig_accept(&rig, '1', "[ T01 ] T02");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 2 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), 4 * MS);
}
END_TEST

START_TEST(C9_an_open_block_waits_for_its_end_and_goes_on_after_its_beginning)
{
    rig_accept(&rig, '1', "[ T01");
    rig_accept_at(&rig, 50 * MS, "T02");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_BLOCK);
    rig_accept(&rig, '1', "T03 ] T04");
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0xF, 1), 105 * MS);
}
END_TEST

START_TEST(C9_an_end_before_the_beginning_does_not_count)
{
    rig_accept(&rig, '1', "] [ T01");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_BLOCK);
}
END_TEST

START_TEST(C9_one_end_releases_all_open_beginnings)
{
    rig_accept(&rig, '1', "[ T01 [ T02");
    rig_accept_at(&rig, 100 * MS, "]");
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 3);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(C9_an_executed_end_does_nothing_but_takes_a_place)
{
    rig_accept(&rig, '1', "] ] T01");
    ck_assert_uint_eq(rig_motor(&rig, 1).commands, 3);
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 3 * MS);
}
END_TEST

START_TEST(C9_a_block_in_a_loop_is_open_no_more)
{
    expect_steps("S2000 F1 L3 [ R ] E", 3);
}
END_TEST

START_TEST(C9_an_unclosed_block_from_flash_waits_for_its_end)
{
    rig_accept(&rig, '1', "[ T01");
    uint8_t answer[3];
    rkm04_exchange(&rig.unit, (const uint8_t *)"\x03" "1", 2, answer, sizeof answer);
    ck_assert_uint_eq(answer[2], 0);
    rig_power_cycle(&rig);
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_BLOCK);
    rig_accept(&rig, '1', "]");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

static Suite *interp_flow_suite(void)
{
    Suite *suite = suite_create("interp_flow");

    TCase *time = tcase_create("time");
    tcase_add_checked_fixture(time, setup, teardown);
    tcase_add_test(time, K4_a_text_between_two_slots_begins_in_the_next_one);
    tcase_add_test(time, K4_a_text_at_the_tick_of_a_slot_begins_in_it);
    tcase_add_test(time, K4_every_command_costs_one_slot);
    tcase_add_test(time, K4_a_wait_that_has_passed_is_followed_one_slot_later);
    tcase_add_test(time, K4_a_wait_is_checked_anew_in_each_slot);
    tcase_add_test(time, K4_the_command_after_a_dwell_of_n_is_executed_n_slots_later);
    tcase_add_test(time, K4_the_command_after_a_motion_comes_at_the_first_slot_10_us_after_the_last_pulse);
    tcase_add_test(time, K4_a_motion_without_steps_takes_its_one_slot);
    tcase_add_test(time, K2_the_motors_take_their_turns_in_order);
    tcase_add_test(time, K2_what_a_later_motor_writes_is_seen_in_the_next_slot);
    tcase_add_test(time, K2_four_motors_hand_a_variable_round_within_one_slot);
    tcase_add_test(time, K2_an_output_written_by_two_motors_in_one_slot_is_what_the_later_one_wrote);
    tcase_add_test(time, K2_pulses_of_a_tick_come_before_its_slot);
    suite_add_tcase(suite, time);

    TCase *tape = tcase_create("tape");
    tcase_add_checked_fixture(tape, setup, teardown);
    tcase_add_test(tape, C2_commands_are_executed_as_they_arrive);
    tcase_add_test(tape, C2_commands_that_arrive_during_a_motion_follow_it);
    tcase_add_test(tape, C2_the_motors_run_independently);
    tcase_add_test(tape, C2_going_idle_is_told);
    suite_add_tcase(suite, tape);

    TCase *loops = tcase_create("loops");
    tcase_add_checked_fixture(loops, setup, teardown);
    tcase_add_test(loops, C7_a_loop_body_runs_n_times);
    tcase_add_test(loops, C7_the_end_of_a_loop_goes_on_after_its_L);
    tcase_add_test(loops, C7_eight_levels_of_loops_multiply);
    tcase_add_test(loops, C7_a_ninth_loop_level_is_a_fault);
    tcase_add_test(loops, C7_an_end_without_a_loop_is_a_fault);
    tcase_add_test(loops, C7_the_same_L_again_restarts_its_loop);
    tcase_add_test(loops, C7_the_same_L_again_closes_the_loops_inside_it);
    tcase_add_test(loops, C7_a_loop_inside_a_loop_begins_anew_in_each_pass);
    tcase_add_test(loops, C7_jumping_out_leaves_a_loop_open);
    tcase_add_test(loops, C7_an_end_in_a_subroutine_does_not_see_the_loops_of_its_caller);
    tcase_add_test(loops, C7_the_same_L_in_a_subroutine_is_another_loop);
    suite_add_tcase(suite, loops);

    TCase *calls = tcase_create("calls");
    tcase_add_checked_fixture(calls, setup, teardown);
    tcase_add_test(calls, C8_a_return_goes_after_the_call);
    tcase_add_test(calls, C8_six_levels_of_calls);
    tcase_add_test(calls, C7_a_seventh_call_level_is_a_fault);
    tcase_add_test(calls, C7_a_return_without_a_call_is_a_fault);
    tcase_add_test(calls, C8_loops_opened_in_a_subroutine_are_closed_by_its_return);
    tcase_add_test(calls, C8_of_two_equal_labels_the_one_written_last_counts);
    tcase_add_test(calls, C8_a_label_may_be_written_after_the_jump_to_it_has_been_stored);
    tcase_add_test(calls, C7_a_jump_to_a_missing_label_waits_for_it);
    tcase_add_test(calls, C7_a_seventh_call_is_a_fault_also_where_its_label_is_missing);
    tcase_add_test(calls, C7_a_jump_that_is_not_taken_needs_no_label);
    tcase_add_test(calls, C7_a_fault_cannot_be_resumed_and_is_told_once);
    tcase_add_test(calls, C7_conditional_jumps_follow_inputs_and_variables);
    suite_add_tcase(suite, calls);

    TCase *blocks = tcase_create("blocks");
    tcase_add_checked_fixture(blocks, setup, teardown);
    tcase_add_test(blocks, C9_a_block_with_its_end_runs_at_once);
    tcase_add_test(blocks, C9_an_open_block_waits_for_its_end_and_goes_on_after_its_beginning);
    tcase_add_test(blocks, C9_an_end_before_the_beginning_does_not_count);
    tcase_add_test(blocks, C9_one_end_releases_all_open_beginnings);
    tcase_add_test(blocks, C9_an_executed_end_does_nothing_but_takes_a_place);
    tcase_add_test(blocks, C9_a_block_in_a_loop_is_open_no_more);
    tcase_add_test(blocks, C9_an_unclosed_block_from_flash_waits_for_its_end);
    suite_add_tcase(suite, blocks);

    return suite;
}

int main(void)
{
    return rig_run(interp_flow_suite(), "./test_interp_flow");
}
