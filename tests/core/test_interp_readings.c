/* SPDX-License-Identifier: MIT */
/* test_interp_readings.c: what a unit does otherwise under each reading, section 10 of the specification. */
#include <check.h>
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

/* A new unit under these readings. */
#define READ(...) rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings = {__VA_ARGS__}})

static void expect_fault(enum rkm04_fault fault, unsigned place)
{
    struct rkm04_motor_state state = rig_motor(&rig, 1);
    ck_assert_str_eq(rkm04_fault_name(state.fault), rkm04_fault_name(fault));
    ck_assert_uint_eq(state.index, place);
}

static uint64_t led_became(enum rkm04_led led, size_t n)
{
    const struct record *record = recorder_event(&rig.record, 1, RKM04_EVENT_LED, led, n);
    return record ? record->tick : RKM04_NEVER;
}

/* ---- label, fault-exit ---------------------------------------------------------------------------------------------- */

START_TEST(C7_label_fault_a_jump_to_a_missing_label_is_a_fault)
{
    static const char *const text[] = {"U J5 T01", "U '5 T01", "U I01L5 T01", "U I80L5 T01"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        READ(.label = RKM04_LABEL_FAULT);
        rig_accept(&rig, '1', text[i]);
        rig_accept_at(&rig, 100 * MS, "@5 T02");
        rig_to(&rig, 200 * MS);
        expect_fault(RKM04_FAULT_NO_LABEL, 2);
        ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    }
}
END_TEST

START_TEST(C3_fault_exit_new_new_commands_run_after_a_fault_and_end_it)
{
    READ(.label = RKM04_LABEL_FAULT, .fault_exit = RKM04_FAULT_EXIT_NEW);
    rig_accept(&rig, '1', "J5 T01");
    rig_to(&rig, 100 * MS);
    expect_fault(RKM04_FAULT_NO_LABEL, 1);
    rig_accept(&rig, '1', "T02 W1000");
    rig_to(&rig, 200 * MS);
    expect_fault(RKM04_FAULT_NONE, 4);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C3_fault_exit_new_a_text_without_commands_leaves_the_fault)
{
    READ(.fault_exit = RKM04_FAULT_EXIT_NEW);
    rig_accept(&rig, '1', "E T01");
    rig_accept_at(&rig, 100 * MS, "{ nothing }");
    ck_assert_int_eq(rig_set(&rig, '1', "Q"), 2);
    rig_to(&rig, 200 * MS);
    expect_fault(RKM04_FAULT_NO_LOOP, 1);
}
END_TEST

START_TEST(C3_fault_exit_new_loops_and_calls_of_the_faulty_program_are_dropped)
{
    READ(.label = RKM04_LABEL_FAULT, .fault_exit = RKM04_FAULT_EXIT_NEW);
    rig_accept(&rig, '1', "L2 '1 @1 J5");
    rig_accept_at(&rig, 100 * MS, ".");
    rig_to(&rig, 200 * MS);
    expect_fault(RKM04_FAULT_NO_CALL, 5);
    rig_accept(&rig, '1', "E");
    rig_to(&rig, 300 * MS);
    expect_fault(RKM04_FAULT_NO_LOOP, 6);
    ck_assert_ptr_nonnull(recorder_event(&rig.record, 1, RKM04_EVENT_FAULT, RKM04_FAULT_NO_CALL, 1)); /* reported again */
}
END_TEST

START_TEST(E1_fault_exit_new_the_LED_blinks_until_the_next_motion_begins)
{
    READ(.fault_exit = RKM04_FAULT_EXIT_NEW);
    rig_accept(&rig, '1', "Y R T01");
    rig_accept_at(&rig, 5 * SECOND, "T02 F1000 R");
    rig_to(&rig, 5 * SECOND + 1 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2); /* runs again, still blinking */
    expect_fault(RKM04_FAULT_NONE, 4);
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_BLINK);
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(led_became(RKM04_LED_ON, 1), 5 * SECOND + 2 * MS);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 1000); /* the table was emptied */
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_OFF);
}
END_TEST

/* ---- hold-exit, x-after, guard-start -------------------------------------------------------------------------------- */

START_TEST(C3_hold_exit_latch_new_commands_wait_after_the_rest)
{
    READ(.hold_exit = RKM04_HOLD_EXIT_LATCH);
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "T02");
    rig_accept_at(&rig, 3 * SECOND, "T03");
    rig_to(&rig, 4 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 5000);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 7);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_hold_exit_latch_commands_after_a_total_stop_held_before_they_begin_wait_for_C75)
{
    READ(.hold_exit = RKM04_HOLD_EXIT_LATCH);
    rig_accept(&rig, '1', "X04 W1000");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_input_at(&rig, 200 * MS, 4, false);
    rig_accept_at(&rig, 200 * MS + 1, "T01");
    rig_accept(&rig, '1', "K");
    rig_accept_at(&rig, 300 * MS, "T02");
    rig_to(&rig, 400 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 500 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 3);
}
END_TEST

START_TEST(C6_x_after_once_X_has_fired_once_and_lets_new_commands_run)
{
    READ(.x_after = RKM04_X_AFTER_ONCE);
    rig_accept(&rig, '1', "X04 W1000");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_accept_at(&rig, 200 * MS, "T01 F1000 R"); /* the input is still 1 */
    rig_to(&rig, 5 * SECOND);
    rig_expect_state(&rig, 1, RKM04_IDLE);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 1000);
}
END_TEST

START_TEST(C5_guard_start_step_a_motion_begins_all_the_same_and_is_stopped_in_the_next_slot)
{
    READ(.guard_start = RKM04_GUARD_START_STEP);
    rig_input_at(&rig, 0, 4, true);
    rig_accept(&rig, '1', "M04 F1000 R T01 F10 R");
    rig_to(&rig, 5 * SECOND);
    /* One slot after its begin the speed is 102/s, so that the ramp to S ends within the first step. */
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 3 * MS + 9981, 1, true);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 11); /* the guard is used up */
}
END_TEST

START_TEST(C5_guard_start_step_holds_for_a_motion_that_goes_on_too)
{
    READ(.guard_start = RKM04_GUARD_START_STEP);
    rig_accept(&rig, '1', "N04 M05 G+ T01");
    rig_input_at(&rig, 0, 4, true);
    rig_accept_at(&rig, 1 * SECOND, "K");
    rig_input_at(&rig, 2 * SECOND, 5, true);
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 4 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 2);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

/* ---- Texts ---------------------------------------------------------------------------------------------------------- */

START_TEST(C4_v_alone_first_only_the_whole_text_is_alone)
{
    static const char *const dressed[] = {" V500", "V500 ", "{ slower } V500", "V500{}", "\nV500"};
    for (size_t i = 0; i < sizeof dressed / sizeof *dressed; i++) {
        READ(.v_alone = RKM04_V_ALONE_FIRST);
        rig_accept(&rig, '1', "G+");
        rig_accept_at(&rig, 1 * SECOND, dressed[i]);
        rig_to(&rig, 2 * SECOND);
        ck_assert_str_eq(rig_program(&rig, 1), "G+ V500");
        ck_assert_uint_eq(rig_motor(&rig, 1).speed, 1000);
        rig_accept(&rig, '1', "V500");
        rig_to(&rig, 3 * SECOND);
        ck_assert_uint_eq(rig_motor(&rig, 1).speed, 500);
    }
}
END_TEST

START_TEST(C3_v_alone_first_K_and_C75_with_blanks_are_ignored)
{
    READ(.v_alone = RKM04_V_ALONE_FIRST);
    rig_accept(&rig, '1', "W5000");
    rig_accept_at(&rig, 1 * SECOND, " K");
    rig_accept(&rig, '1', "K\n");
    rig_to(&rig, 2 * SECOND);
    rig_expect_state(&rig, 1, RKM04_DWELL);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 3 * SECOND);
    rig_accept(&rig, '1', "C75 {}");
    rig_to(&rig, 4 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 5 * SECOND);
    rig_expect_state(&rig, 1, RKM04_DWELL);
    ck_assert_str_eq(rig_program(&rig, 1), "W5000");
}
END_TEST

START_TEST(E1_y_eleventh_y_the_eleventh_Y_is_the_error)
{
    READ(.y_eleventh = RKM04_Y_ELEVENTH_Y);
    rig_accept(&rig, '1', "F10 Y Y Y Y Y Y Y Y Y Y Y T01");
    rig_to(&rig, 1 * SECOND);
    expect_fault(RKM04_FAULT_MOTION, 12);
    ck_assert_uint_eq(led_became(RKM04_LED_BLINK, 1), 12 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    READ(.y_eleventh = RKM04_Y_ELEVENTH_Y);
    rig_accept(&rig, '1', "F10 Y Y Y Y Y Y Y Y Y Y R T01"); /* ten are right */
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 100);
}
END_TEST

START_TEST(C1_reset_t41_clear_a_reset_of_any_motor_ends_the_simulation)
{
    READ(.reset_t41 = RKM04_RESET_T41_CLEAR);
    rig_accept(&rig, '1', "T01 T41 G+");
    rig_to(&rig, 1 * SECOND + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept(&rig, '3', "\\");
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_gt(recorder_step(&rig.record, 1, 1), 1 * SECOND);
    ck_assert_uint_ne(recorder_step(&rig.record, 1, 1), RKM04_NEVER);
}
END_TEST

START_TEST(P1_negative_position_no_a_counter_below_0_is_a_bad_value)
{
    uint8_t character;
    READ(.negative_position = RKM04_NEGATIVE_POSITION_NO);
    ck_assert_int_eq(rkm04_set_command(&rig.unit, '1', "T01 =-5 Q", 9, &character), 1);
    ck_assert_uint_eq(character, '=');
    ck_assert_int_eq(rkm04_set_command(&rig.unit, '1', "Q =-5", 5, &character), 2); /* the first error is reported */
    rig_accept(&rig, '1', "=0 =2000000000");
    ck_assert_str_eq(rig_program(&rig, 1), "=0 =2000000000");
}
END_TEST

/* ---- Times ---------------------------------------------------------------------------------------------------------- */

START_TEST(R1_planning_a_motion_begins_so_much_later_and_the_motor_is_as_in_a_dwell)
{
    static const char *const move[] = {"R", "G100", "G+", "G-", "(05", ")05", "H"};
    for (size_t i = 0; i < sizeof move / sizeof *move; i++) {
        char text[32] = "=-50 F10 ";
        READ(.planning = 300);
        rig_accept(&rig, '1', strcat(text, move[i]));
        rig_to(&rig, 302 * MS + 1);
        rig_expect_state(&rig, 1, RKM04_DWELL);
        ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 3");
        ck_assert_uint_eq(rkm04_next_event(&rig.unit), 303 * MS);
        rig_to(&rig, 303 * MS + 1);
        rig_expect_state(&rig, 1, RKM04_MOVING);
        ck_assert_uint_eq(led_became(RKM04_LED_ON, 1), 303 * MS);
        ck_assert_uint_eq(rig_ran(&rig, 3, 1), 3 * MS);
    }
}
END_TEST

START_TEST(R1_planning_is_held_and_resumed_as_a_dwell_and_ended_by_X)
{
    READ(.planning = 300);
    rig_accept(&rig, '1', "X04 F10 R T01");
    rig_accept_at(&rig, 103 * MS, "K");
    rig_to(&rig, 1 * SECOND);
    rig_expect_state(&rig, 1, RKM04_HELD);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(led_became(RKM04_LED_ON, 1), 1200 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_accept(&rig, '1', "R T02");
    rig_input_at(&rig, 2100 * MS, 4, true);
    rig_to(&rig, 3 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 10);
}
END_TEST

START_TEST(C5_planning_guards_and_the_table_are_checked_when_the_motion_begins)
{
    READ(.planning = 300);
    rig_accept(&rig, '1', "M04 F10 R T01");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_input_at(&rig, 200 * MS, 4, false); /* between command and begin: no matter */
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 10);
    rig_accept(&rig, '1', "Y B1 Y R");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(led_became(RKM04_LED_BLINK, 1), 1303 * MS);
}
END_TEST

START_TEST(U2_input_filter_an_input_counts_when_it_has_been_constant_for_so_long)
{
    READ(.input_filter = 20);
    rig_accept(&rig, '1', "O03 T01 Z03 C01");
    rig_input_at(&rig, 100 * MS, 3, true);
    rig_input_at(&rig, 115 * MS, 3, false); /* too short */
    rig_input_at(&rig, 116 * MS, 3, true);
    rig_to(&rig, 136 * MS);
    ck_assert_uint_eq(rkm04_inputs(&rig.unit), 4); /* the terminals */
    rig_expect_state(&rig, 1, RKM04_WAIT);
    rig_input_at(&rig, 500 * MS + 1, 3, false);
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 137 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0, 1), 522 * MS);
}
END_TEST

START_TEST(C6_input_filter_delays_X_and_limit_moves)
{
    READ(.input_filter = 20);
    rig_accept(&rig, '1', ")05 W1000");
    rig_accept(&rig, '2', "X04 W1000");
    rig_input_at(&rig, 201 * MS, 5, true);
    rig_input_at(&rig, 300 * MS, 4, true);
    rig_to(&rig, 320 * MS);
    rig_expect_state(&rig, 2, RKM04_DWELL);
    rig_to(&rig, 320 * MS + 1);
    rig_expect_state(&rig, 2, RKM04_ENDED);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 22); /* pulse k at 1000 + 10 000 k, ended at 221 000 */
}
END_TEST

static size_t send_all(uint8_t *bytes, size_t room)
{
    size_t n = rkm04_send(&rig.unit, bytes, room);
    ck_assert_uint_le(n, room);
    return n;
}

static void expect_store_time(const uint8_t *request, size_t length)
{
    uint8_t bytes[32];
    READ(.store_time = 50);
    rig_accept(&rig, '1', "F1000 R");
    rig_accept(&rig, '2', "L255 T02 C02 E");
    rig_to(&rig, 100 * MS + 1);
    size_t steps = recorder_steps(&rig.record, 1);
    ck_assert_uint_eq(rkm04_receive(&rig.unit, request, length), length);
    size_t records = rig.record.count;
    for (uint64_t tick = 100 * MS + 1; tick <= 150 * MS; tick += 7 * MS) {
        rig_to(&rig, tick);
        ck_assert(!rkm04_sending(&rig.unit));
        ck_assert_uint_eq(send_all(bytes, sizeof bytes), 0);
    }
    rig_to(&rig, 151 * MS); /* its last slot is 150 000 */
    for (size_t i = records; i < rig.record.count; i++)
        ck_assert(rig.record.list[i].motor == 1 && rig.record.list[i].kind == RECORD_STEP);
    ck_assert_uint_gt(recorder_steps(&rig.record, 1), steps);
    rig_to(&rig, 151 * MS + 1);
    ck_assert_uint_gt(recorder_steps(&rig.record, 1), 0);
    ck_assert(rkm04_sending(&rig.unit));
    ck_assert_uint_gt(send_all(bytes, sizeof bytes), 0);
    ck_assert_uint_ne(rig.record.list[rig.record.count - 1].kind, RECORD_STEP); /* motor 2 continues */
}

START_TEST(P6_store_time_delays_the_answer_and_all_commands_but_no_pulse)
{
    static const uint8_t one[] = {1, 0, 2, 3, '3'}, all[] = {1, 0, 2, 3, '0'};
    static const uint8_t *const request[] = {one, all};
    for (size_t i = 0; i < 2; i++) {
        uint8_t frame[32];
        struct rkm04_sender sender = {0};
        size_t n = rkm04_hdlc.begin(&sender, 1, 0, 2, false, frame);
        n += rkm04_hdlc.put(&sender, 3, frame + n);
        n += rkm04_hdlc.put(&sender, request[i][4], frame + n);
        n += rkm04_hdlc.end(&sender, frame + n);
        expect_store_time(frame, n);
    }
}
END_TEST

START_TEST(P6_store_time_a_wait_is_checked_again_when_the_flash_is_written)
{
    static const uint8_t store[] = {3, '1'};
    uint8_t answer[8];
    READ(.store_time = 50);
    rig_accept(&rig, '1', "O03 T01");
    rig_to(&rig, 100 * MS + 1);
    ck_assert_uint_eq(rkm04_exchange(&rig.unit, store, 2, answer, sizeof answer), 3);
    rig_input_at(&rig, 110 * MS, 3, true);
    rig_to(&rig, 200 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 152 * MS);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER);
}
END_TEST

static Suite *interp_readings_suite(void)
{
    Suite *suite = suite_create("interp_readings");

    TCase *words = tcase_create("words");
    tcase_add_checked_fixture(words, setup, teardown);
    tcase_add_test(words, C7_label_fault_a_jump_to_a_missing_label_is_a_fault);
    tcase_add_test(words, C3_fault_exit_new_new_commands_run_after_a_fault_and_end_it);
    tcase_add_test(words, C3_fault_exit_new_a_text_without_commands_leaves_the_fault);
    tcase_add_test(words, C3_fault_exit_new_loops_and_calls_of_the_faulty_program_are_dropped);
    tcase_add_test(words, E1_fault_exit_new_the_LED_blinks_until_the_next_motion_begins);
    tcase_add_test(words, C3_hold_exit_latch_new_commands_wait_after_the_rest);
    tcase_add_test(words, C3_hold_exit_latch_commands_after_a_total_stop_held_before_they_begin_wait_for_C75);
    tcase_add_test(words, C6_x_after_once_X_has_fired_once_and_lets_new_commands_run);
    tcase_add_test(words, C5_guard_start_step_a_motion_begins_all_the_same_and_is_stopped_in_the_next_slot);
    tcase_add_test(words, C5_guard_start_step_holds_for_a_motion_that_goes_on_too);
    tcase_add_test(words, C4_v_alone_first_only_the_whole_text_is_alone);
    tcase_add_test(words, C3_v_alone_first_K_and_C75_with_blanks_are_ignored);
    tcase_add_test(words, E1_y_eleventh_y_the_eleventh_Y_is_the_error);
    tcase_add_test(words, C1_reset_t41_clear_a_reset_of_any_motor_ends_the_simulation);
    tcase_add_test(words, P1_negative_position_no_a_counter_below_0_is_a_bad_value);
    suite_add_tcase(suite, words);

    TCase *times = tcase_create("times");
    tcase_add_checked_fixture(times, setup, teardown);
    tcase_add_test(times, R1_planning_a_motion_begins_so_much_later_and_the_motor_is_as_in_a_dwell);
    tcase_add_test(times, R1_planning_is_held_and_resumed_as_a_dwell_and_ended_by_X);
    tcase_add_test(times, C5_planning_guards_and_the_table_are_checked_when_the_motion_begins);
    tcase_add_test(times, U2_input_filter_an_input_counts_when_it_has_been_constant_for_so_long);
    tcase_add_test(times, C6_input_filter_delays_X_and_limit_moves);
    tcase_add_test(times, P6_store_time_delays_the_answer_and_all_commands_but_no_pulse);
    tcase_add_test(times, P6_store_time_a_wait_is_checked_again_when_the_flash_is_written);
    suite_add_tcase(suite, times);
    return suite;
}

int main(void)
{
    return rig_run(interp_readings_suite(), "test_interp_readings");
}
