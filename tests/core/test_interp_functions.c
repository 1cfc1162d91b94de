/* SPDX-License-Identifier: MIT */
/* test_interp_functions.c: simulation, outputs of compound motions, G, H, Y, the LED: C11, C12, C13, E1, U6, R7, R8. */
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

static uint64_t led_became(enum rkm04_led led, size_t n)
{
    const struct record *record = recorder_event(&rig.record, 1, RKM04_EVENT_LED, led, n);
    return record ? record->tick : RKM04_NEVER;
}

static void expect_lit(uint64_t tick, bool lit)
{
    rig_to(&rig, tick);
    ck_assert_msg(rig_motor(&rig, 1).lit == lit, "the LED is %s at %llu", lit ? "dark" : "bright", (unsigned long long)tick);
}


START_TEST(C11_in_simulation_no_pulse_leaves_the_unit_and_the_counter_counts)
{
    rig_accept(&rig, '1', "T41 F1000 R T01 B400 R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(0);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 600);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    for (size_t i = 0; i < rig.record.count; i++)
        ck_assert(rig.record.list[i].kind != RECORD_OUTPUTS || rig.record.list[i].value == 0);
}
END_TEST

START_TEST(C11_the_program_keeps_its_times_in_simulation)
{
    rig_accept(&rig, '1', "T41 F1000 R T80");
    rig_to(&rig, 10 * SECOND);
    const struct record *end = recorder_event(&rig.record, 1, RKM04_EVENT_MOTION, 0, 1);
    ck_assert_ptr_nonnull(end);
    ck_assert_uint_eq(end->tick, 3 * MS + move_ticks(100, 1000, 2000, 1000));
    const struct record *variable = recorder_event(&rig.record, 0, RKM04_EVENT_VARIABLE, 1, 1);
    ck_assert_ptr_nonnull(variable);
    ck_assert_uint_eq(variable->tick, slot_behind(end->tick));
}
END_TEST

START_TEST(C11_the_output_register_is_kept_and_shows_again)
{
    rig_accept(&rig, '1', "T01 T41 T02 C01 T03 C41");
    rig_to(&rig, 1 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_to(&rig, 2 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_to(&rig, 5 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_to(&rig, 6 * MS + 1);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 6);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0, 1), 2 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 6, 1), 6 * MS);
}
END_TEST

START_TEST(C11_simulation_is_common_to_the_unit)
{
    rig_accept(&rig, '1', "T41");
    rig_accept(&rig, '3', "F1000 R T05 W10000 C41");
    rig_accept(&rig, '2', "W5000 F100 R");
    rig_to(&rig, 4 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 3), 0);
    ck_assert_int_eq(rig_motor(&rig, 3).position, 1000);
    rig_accept(&rig, '1', "C41");
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0x10);
    ck_assert_uint_eq(recorder_steps(&rig.record, 2), 100);
}
END_TEST

/* Constant 100 steps/s from slot 2000 on: T41 in slot 502 000, C41 in slot 1 002 000. */
START_TEST(C11_simulation_may_begin_and_end_within_a_motion)
{
    rig_accept(&rig, '1', "V100 F1000 R");
    rig_accept(&rig, '2', "W502 T41 W499 C41");
    rig_to(&rig, 20 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 1000);
    expect_steps(1000 - 50);
    uint64_t silent = 503 * MS, loud = 1003 * MS;
    for (size_t i = 0; i < rig.record.count; i++) {
        const struct record *record = &rig.record.list[i];
        ck_assert(record->kind != RECORD_STEP || record->tick <= silent || record->tick > loud);
    }
}
END_TEST

START_TEST(C11_the_direction_output_is_0_in_simulation)
{
    rig_accept(&rig, '1', "T41 B10 R F10 R B10 R");
    rig_to(&rig, 5 * SECOND);
    for (size_t i = 0; i < rig.record.count; i++) {
        const struct record *record = &rig.record.list[i];
        ck_assert(record->kind != RECORD_DIRECTION || record->tick <= 1 * MS || record->value == 0);
    }
    ck_assert(!rig_motor(&rig, 1).forward);
}
END_TEST

START_TEST(C11_T40_and_T51_belong_to_the_motor)
{
    rig_accept(&rig, '1', "T51");
    rig_accept(&rig, '2', "W10 V1000 F10 Y R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_int_eq(rig_motor(&rig, 2).position, 10);
}
END_TEST

START_TEST(C11_T42_to_T50_are_accepted_and_have_no_effect)
{
    rig_accept(&rig, '1', "T42 T43 T44 T45 T46 T47 T48 T49 T50 C42 C43 C44 C45 C46 C47 C48 C49 C50 T01 T45 F1000 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 19 * MS);
    expect_steps(1000);
}
END_TEST


/* At constant 100 steps/s: pulse k 10 000 k after R. */
START_TEST(C12_the_output_is_set_at_the_last_pulse_before_the_last_segment)
{
    rig_accept(&rig, '1', "T53 V100 F10 Y F20 Y F5 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 4, 1), recorder_step(&rig.record, 1, 30));
    ck_assert_uint_eq(rig_outputs_became(&rig, 4, 1), 9 * MS + 300 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 4);
}
END_TEST

START_TEST(C12_with_one_segment_it_is_set_in_the_slot_of_R)
{
    rig_accept(&rig, '1', "T58 F100 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x80, 1), 4 * MS);
}
END_TEST

START_TEST(C12_several_functions_set_several_outputs_at_once)
{
    rig_accept(&rig, '1', "T02 T51 T54 T58 V100 F10 Y Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x8B, 1), recorder_step(&rig.record, 1, 10));
}
END_TEST

START_TEST(C12_a_function_set_after_the_first_Y_comes_too_late)
{
    rig_accept(&rig, '1', "T51 V100 F10 Y T52 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C12_a_function_cleared_before_R_sets_nothing)
{
    rig_accept(&rig, '1', "T51 T52 V100 F10 Y C51 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 2);
}
END_TEST

START_TEST(C12_clearing_the_function_does_not_clear_the_output)
{
    rig_accept(&rig, '1', "T51 F10 Y R C51");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    rig_accept(&rig, '1', "C01");
    rig_to(&rig, 6 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(C12_the_function_stays_on_for_the_next_compound_motion)
{
    rig_accept(&rig, '1', "T51 F10 Y R C01 Y R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(C12_a_single_motion_sets_no_output)
{
    rig_accept(&rig, '1', "T51 F10 R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

/* Constant 100 steps/s from slot 7000 on, the output is on from step 10; held near step 30, the output taken away by hand. */
START_TEST(C12_it_is_not_set_again_after_a_hold)
{
    rig_accept(&rig, '1', "T51 V100 F10 Y F90 Y R");
    rig_accept(&rig, '2', "W500 C01");
    rig_accept_at(&rig, 307 * MS, "K");
    rig_accept_at(&rig, 1 * SECOND, "C75");
    rig_to(&rig, 10 * SECOND);
    expect_steps(100);
    ck_assert_uint_ne(rig_outputs_became(&rig, 1, 1), RKM04_NEVER);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 2), RKM04_NEVER);
}
END_TEST

START_TEST(C12_held_before_the_last_segment_it_is_set_when_the_segment_comes)
{
    rig_accept(&rig, '1', "T51 V100 F50 Y F50 Y R");
    rig_accept_at(&rig, 307 * MS, "K");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 10 * SECOND);
    expect_steps(100);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), recorder_step(&rig.record, 1, 50));
}
END_TEST

START_TEST(C12_a_motion_stopped_before_the_last_segment_sets_nothing)
{
    rig_accept(&rig, '1', "M05 T51 V100 F50 Y F50 Y R");
    rig_input_at(&rig, 308 * MS, 5, true);
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST


START_TEST(C13_R_without_a_step_count_does_nothing)
{
    rig_accept(&rig, '1', "R T01");
    rig_to(&rig, 1 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 2 * MS);
    ck_assert_uint_eq(rig_motions(&rig, 1), 0);
}
END_TEST

START_TEST(C13_G_sets_count_and_direction_to_the_difference)
{
    rig_accept(&rig, '1', "=1000 G400 R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(1200);
    ck_assert_int_eq(rig_motor(&rig, 1).position, -200);
}
END_TEST

START_TEST(C13_G_to_the_present_position_makes_a_later_R_do_nothing)
{
    rig_accept(&rig, '1', "F100 =1000 G1000 R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(0);
}
END_TEST

START_TEST(C13_H_endless_and_limit_moves_leave_count_and_direction_alone)
{
    rig_accept(&rig, '1', "S2000 V2000 F100 =-7 H R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 100);
    rig_accept(&rig, '1', "(05");
    rig_input_at(&rig, 1100 * MS, 5, true);
    rig_to(&rig, 2 * SECOND);
    int32_t position = rig_motor(&rig, 1).position;
    ck_assert_int_lt(position, 0);
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 3 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, position + 100);
    rig_input_at(&rig, 3 * SECOND, 5, false);
    rig_accept(&rig, '1', "M05 G-");
    rig_input_at(&rig, 3100 * MS, 5, true);
    rig_to(&rig, 4 * SECOND);
    position = rig_motor(&rig, 1).position;
    rig_accept(&rig, '1', "R");
    rig_to(&rig, 5 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, position + 100);
}
END_TEST

START_TEST(C13_G_H_and_limit_moves_leave_the_table_alone)
{
    rig_accept(&rig, '1', "V100 F30 Y G5 H F40 Y )05 R");
    rig_input_at(&rig, 0, 5, true);
    rig_to(&rig, 10 * SECOND);
    expect_steps(5 + 5 + 70);
}
END_TEST

START_TEST(C13_the_table_is_used_up_by_its_R)
{
    rig_accept(&rig, '1', "V100 F30 Y F40 Y R F7 R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(77);
}
END_TEST

START_TEST(C13_the_table_is_used_up_even_when_a_guard_allows_no_step)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "M05 V100 F30 Y F40 Y R F7 R");
    rig_to(&rig, 10 * SECOND);
    expect_steps(7);
}
END_TEST

START_TEST(C13_D_turns_the_direction_of_the_next_motion)
{
    rig_accept(&rig, '1', "B10 D R D R D D R");
    rig_to(&rig, 10 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, -10);
    expect_steps(30);
}
END_TEST

START_TEST(R8_the_counter_wraps_in_two_s_complement)
{
    rig.unit.motor[0].position = INT32_MAX - 3; /* it would take 147 million steps from the largest = */
    rig_accept(&rig, '1', "F10 R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, INT32_MIN + 6);
    ck_assert_str_eq(rig_ask(&rig, 4, 1), "\x0B" "-2147483642");
    rig.unit.motor[1].position = INT32_MIN + 3;
    rig_accept(&rig, '2', "B10 R");
    rig_to(&rig, 2 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 2).position, INT32_MAX - 6);
}
END_TEST

START_TEST(R7_the_direction_is_settled_20_us_before_the_first_pulse)
{
    bool forward = rig_motor(&rig, 1).forward;
    rig_accept(&rig, '1', "S2000 V16000 A60000 B10 R D R D R");
    rig_to(&rig, 1 * SECOND);
    uint64_t pulse = 0, direction = 0;
    int64_t position = 0;
    for (size_t i = 0; i < rig.record.count; i++) {
        const struct record *record = &rig.record.list[i];
        if (record->kind == RECORD_DIRECTION) {
            ck_assert_uint_ge(record->tick, pulse + (pulse ? 20 : 0)); /* 10 us of pulse, kept 10 us after it */
            direction = record->tick;
            forward = record->value;
        } else if (record->kind == RECORD_STEP) {
            ck_assert_uint_ge(record->tick, direction + 20);
            ck_assert_int_eq(record->value - position, forward ? 1 : -1);
            position = record->value;
            pulse = record->tick;
        }
    }
    expect_steps(30);
}
END_TEST


static void expect_impossible(const char *text, uint64_t slot)
{
    rig_power_up(&rig, NULL);
    rig_accept(&rig, '1', text);
    rig_to(&rig, 5 * SECOND);
    expect_steps(0);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    struct rkm04_motor_state state = rig_motor(&rig, 1);
    ck_assert_int_eq(state.state, RKM04_FAULTY);
    ck_assert_int_eq(state.fault, RKM04_FAULT_MOTION);
    ck_assert_int_eq(state.led, RKM04_LED_BLINK);
    ck_assert_uint_eq(led_became(RKM04_LED_BLINK, 1), slot);
    ck_assert_uint_eq(state.index, slot / MS);
}

START_TEST(E1_a_table_with_two_directions_cannot_be_computed)
{
    expect_impossible("F10 Y B10 Y R T01", 5 * MS);
    expect_impossible("F10 Y D Y R T01", 5 * MS);
}
END_TEST

START_TEST(E1_a_table_with_eleven_segments_cannot_be_computed)
{
    expect_impossible("F10 Y Y Y Y Y Y Y Y Y Y Y R T01", 13 * MS);
    expect_impossible("F10 Y Y Y Y Y Y Y Y Y Y Y Y Y Y Y Y R T01", 18 * MS);
    char text[600] = "F10 ";
    for (unsigned i = 0; i < 261; i++)
        strcat(text, "Y ");
    expect_impossible(strcat(text, "R T01"), 263 * MS);
}
END_TEST

START_TEST(E1_ten_segments_can_be_computed)
{
    rig_accept(&rig, '1', "F10 Y Y Y Y Y Y Y Y Y Y R T01");
    rig_to(&rig, 5 * SECOND);
    expect_steps(100);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
}
END_TEST

START_TEST(E1_a_segment_without_steps_cannot_be_computed)
{
    expect_impossible("Y R T01", 2 * MS);
    expect_impossible("Y F10 Y R T01", 4 * MS);
}
END_TEST

/* More than ten times the most that F takes: only a way that G has left behind can be so long. */
START_TEST(E1_a_table_of_more_than_160_million_steps_cannot_be_computed)
{
    expect_impossible("N01 G160000000 Y F1 Y R T01", 6 * MS);
    expect_impossible("F1 Y N01 G160000000 Y R T01", 6 * MS);
    rig_power_up(&rig, NULL);
    rig_accept(&rig, '1', "N01 G159999999 Y F1 Y R");
    rig_to(&rig, 1 * SECOND);
    rig_expect_state(&rig, 1, RKM04_MOVING);
}
END_TEST

START_TEST(E1_Y_itself_never_fails)
{
    rig_accept(&rig, '1', "Y F10 Y B10 Y Y Y Y Y Y Y Y Y Y Y T01");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 1);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
}
END_TEST

START_TEST(E1_the_program_cannot_be_resumed)
{
    expect_impossible("Y R T01", 2 * MS);
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 6 * SECOND);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

START_TEST(E1_the_LED_blinks_until_a_reset)
{
    expect_impossible("Y R T01", 2 * MS);
    rig_accept(&rig, '1', "F1000 R");
    rig_to(&rig, 10 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_BLINK);
    rig_accept(&rig, '1', "\\");
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_OFF);
    ck_assert_uint_eq(led_became(RKM04_LED_OFF, 1), 10 * SECOND);
}
END_TEST


START_TEST(U6_blinking_is_half_a_second_bright_then_half_a_second_dark)
{
    rig_accept(&rig, '1', "Y R");
    for (uint64_t second = 0; second < 3; second++) {
        uint64_t from = 2 * MS + second * SECOND;
        expect_lit(from + 1, true);
        expect_lit(from + 499999, true);
        expect_lit(from + 500000, false);
        expect_lit(from + 999999, false);
    }
}
END_TEST

START_TEST(U6_the_LED_is_on_from_the_slot_of_the_motion_to_its_last_pulse)
{
    rig_accept(&rig, '1', "F1000 R W100 R");
    rig_to(&rig, 10 * SECOND);
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 1000), second = slot_behind(end) + 100 * MS;
    ck_assert_uint_eq(led_became(RKM04_LED_ON, 1), 2 * MS);
    ck_assert_uint_eq(led_became(RKM04_LED_OFF, 1), end);
    ck_assert_uint_eq(led_became(RKM04_LED_ON, 2), second);
    ck_assert_uint_eq(led_became(RKM04_LED_OFF, 2), second + move_ticks(100, 1000, 2000, 1000));
}
END_TEST

START_TEST(U6_the_LED_is_on_between_slow_pulses_and_in_simulation)
{
    rig_accept(&rig, '1', "T41 S1 V1 F3 R");
    expect_lit(5 * MS + 1, true);
    expect_lit(1500 * MS, true);
    expect_lit(2999 * MS, true);
    expect_lit(4 * SECOND, false);
}
END_TEST

START_TEST(U6_the_LED_is_off_in_a_hold)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1002 * MS, "K");
    expect_lit(1100 * MS, true); /* on the ramp */
    expect_lit(2 * SECOND, false);
    rig_accept(&rig, '1', "C75");
    expect_lit(2001 * MS, true);
}
END_TEST

START_TEST(U6_a_motion_without_steps_does_not_light_the_LED)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', "R H M05 F10 R )05");
    rig_to(&rig, 1 * SECOND);
    ck_assert_uint_eq(led_became(RKM04_LED_ON, 1), RKM04_NEVER);
}
END_TEST

static Suite *interp_functions_suite(void)
{
    Suite *suite = suite_create("interp_functions");

    TCase *simulation = tcase_create("simulation");
    tcase_add_checked_fixture(simulation, setup, teardown);
    tcase_add_test(simulation, C11_in_simulation_no_pulse_leaves_the_unit_and_the_counter_counts);
    tcase_add_test(simulation, C11_the_program_keeps_its_times_in_simulation);
    tcase_add_test(simulation, C11_the_output_register_is_kept_and_shows_again);
    tcase_add_test(simulation, C11_simulation_is_common_to_the_unit);
    tcase_add_test(simulation, C11_simulation_may_begin_and_end_within_a_motion);
    tcase_add_test(simulation, C11_the_direction_output_is_0_in_simulation);
    tcase_add_test(simulation, C11_T40_and_T51_belong_to_the_motor);
    tcase_add_test(simulation, C11_T42_to_T50_are_accepted_and_have_no_effect);
    suite_add_tcase(suite, simulation);

    TCase *outputs = tcase_create("outputs");
    tcase_add_checked_fixture(outputs, setup, teardown);
    tcase_add_test(outputs, C12_the_output_is_set_at_the_last_pulse_before_the_last_segment);
    tcase_add_test(outputs, C12_with_one_segment_it_is_set_in_the_slot_of_R);
    tcase_add_test(outputs, C12_several_functions_set_several_outputs_at_once);
    tcase_add_test(outputs, C12_a_function_set_after_the_first_Y_comes_too_late);
    tcase_add_test(outputs, C12_a_function_cleared_before_R_sets_nothing);
    tcase_add_test(outputs, C12_clearing_the_function_does_not_clear_the_output);
    tcase_add_test(outputs, C12_the_function_stays_on_for_the_next_compound_motion);
    tcase_add_test(outputs, C12_a_single_motion_sets_no_output);
    tcase_add_test(outputs, C12_it_is_not_set_again_after_a_hold);
    tcase_add_test(outputs, C12_held_before_the_last_segment_it_is_set_when_the_segment_comes);
    tcase_add_test(outputs, C12_a_motion_stopped_before_the_last_segment_sets_nothing);
    suite_add_tcase(suite, outputs);

    TCase *positions = tcase_create("positions");
    tcase_add_checked_fixture(positions, setup, teardown);
    tcase_add_test(positions, C13_R_without_a_step_count_does_nothing);
    tcase_add_test(positions, C13_G_sets_count_and_direction_to_the_difference);
    tcase_add_test(positions, C13_G_to_the_present_position_makes_a_later_R_do_nothing);
    tcase_add_test(positions, C13_H_endless_and_limit_moves_leave_count_and_direction_alone);
    tcase_add_test(positions, C13_G_H_and_limit_moves_leave_the_table_alone);
    tcase_add_test(positions, C13_the_table_is_used_up_by_its_R);
    tcase_add_test(positions, C13_the_table_is_used_up_even_when_a_guard_allows_no_step);
    tcase_add_test(positions, C13_D_turns_the_direction_of_the_next_motion);
    tcase_add_test(positions, R8_the_counter_wraps_in_two_s_complement);
    tcase_add_test(positions, R7_the_direction_is_settled_20_us_before_the_first_pulse);
    suite_add_tcase(suite, positions);

    TCase *impossible = tcase_create("impossible");
    tcase_add_checked_fixture(impossible, setup, teardown);
    tcase_add_test(impossible, E1_a_table_with_two_directions_cannot_be_computed);
    tcase_add_test(impossible, E1_a_table_with_eleven_segments_cannot_be_computed);
    tcase_add_test(impossible, E1_ten_segments_can_be_computed);
    tcase_add_test(impossible, E1_a_segment_without_steps_cannot_be_computed);
    tcase_add_test(impossible, E1_a_table_of_more_than_160_million_steps_cannot_be_computed);
    tcase_add_test(impossible, E1_Y_itself_never_fails);
    tcase_add_test(impossible, E1_the_program_cannot_be_resumed);
    tcase_add_test(impossible, E1_the_LED_blinks_until_a_reset);
    suite_add_tcase(suite, impossible);

    TCase *led = tcase_create("led");
    tcase_add_checked_fixture(led, setup, teardown);
    tcase_add_test(led, U6_blinking_is_half_a_second_bright_then_half_a_second_dark);
    tcase_add_test(led, U6_the_LED_is_on_from_the_slot_of_the_motion_to_its_last_pulse);
    tcase_add_test(led, U6_the_LED_is_on_between_slow_pulses_and_in_simulation);
    tcase_add_test(led, U6_the_LED_is_off_in_a_hold);
    tcase_add_test(led, U6_a_motion_without_steps_does_not_light_the_LED);
    suite_add_tcase(suite, led);

    return suite;
}

int main(void)
{
    return rig_run(interp_functions_suite(), "./test_interp_functions");
}
