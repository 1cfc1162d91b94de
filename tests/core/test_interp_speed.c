/* SPDX-License-Identifier: MIT */
/* test_interp_speed.c: the stand-alone V, C4 of the specification: when it is a change of speed and when a command. */
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

static void with_latency(uint16_t latency)
{
    rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings.speed_change = latency});
}

static uint32_t speed_at(uint64_t tick)
{
    rig_to(&rig, tick);
    return rig_motor(&rig, 1).speed;
}


START_TEST(C4_a_lone_V_changes_the_motion_is_not_stored_and_leaves_the_parameter)
{
    rig_accept(&rig, '1', "F5000 R R");
    rig_accept_at(&rig, 1002 * MS, "{ slower } V500");
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R R");
    ck_assert_uint_eq(speed_at(2 * SECOND), 500);
    rig_to(&rig, 30 * SECOND);
    const struct record *end = recorder_event(&rig.record, 1, RKM04_EVENT_MOTION, 0, 1);
    ck_assert_ptr_nonnull(end);
    rig_expect_motion(&rig, 1, 1, 2 * MS, end->tick, 5000, true);
    uint64_t begin = slot_behind(end->tick);
    rig_expect_motion(&rig, 1, 2, begin, begin + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST

START_TEST(C4_it_may_be_repeated)
{
    rig_accept(&rig, '1', "F20000 R");
    rig_accept_at(&rig, 1 * SECOND, "V500");
    ck_assert_uint_eq(speed_at(2 * SECOND), 500);
    rig_accept(&rig, '1', "V1500");
    ck_assert_uint_eq(speed_at(3 * SECOND), 1500);
    rig_accept(&rig, '1', "V80"); /* below S */
    ck_assert_uint_eq(speed_at(4 * SECOND), 80);
    rig_accept(&rig, '1', "V16000");
    ck_assert_uint_eq(speed_at(5 * SECOND) > 1900, true);
    rig_to(&rig, 60 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 20000);
}
END_TEST

START_TEST(C4_it_works_in_G_H_and_endless_motions)
{
    static const char *const text[] = {"G20000", "=20000 H", "G+", "G-", "F9000 Y Y R", "U U R F20000 R"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', text[i]);
        rig_accept_at(&rig, 1 * SECOND, "V500");
        ck_assert_str_eq(rig_program(&rig, 1), text[i]);
        ck_assert_uint_eq(speed_at(2 * SECOND), 500);
    }
}
END_TEST

START_TEST(C4_on_the_rising_ramp_it_is_a_change_too)
{
    rig_accept(&rig, '1', "F20000 R");
    rig_accept_at(&rig, 102 * MS, "V200"); /* at 300 */
    ck_assert_uint_eq(speed_at(1 * SECOND), 200);
    ck_assert_str_eq(rig_program(&rig, 1), "F20000 R");
}
END_TEST

/* At 100 steps/s or V500 the first segment is under way; the second has its own V. */
START_TEST(C4_in_a_compound_motion_it_is_the_V_of_the_present_segment)
{
    rig_accept(&rig, '1', "V500 F1000 Y V1000 F2000 Y R");
    rig_accept_at(&rig, 1 * SECOND, "V300");
    ck_assert_uint_eq(speed_at(2 * SECOND), 300);
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 3000);
    /* somewhere in the second segment 1000 steps/s are reached: pulses 2000 and 2001 are 1000 us apart */
    ck_assert_uint_eq(recorder_step(&rig.record, 1, 2001) - recorder_step(&rig.record, 1, 2000), 1000);
}
END_TEST

START_TEST(C4_a_V_with_anything_beside_it_is_stored)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1 * SECOND, "V500 U");
    rig_accept_at(&rig, 1001 * MS, "V400 V300");
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R V500 U V400 V300");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 1, 2 * MS, 2 * MS + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST

START_TEST(C4_a_bad_value_is_refused_and_changes_nothing)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_int_eq(rig_set(&rig, '1', "V0"), 1);
    ck_assert_int_eq(rig_set(&rig, '1', "V16001"), 1);
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 1, 2 * MS, 2 * MS + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST


START_TEST(C4_in_a_limit_move_it_is_swallowed)
{
    rig_accept(&rig, '1', ")05");
    rig_accept_at(&rig, 500 * MS, "V50");
    rig_to(&rig, 2001 * MS + 1);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 200);
    ck_assert_str_eq(rig_program(&rig, 1), ")05");
}
END_TEST

START_TEST(C4_in_a_stop_ramp_of_a_guard_it_is_swallowed)
{
    rig_accept(&rig, '1', "M05 F5000 R T01");
    rig_input_at(&rig, 1003 * MS, 5, true);
    rig_accept_at(&rig, 1203 * MS, "V2000");
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion_near(&rig, 1, 1, 3 * MS, 1453 * MS, 1045, true);
    ck_assert_str_eq(rig_program(&rig, 1), "M05 F5000 R T01");
}
END_TEST

START_TEST(C4_in_the_ramp_of_K_it_is_swallowed_and_the_hold_stays)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 1202 * MS, "V500");
    rig_to(&rig, 5 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_HELD);
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R T01");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 2, 5 * SECOND, 5 * SECOND + move_ticks(100, 1000, 2000, 3955), 3955, true);
}
END_TEST


START_TEST(C4_without_a_motion_it_is_an_ordinary_command)
{
    rig_accept(&rig, '1', "V500");
    ck_assert_str_eq(rig_program(&rig, 1), "V500");
    rig_accept_at(&rig, 10 * MS, "F1000 R");
    rig_to(&rig, 5 * SECOND);
    rig_expect_motion(&rig, 1, 1, 11 * MS, 11 * MS + move_ticks(100, 500, 2000, 1000), 1000, true);
}
END_TEST

START_TEST(C4_in_dwell_wait_and_block_it_is_an_ordinary_command)
{
    static const char *const text[] = {"W1000", "O01", "["};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', text[i]);
        rig_accept_at(&rig, 100 * MS, "V500");
        ck_assert_uint_eq(rig_motor(&rig, 1).commands, 2);
    }
}
END_TEST

START_TEST(C4_between_the_last_pulse_and_the_next_slot_it_is_an_ordinary_command)
{
    rig_accept(&rig, '1', "F1000 R");
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 1000);
    rig_accept_at(&rig, end + 1, "V500");
    ck_assert_str_eq(rig_program(&rig, 1), "F1000 R V500");
}
END_TEST

START_TEST(C4_before_the_slot_of_the_motion_it_is_an_ordinary_command)
{
    rig_accept(&rig, '1', "F1000 R");
    rig_accept_at(&rig, 1999, "V500");
    ck_assert_str_eq(rig_program(&rig, 1), "F1000 R V500");
}
END_TEST

START_TEST(C4_in_a_hold_it_is_an_ordinary_command_and_ends_the_hold)
{
    rig_accept(&rig, '1', "F5000 R T01");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "V500");
    ck_assert_str_eq(rig_program(&rig, 1), "F5000 R T01 V500");
    rig_to(&rig, 4 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_IDLE);
    rig_accept(&rig, '1', "F1000 R");
    rig_to(&rig, 10 * SECOND);
    rig_expect_motion(&rig, 1, 2, 4001 * MS, 4001 * MS + move_ticks(100, 500, 2000, 1000), 1000, true);
}
END_TEST

START_TEST(C4_a_motion_resumed_keeps_the_speed_in_force)
{
    rig_accept(&rig, '1', "F5000 R R");
    rig_accept_at(&rig, 1002 * MS, "V500");
    rig_accept_at(&rig, 2 * SECOND, "K");
    rig_to(&rig, 4 * SECOND);
    uint32_t done = rig_motor(&rig, 1).steps, rest = 5000 - done;
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 40 * SECOND);
    uint64_t end = 4 * SECOND + move_ticks(100, 500, 2000, rest);
    rig_expect_motion(&rig, 1, 2, 4 * SECOND, end, rest, true);
    uint64_t begin = slot_behind(end); /* and the next motion is as it was written */
    rig_expect_motion(&rig, 1, 3, begin, begin + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST


START_TEST(R6_a_stop_in_the_slot_of_a_change_at_once_starts_from_the_new_speed)
{
    rig_accept(&rig, '1', "S1000 V640 F2000 R"); /* begins at 4 ms: 318.08 steps at 501 ms */
    rig_accept_at(&rig, 500372, "V74");
    rig_accept_at(&rig, 500400, "K");
    rig_to(&rig, 2 * SECOND);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), 319);
    rig_expect_motion_near(&rig, 1, 1, 4 * MS, 501 * MS + 12433, 319, true); /* 0.92 step at 74/s */
}
END_TEST

START_TEST(C4_the_delay_passes_before_the_change)
{
    with_latency(2000);
    rig_accept(&rig, '1', "F20000 R");
    rig_accept_at(&rig, 1 * SECOND, "V500");
    ck_assert_uint_eq(speed_at(3 * SECOND), 1000);
    ck_assert_uint_lt(speed_at(3002 * MS), 1000);
    ck_assert_uint_eq(speed_at(4 * SECOND), 500);
}
END_TEST

START_TEST(C4_the_first_deadline_counts_and_the_last_value_wins)
{
    with_latency(500);
    rig_accept(&rig, '1', "F20000 R");
    rig_accept_at(&rig, 1 * SECOND, "V500");
    rig_accept_at(&rig, 1400 * MS, "V300");
    ck_assert_uint_eq(speed_at(1500 * MS), 1000);
    ck_assert_uint_lt(speed_at(1502 * MS), 1000);
    ck_assert_uint_eq(speed_at(2 * SECOND), 300);
    ck_assert_uint_eq(speed_at(5 * SECOND), 300);
}
END_TEST

START_TEST(C4_a_second_change_after_the_first_has_its_own_deadline)
{
    with_latency(500);
    rig_accept(&rig, '1', "F20000 R");
    rig_accept_at(&rig, 1 * SECOND, "V500");
    rig_accept_at(&rig, 2 * SECOND, "V300");
    ck_assert_uint_eq(speed_at(2500 * MS), 500);
    ck_assert_uint_lt(speed_at(2502 * MS), 500);
    ck_assert_uint_eq(speed_at(3 * SECOND), 300);
}
END_TEST

START_TEST(C4_K_drops_a_pending_change)
{
    with_latency(500);
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 902 * MS, "V500");
    rig_accept_at(&rig, 1002 * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    rig_expect_motion(&rig, 1, 2, 3 * SECOND, 3 * SECOND + move_ticks(100, 1000, 2000, 3955), 3955, true);
}
END_TEST

START_TEST(C4_a_change_whose_motion_is_over_does_not_touch_the_next_one)
{
    with_latency(2000);
    rig_accept(&rig, '1', "F1000 R F5000 R");
    rig_accept_at(&rig, 1 * SECOND, "V300");
    rig_to(&rig, 20 * SECOND);
    uint64_t begin = slot_behind(2 * MS + move_ticks(100, 1000, 2000, 1000)) + 1 * MS;
    rig_expect_motion(&rig, 1, 2, begin, begin + move_ticks(100, 1000, 2000, 5000), 5000, true);
}
END_TEST

START_TEST(C4_V_after_K_in_its_slot_comes_to_the_stop_ramp)
{
    static const char *const first[] = {"V300", "U"}; /* with and without a change before K */
    for (size_t i = 0; i < 2; i++) {
        rig_power_up(&rig, &(struct rkm04_config){.node = 1});
        rig_accept(&rig, '1', "F5000 R");
        rig_accept_at(&rig, 2000 * MS + 100, first[i]);
        rig_accept_at(&rig, 2000 * MS + 200, "K");
        rig_accept_at(&rig, 2000 * MS + 500, "V200");
        rig_accept_at(&rig, 4 * SECOND, "C75");
        rig_to(&rig, 5 * SECOND);
        ck_assert_uint_eq(rig_motor(&rig, 1).speed, i == 0 ? 300 : 1000);
    }
}
END_TEST

static Suite *interp_speed_suite(void)
{
    Suite *suite = suite_create("interp_speed");

    TCase *motion = tcase_create("motion");
    tcase_add_checked_fixture(motion, setup, teardown);
    tcase_add_test(motion, C4_a_lone_V_changes_the_motion_is_not_stored_and_leaves_the_parameter);
    tcase_add_test(motion, C4_it_may_be_repeated);
    tcase_add_test(motion, C4_V_after_K_in_its_slot_comes_to_the_stop_ramp);
    tcase_add_test(motion, C4_it_works_in_G_H_and_endless_motions);
    tcase_add_test(motion, C4_on_the_rising_ramp_it_is_a_change_too);
    tcase_add_test(motion, C4_in_a_compound_motion_it_is_the_V_of_the_present_segment);
    tcase_add_test(motion, R6_a_stop_in_the_slot_of_a_change_at_once_starts_from_the_new_speed);
    tcase_add_test(motion, C4_a_V_with_anything_beside_it_is_stored);
    tcase_add_test(motion, C4_a_bad_value_is_refused_and_changes_nothing);
    suite_add_tcase(suite, motion);

    TCase *swallowed = tcase_create("swallowed");
    tcase_add_checked_fixture(swallowed, setup, teardown);
    tcase_add_test(swallowed, C4_in_a_limit_move_it_is_swallowed);
    tcase_add_test(swallowed, C4_in_a_stop_ramp_of_a_guard_it_is_swallowed);
    tcase_add_test(swallowed, C4_in_the_ramp_of_K_it_is_swallowed_and_the_hold_stays);
    suite_add_tcase(suite, swallowed);

    TCase *stored = tcase_create("stored");
    tcase_add_checked_fixture(stored, setup, teardown);
    tcase_add_test(stored, C4_without_a_motion_it_is_an_ordinary_command);
    tcase_add_test(stored, C4_in_dwell_wait_and_block_it_is_an_ordinary_command);
    tcase_add_test(stored, C4_between_the_last_pulse_and_the_next_slot_it_is_an_ordinary_command);
    tcase_add_test(stored, C4_before_the_slot_of_the_motion_it_is_an_ordinary_command);
    tcase_add_test(stored, C4_in_a_hold_it_is_an_ordinary_command_and_ends_the_hold);
    tcase_add_test(stored, C4_a_motion_resumed_keeps_the_speed_in_force);
    suite_add_tcase(suite, stored);

    TCase *latency = tcase_create("latency");
    tcase_add_checked_fixture(latency, setup, teardown);
    tcase_add_test(latency, C4_the_delay_passes_before_the_change);
    tcase_add_test(latency, C4_the_first_deadline_counts_and_the_last_value_wins);
    tcase_add_test(latency, C4_a_second_change_after_the_first_has_its_own_deadline);
    tcase_add_test(latency, C4_K_drops_a_pending_change);
    tcase_add_test(latency, C4_a_change_whose_motion_is_over_does_not_touch_the_next_one);
    suite_add_tcase(suite, latency);

    return suite;
}

int main(void)
{
    return rig_run(interp_speed_suite(), "./test_interp_speed");
}
