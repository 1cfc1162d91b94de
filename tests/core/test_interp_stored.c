/* SPDX-License-Identifier: MIT */
/* test_interp_stored.c: commands that arrive in a hold, after a total stop, at a fault or for a jump that waits: C3, C7 of the
 * specification. */
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


START_TEST(C3_the_endless_motion_stopped_by_hand_makes_way_for_the_next_command)
{
    rig_accept(&rig, '1', "G+");
    rig_accept_at(&rig, 1001 * MS, "K");
    rig_accept_at(&rig, 5 * SECOND, "F1000 R");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 1 * MS, 1451 * MS, 1045, true);
    rig_expect_motion(&rig, 1, 2, 5 * SECOND + 1 * MS, 5 * SECOND + 1 * MS + move_ticks(100, 1000, 2000, 1000), 1000, true);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_commands_stored_during_the_ramp_are_executed_after_it)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "T02");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, 1452 * MS, 1045, true);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 1453 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_commands_stored_after_K_before_it_acts_end_the_hold_too)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1001 * MS + 1, "K");
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 2 * MS, 1452 * MS, 1045, true);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 1453 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_commands_stored_after_K_in_one_slot_of_a_dwell)
{
    rig_accept(&rig, '1', "W1000 T01");
    rig_accept_at(&rig, 100 * MS + 1, "K");
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 20 * SECOND);
    uint64_t tick = rig_outputs_became(&rig, 2, 1);
    ck_assert_uint_ge(tick, 101 * MS);
    ck_assert_uint_le(tick, 102 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_commands_stored_before_K_are_part_of_the_old_program)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1001 * MS + 1, "T02");
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "T03");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 4);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
}
END_TEST

START_TEST(C3_the_rest_of_the_old_program_is_dropped_and_stays_in_memory)
{
    rig_accept(&rig, '1', "W1000 T01 T02");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, "T03");
    rig_accept_at(&rig, 300 * MS, "T04");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x0C);
    ck_assert_str_eq(rig_program(&rig, 1), "W1000 T01 T02 T03 T04");
}
END_TEST

START_TEST(C3_C75_after_new_commands_is_nothing)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "W10");
    rig_accept_at(&rig, 4 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_a_text_without_commands_leaves_the_hold)
{
    rig_accept(&rig, '1', "W100 T01");
    rig_accept_at(&rig, 31 * MS, "K");
    rig_accept_at(&rig, 40 * MS, "");
    rig_accept_at(&rig, 50 * MS, "{ nothing }");
    rig_accept_at(&rig, 60 * MS, "K K");
    ck_assert_int_eq(rig_set(&rig, '1', "Q"), 2);
    rig_accept_at(&rig, 100 * MS, "C75");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 170 * MS);
}
END_TEST

START_TEST(C3_loops_of_the_old_program_are_dropped)
{
    rig_accept(&rig, '1', "L9 W1000 E");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, "E");
    rig_to(&rig, 300 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_LOOP);
}
END_TEST

START_TEST(C3_calls_of_the_old_program_are_dropped)
{
    rig_accept(&rig, '1', "'1 T01 @1 W1000 .");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, ".");
    rig_to(&rig, 300 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_CALL);
}
END_TEST

START_TEST(C3_an_open_block_of_the_old_program_is_dropped)
{
    rig_accept(&rig, '1', "[ T01");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, "T02 ]");
    rig_to(&rig, 300 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 200 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_labels_stay)
{
    rig_accept(&rig, '1', "W1000 T01 @5 T02");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, "J5");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_guards_parameters_and_table_stay)
{
    rig_accept(&rig, '1', "M05 V500 F100 Y W1000");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS, "Y R");
    rig_to(&rig, 300 * MS);
    ck_assert_str_eq(rig_ask(&rig, 6, 1), " 4;[(1;100),(61;500),(141;500),(200;0)]");
    rig_input_at(&rig, 301 * MS, 5, true); /* 0.1 s: v = 300, x = 20 */
    rig_to(&rig, 3 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 201 * MS, 401 * MS, 40, true);
}
END_TEST

START_TEST(C3_C75_after_new_commands_during_the_ramp_is_nothing)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "T02"); /* ends the hold */
    rig_accept_at(&rig, 1302 * MS, "C75");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 1453 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_C75_after_new_commands_in_the_same_slot_is_nothing)
{
    rig_accept(&rig, '1', "W1000 T01");
    rig_accept_at(&rig, 100 * MS, "K");
    rig_accept_at(&rig, 200 * MS + 1, "T02");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_new_commands_after_C75_follow_the_old_program)
{
    rig_accept(&rig, '1', "W1000 T01");
    rig_accept_at(&rig, 101 * MS, "K"); /* 900 slots left */
    rig_accept_at(&rig, 200 * MS + 1, "C75");
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 1101 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), 1102 * MS);
}
END_TEST

/* A K always stops what has arrived before it. */
START_TEST(C3_a_K_after_new_commands_holds_before_them)
{
    static const char *const old[] = {"", "W1000 T01", "O01 T01", "[ T01"};
    for (size_t i = 0; i < sizeof old / sizeof *old; i++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', old[i]);
        rig_accept_at(&rig, 100 * MS, "K");
        rig_accept_at(&rig, 200 * MS + 1, "T02");
        rig_accept(&rig, '1', "K");
        rig_to(&rig, 5 * SECOND);
        rig_expect_state(&rig, 1, RKM04_HELD);
        ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    }
}
END_TEST

START_TEST(C3_a_K_after_new_commands_during_the_ramp_holds_before_them)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "F700 R");
    rig_accept_at(&rig, 1302 * MS, "K");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    rig_expect_state(&rig, 1, RKM04_HELD);
}
END_TEST


START_TEST(C3_new_commands_run_after_a_total_stop)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_input_at(&rig, 2 * SECOND, 4, false);
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    rig_accept(&rig, '1', "T02");
    rig_to(&rig, 4 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_commands_stored_during_the_ramp_of_a_total_stop_run_after_it)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_input_at(&rig, 1103 * MS, 4, false);
    rig_accept_at(&rig, 1203 * MS, "T02");
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, 1045, true);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 1454 * MS);
}
END_TEST

START_TEST(C3_a_total_stop_cannot_be_resumed)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 4, true);
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

START_TEST(C3_new_commands_at_a_fault_are_stored_and_not_executed)
{
    rig_accept(&rig, '1', "E T01");
    rig_to(&rig, 100 * MS);
    rig_accept(&rig, '1', "T02");
    rig_accept_at(&rig, 200 * MS, "K");
    rig_accept_at(&rig, 300 * MS, "C75");
    rig_to(&rig, 1 * SECOND);
    rig_expect_state(&rig, 1, RKM04_FAULTY);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_LOOP);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_str_eq(rig_program(&rig, 1), "E T01 T02");
    rig_accept(&rig, '1', "\\ T03");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 4);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_commands_that_wait_after_a_K_run_before_newer_ones)
{
    rig_accept(&rig, '1', "S100 V1000 A300 F5000 R");
    rig_accept_at(&rig, 3500 * MS, "K");
    rig_accept_at(&rig, 3600 * MS, "T01");
    rig_accept_at(&rig, 3700 * MS, "K");
    rig_to(&rig, 9 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 6);
    rig_accept_at(&rig, 10 * SECOND, "T02");
    rig_to(&rig, 11 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 10 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), 10 * SECOND + 1 * MS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(P9_from_arrival_to_its_slot_the_first_new_command_is_shown)
{
    static const char *const before[] = {"W1000 R", "E U", "X04 W1000", "[ U"}; /* held, at a fault, ended, held */
    for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
        rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings.fault_exit = RKM04_FAULT_EXIT_NEW});
        rig_accept(&rig, '1', before[i]);
        rig_input_at(&rig, 5 * MS, 4, true);
        rig_input_at(&rig, 7 * MS, 4, false);
        rig_accept_at(&rig, 8 * MS, "K");
        rig_accept_at(&rig, 10500, "W100");
        rig_to(&rig, 10800);
        ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 3");
        rig_to(&rig, 12 * MS);
        ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 3");
        rig_expect_state(&rig, 1, RKM04_DWELL);
    }
}
END_TEST

START_TEST(C7_a_program_sent_in_parts_does_what_it_does_sent_at_once)
{
    rig_accept(&rig, '1', "F100 I01L20 R");
    rig_accept_at(&rig, 50 * MS, "B500 R @20 T01");
    rig_to(&rig, 5 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C7_a_call_that_has_waited_returns_after_itself)
{
    rig_accept(&rig, '1', "'5 T01");
    rig_accept_at(&rig, 50 * MS, "J6 @5 T02 . @6");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 3);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C6_X_and_C3_K_reach_a_motor_that_waits_for_a_label)
{
    rig_accept(&rig, '1', "X04 J5 T01");
    rig_accept_at(&rig, 50 * MS, "K");
    rig_accept_at(&rig, 60 * MS, "C75");
    rig_to(&rig, 70 * MS);
    rig_expect_state(&rig, 1, RKM04_WAIT);
    rig_input_at(&rig, 80 * MS, 4, true);
    rig_to(&rig, 90 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

static Suite *interp_stored_suite(void)
{
    Suite *suite = suite_create("interp_note_stored");

    TCase *hold = tcase_create("hold");
    tcase_add_checked_fixture(hold, setup, teardown);
    tcase_add_test(hold, C3_the_endless_motion_stopped_by_hand_makes_way_for_the_next_command);
    tcase_add_test(hold, C3_commands_stored_during_the_ramp_are_executed_after_it);
    tcase_add_test(hold, C3_commands_stored_after_K_before_it_acts_end_the_hold_too);
    tcase_add_test(hold, C3_commands_stored_after_K_in_one_slot_of_a_dwell);
    tcase_add_test(hold, C3_commands_stored_before_K_are_part_of_the_old_program);
    tcase_add_test(hold, C3_the_rest_of_the_old_program_is_dropped_and_stays_in_memory);
    tcase_add_test(hold, C3_C75_after_new_commands_is_nothing);
    tcase_add_test(hold, C3_a_text_without_commands_leaves_the_hold);
    tcase_add_test(hold, C3_loops_of_the_old_program_are_dropped);
    tcase_add_test(hold, C3_calls_of_the_old_program_are_dropped);
    tcase_add_test(hold, C3_an_open_block_of_the_old_program_is_dropped);
    tcase_add_test(hold, C3_labels_stay);
    tcase_add_test(hold, C3_guards_parameters_and_table_stay);
    tcase_add_test(hold, C3_C75_after_new_commands_during_the_ramp_is_nothing);
    tcase_add_test(hold, C3_C75_after_new_commands_in_the_same_slot_is_nothing);
    tcase_add_test(hold, C3_new_commands_after_C75_follow_the_old_program);
    tcase_add_test(hold, C3_a_K_after_new_commands_holds_before_them);
    tcase_add_test(hold, C3_a_K_after_new_commands_during_the_ramp_holds_before_them);
    suite_add_tcase(suite, hold);

    TCase *ended = tcase_create("ended");
    tcase_add_checked_fixture(ended, setup, teardown);
    tcase_add_test(ended, C3_new_commands_run_after_a_total_stop);
    tcase_add_test(ended, C3_commands_stored_during_the_ramp_of_a_total_stop_run_after_it);
    tcase_add_test(ended, C3_a_total_stop_cannot_be_resumed);
    tcase_add_test(ended, C3_new_commands_at_a_fault_are_stored_and_not_executed);
    tcase_add_test(ended, C7_a_program_sent_in_parts_does_what_it_does_sent_at_once);
    tcase_add_test(ended, C7_a_call_that_has_waited_returns_after_itself);
    tcase_add_test(ended, C6_X_and_C3_K_reach_a_motor_that_waits_for_a_label);
    tcase_add_test(ended, C3_commands_that_wait_after_a_K_run_before_newer_ones);
    tcase_add_test(ended, P9_from_arrival_to_its_slot_the_first_new_command_is_shown);
    suite_add_tcase(suite, ended);

    return suite;
}

int main(void)
{
    return rig_run(interp_stored_suite(), "./test_interp_stored");
}
