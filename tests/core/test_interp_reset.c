/* SPDX-License-Identifier: MIT */
/* test_interp_reset.c: the reset of a motor, C1 of the specification. */
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

/* From a slot on: F, R, and a whole motion at the start values S100 V1000 A2000. */
static void expect_start_values(size_t n, uint64_t slot)
{
    rig_accept_at(&rig, slot, "F1000 R");
    rig_to(&rig, slot + 3 * SECOND);
    rig_expect_motion(&rig, 1, n, slot + 1 * MS, slot + 1 * MS + move_ticks(100, 1000, 2000, 1000), 1000, true);
}


/* R in slot 2000; in the constant part pulse k falls on 2000 + 450 000 + (k - 247.5) 1000, so pulse 797 on 1 001 500. */
START_TEST(C1_reset_stops_a_motion_without_ramp_between_two_slots)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_to(&rig, 1001501);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 797);
    rig_accept(&rig, '1', "\\");
    struct rkm04_motor_state state = rig_motor(&rig, 1);
    ck_assert_int_eq(state.state, RKM04_IDLE);
    ck_assert_int_eq(state.led, RKM04_LED_OFF);
    ck_assert_uint_eq(state.speed, 0);
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 797);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 797);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    const struct record *end = recorder_event(&rig.record, 1, RKM04_EVENT_MOTION, 0, 1);
    ck_assert_ptr_nonnull(end);
    ck_assert_uint_eq(end->tick, 1001501);
}
END_TEST

START_TEST(C1_a_pulse_due_at_the_tick_of_the_reset_is_not_sent)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1001500); /* the pulse at 1 001 500 would come after the bytes of that tick */
    rig_accept(&rig, '1', "\\");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 796);
}
END_TEST

START_TEST(C1_commands_after_it_are_the_new_program)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1001501, "\\ T02 T03");
    ck_assert_str_eq(rig_program(&rig, 1), "T02 T03");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 1002 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 6);
}
END_TEST

START_TEST(C1_commands_before_it_in_the_message_are_dropped)
{
    rig_accept(&rig, '1', "T01 F10 R \\ T02 \\ T03");
    ck_assert_str_eq(rig_program(&rig, 1), "T03");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 4);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 0);
}
END_TEST

START_TEST(C1_reset_acts_in_every_state)
{
    static const char *const text[] = {"W10000", "O01", "[", ")05", "G+", "J5", "X02 W9", "F9 F8"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_input_at(&rig, 0, 2, true);
        rig_accept(&rig, '1', text[i]);
        rig_accept_at(&rig, 100 * MS + 1, "\\T01");
        rig_to(&rig, 110 * MS);
        ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 101 * MS);
        ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    }
}
END_TEST

START_TEST(C1_reset_ends_a_hold)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1 * SECOND, "K");
    rig_accept_at(&rig, 3 * SECOND, "\\");
    rig_accept_at(&rig, 4 * SECOND, "C75");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rig_motions(&rig, 1), 1);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(C1_reset_concerns_one_motor)
{
    rig_accept(&rig, '0', "F1000 R");
    rig_accept_at(&rig, 500 * MS, "\\");
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_lt(rig_motor(&rig, 1).position, 1000);
    for (unsigned motor = 2; motor <= 4; motor++)
        ck_assert_int_eq(rig_motor(&rig, motor).position, 1000);
}
END_TEST


START_TEST(C1_the_parameters_take_their_start_values)
{
    rig_accept(&rig, '1', "S500 V300 A100 B77");
    rig_accept_at(&rig, 100 * MS, "\\ R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 0); /* step count 0 */
    rig_accept(&rig, '1', "B100");
    rig_accept_at(&rig, 2 * SECOND, "\\");
    expect_start_values(1, 3 * SECOND);
}
END_TEST

START_TEST(C1_the_direction_is_forward_again)
{
    ck_assert(rig.unit.motor[0].forward); /* U8; what `state` of the control socket shows */
    rig_accept(&rig, '1', "F10 D");
    rig_to(&rig, 10 * MS);
    ck_assert(!rig.unit.motor[0].forward);
    rig_accept(&rig, '1', "\\");
    ck_assert(rig.unit.motor[0].forward);
    rig_accept(&rig, '1', "F1000 R");
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 1000);
}
END_TEST

START_TEST(C1_position_outputs_variables_and_simulation_stay)
{
    rig_accept(&rig, '1', "=77 T05 T90 T41");
    rig_accept_at(&rig, 10 * MS, "\\");
    rig_to(&rig, 20 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 77);
    ck_assert_uint_eq(rkm04_variables(&rig.unit), 1u << 10);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept(&rig, '1', "C41");
    rig_to(&rig, 30 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x10);
}
END_TEST

START_TEST(C1_reset_with_C100_clears_program_and_counter)
{
    rig_accept(&rig, '1', "=77 W1000 T01");
    rig_accept_at(&rig, 10 * MS, "\\C100");
    rig_to(&rig, 2 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 0);
    ck_assert_str_eq(rig_program(&rig, 1), "C100");
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C1_the_guards_are_gone)
{
    rig_accept(&rig, '1', "M05 N06 X07");
    rig_accept_at(&rig, 10 * MS, "\\");
    rkm04_set_inputs(&rig.unit, 0x50); /* 5 and 7 at 1, 6 at 0 */
    expect_start_values(1, 20 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(C1_the_table_of_a_compound_motion_is_empty)
{
    rig_accept(&rig, '1', "V300 F10 Y F10 Y");
    rig_accept_at(&rig, 10 * MS, "\\");
    expect_start_values(1, 20 * MS);
}
END_TEST

START_TEST(C1_function_40_is_off)
{
    rig_accept(&rig, '1', "T40");
    rig_accept_at(&rig, 10 * MS, "\\");
    for (int i = 0; i < 700; i++)
        rig_accept(&rig, '1', "U");
    ck_assert_int_eq(rig_set(&rig, '1', "H"), 3);
    const char *program = rig_program(&rig, 1);
    ck_assert_str_eq(program + strlen(program) - 3, "U H");
}
END_TEST

START_TEST(C1_functions_51_to_58_are_off)
{
    rig_accept(&rig, '1', "T51 T58");
    rig_accept_at(&rig, 10 * MS, "\\ F10 Y R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 10);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x81, 1), RKM04_NEVER);
}
END_TEST

START_TEST(C1_loops_and_calls_are_gone)
{
    rig_accept(&rig, '1', "L2 L2 L2 L2 L2 L2 L2 L2 '1 @1 O01");
    rig_accept_at(&rig, 100 * MS, "\\ E");
    rig_to(&rig, 200 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_LOOP);
    rig_accept(&rig, '1', "\\ .");
    rig_to(&rig, 300 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_CALL);
}
END_TEST

START_TEST(C1_labels_are_gone)
{
    rig_accept(&rig, '1', "@1 O01");
    rig_accept_at(&rig, 100 * MS, "\\ J1");
    rig_to(&rig, 200 * MS);
    rig_expect_state(&rig, 1, RKM04_WAIT);
}
END_TEST

START_TEST(C1_a_fault_is_cleared)
{
    rig_accept(&rig, '1', "E");
    rig_to(&rig, 100 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NO_LOOP);
    rig_accept(&rig, '1', "\\");
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NONE);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 0);
}
END_TEST

START_TEST(C1_a_pending_hold_is_dropped)
{
    rig_accept(&rig, '1', "U U U");
    rig_accept_at(&rig, 1001, "K");
    rig_accept(&rig, '1', "\\ U T01");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 3 * MS);
}
END_TEST

START_TEST(C1_a_pending_change_of_speed_is_dropped)
{
    rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings.speed_change = 500});
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1 * SECOND, "V300");
    rig_accept_at(&rig, 1100 * MS, "\\");
    expect_start_values(2, 1200 * MS);
}
END_TEST

static Suite *interp_reset_suite(void)
{
    Suite *suite = suite_create("interp_reset");

    TCase *at_once = tcase_create("at_once");
    tcase_add_checked_fixture(at_once, setup, teardown);
    tcase_add_test(at_once, C1_reset_stops_a_motion_without_ramp_between_two_slots);
    tcase_add_test(at_once, C1_a_pulse_due_at_the_tick_of_the_reset_is_not_sent);
    tcase_add_test(at_once, C1_commands_after_it_are_the_new_program);
    tcase_add_test(at_once, C1_commands_before_it_in_the_message_are_dropped);
    tcase_add_test(at_once, C1_reset_acts_in_every_state);
    tcase_add_test(at_once, C1_reset_ends_a_hold);
    tcase_add_test(at_once, C1_reset_concerns_one_motor);
    suite_add_tcase(suite, at_once);

    TCase *cleared = tcase_create("cleared");
    tcase_add_checked_fixture(cleared, setup, teardown);
    tcase_add_test(cleared, C1_the_parameters_take_their_start_values);
    tcase_add_test(cleared, C1_the_direction_is_forward_again);
    tcase_add_test(cleared, C1_position_outputs_variables_and_simulation_stay);
    tcase_add_test(cleared, C1_reset_with_C100_clears_program_and_counter);
    tcase_add_test(cleared, C1_the_guards_are_gone);
    tcase_add_test(cleared, C1_the_table_of_a_compound_motion_is_empty);
    tcase_add_test(cleared, C1_function_40_is_off);
    tcase_add_test(cleared, C1_functions_51_to_58_are_off);
    tcase_add_test(cleared, C1_loops_and_calls_are_gone);
    tcase_add_test(cleared, C1_labels_are_gone);
    tcase_add_test(cleared, C1_a_fault_is_cleared);
    tcase_add_test(cleared, C1_a_pending_hold_is_dropped);
    tcase_add_test(cleared, C1_a_pending_change_of_speed_is_dropped);
    suite_add_tcase(suite, cleared);

    return suite;
}

int main(void)
{
    return rig_run(interp_reset_suite(), "./test_interp_reset");
}
