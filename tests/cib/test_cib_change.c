/* SPDX-License-Identifier: MIT */
/* Worked examples of the CIB module: motions that change on the way, X9-X13, X15, X17-X27, X30, X32. As in test_cib_motion.c. */
#include <check.h>

#include "cib_rig.h"

static void setup(void)
{
    cib_power_up(&cib_example);
}

static void power_up_with(uint16_t start_speed, uint16_t acceleration, uint16_t deceleration)
{
    struct cib_config config = cib_example;
    config.setup.drive[A] = (struct cib_drive_setup){20, start_speed, 1000, acceleration, deceleration, 1};
    cib_power_up(&config);
}

/* A command in the slot t. */
static void slot(int64_t t, uint16_t number, int32_t p1, uint16_t p2)
{
    at(t);
    command(A, number, p1, p2);
}

/* ---- Speed mode ---- */

START_TEST(X9_the_speed_falls)
{
    slot(0, 105, 500, 0);
    slot(3000000, 105, 300, 0);
    at(4000000);
    expect_speed(400);
    at(6000001);
    expect_status(2999999, 0x25);
    expect_status(3000000, 0x21);
    expect_position(4000000, 1550);
    expect_status(4999999, 0x21);
    expect_status(5000000, 0x25);
    expect_position(5000000, 1900);
    expect_position(6000000, 2200);
}
END_TEST

START_TEST(X9_the_speed_rises)
{
    slot(0, 105, 300, 0);
    slot(3000000, 105, 500, 0);
    at(5000000);
    expect_status(999999, 0x21);
    expect_status(1000000, 0x25);
    expect_position(1000000, 200);
    expect_status(3999999, 0x21);
    expect_status(4000000, 0x25);
    expect_position(4000000, 1200);
}
END_TEST

START_TEST(X10_a_turn_in_speed_mode)
{
    slot(0, 105, 500, 0);
    slot(3000000, 105, -500, 0);
    slot(12000000, 108, 0, 0);
    at(17000000);
    expect_reached(2300, 7000000, 0);
    expect_status(6999999, 0x21);
    expect_status(7000000, 0x23);
    expect_pulse(2301, 7009902, 0);
    expect_pulse(2302, 7019616, 0);
    expect_status(8999999, 0x23);
    expect_status(9000000, 0x27);
    expect_position(9000000, 1700);
    expect_position(12000000, 200);
    expect_status(12000000, 0x23);
    expect_reached(-1000, 16000000, 0);
    expect_status(15999999, 0x23);
    expect_status(16000000, 0x22);
    ck_assert_int_eq(position(), -1000);
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 2); /* a turn is no end */
}
END_TEST

START_TEST(X17_a_stop_on_the_way_up)
{
    slot(0, 105, 500, 0);
    at(1000000);
    expect_speed(300);
    command(A, 108, 0, 0);
    at(4000000);
    expect_position(1000000, 200);
    expect_pulse(201, 1003336, 1);
    expect_pulse(600, 3000000, 0);
    ck_assert_uint_eq(pulses(), 600);
    expect_status(2999999, 0x21);
    expect_status(3000000, 0x20);
}
END_TEST

START_TEST(X18_a_stop_at_no_whole_place)
{
    power_up_with(100, 240, 70);
    slot(0, 105, 700, 0);
    slot(700000, 108, 0, 0);
    at(4000000);
    expect_position(700000, 128);
    ck_assert_uint_eq(pulses(), 571);
    expect_pulse(571, 3106000, 1);
}
END_TEST

START_TEST(X15_a_stop_at_a_slow_speed)
{
    slot(0, 105, 50, 0);
    slot(50000, 108, 0, 0);
    at(100000);
    expect_status(-1, 0x20);
    expect_status(0, 0x25);
    expect_status(50000, 0x21);
    expect_pulse(1, 20000, 0);
    expect_pulse(2, 40000, 0);
    expect_pulse(3, 60000, 0);
    ck_assert_uint_eq(pulses(), 3);
    expect_status(59999, 0x21);
    expect_status(60000, 0x20);
}
END_TEST

START_TEST(X15_a_stop_at_a_pulse)
{
    slot(0, 105, 50, 0);
    slot(60000, 108, 0, 0);
    ck_assert_uint_eq(pulses(), 2);
    at(100000);
    ck_assert_uint_eq(pulses(), 3);
    expect_pulse(3, 60000, 0);
    expect_status(59999, 0x25);
    expect_status(60000, 0x20);
}
END_TEST

START_TEST(X26_a_turn_revoked)
{
    slot(0, 105, 500, 0);
    slot(3000000, 105, -500, 0);
    at(5000000);
    expect_speed(300);
    command(A, 105, 400, 0);
    at(6000000);
    expect_position(5000000, 1900);
    expect_status(5000000, 0x21);
    expect_status(5499999, 0x21);
    expect_status(5500000, 0x25);
    expect_position(5500000, 2075);
}
END_TEST

/* ---- Position mode ---- */

START_TEST(X11_the_target_changes_twice)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 2600, 300);
    slot(5500000, 101, 4000, 600);
    at(7000000);
    expect_speed(517);
    at(12000000);
    expect_position(3000000, 1100);
    expect_reached(1900, 5000000, 0);
    expect_reached(2050, 5500000, 0);
    expect_reached(2051, 5503330, 1);
    expect_position(7000000, 2713);
    expect_reached(4000, 11170068, 1);
    expect_status(11170069, 0x28);
    ck_assert_uint_eq(pulses(), 4000);
}
END_TEST

START_TEST(X11_the_target_changes_once)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 2600, 300);
    at(9000000);
    expect_reached(2200, 6000000, 0);
    expect_reached(2600, 8000000, 0);
    ck_assert_uint_eq(pulses(), 2600);
    expect_status(8000000, 0x28);
}
END_TEST

START_TEST(X12_the_target_lies_behind)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 500, 500);
    at(14000000);
    expect_reached(2300, 7000000, 0);
    expect_pulse(2301, 7009902, 0);
    expect_pulse(2300 + 600, 9000000, 0);
    expect_pulse(2300 + 601, 9002001, 0);
    expect_reached(500, 13000000, 0);
    expect_status(12999999, 0x23);
    expect_status(13000000, 0x2A);
    expect_status(6999999, 0x21);
    expect_status(7000000, 0x23);
    ck_assert_uint_eq(pulses(), 2300 + 1800);
}
END_TEST

START_TEST(X13_the_target_is_just_in_reach)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 2300, 500);
    at(12000000);
    expect_pulse(2300, 7000000, 0);
    ck_assert_uint_eq(pulses(), 2300);
    expect_status(7000000, 0x28);
}
END_TEST

START_TEST(X13_the_target_is_just_out_of_reach)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 2299, 500);
    at(12000000);
    expect_pulse(2300, 7000000, 0);
    expect_pulse(2301, 7009967, 0);
    ck_assert_uint_eq(pulses(), 2301);
    expect_status(7009967, 0x2A);
}
END_TEST

START_TEST(X13_the_target_is_out_of_reach)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 101, 2000, 500);
    at(12000000);
    expect_pulse(2300, 7000000, 0);
    expect_reached(2000, 8854102, 1);
    ck_assert_uint_eq(pulses(), 2600);
    expect_status(8854103, 0x2A);
}
END_TEST

START_TEST(X19_the_parameters_of_the_slot_hold)
{
    slot(0, 102, 3000, 500);
    slot(1000000, 13, 50, 0);
    at(9000000);
    expect_pulse(3000, 8400000, 0);
    ck_assert_uint_eq(in(0x19), 50);
}
END_TEST

START_TEST(X19_the_command_again_takes_new_ones)
{
    slot(0, 102, 3000, 500);
    slot(1000000, 13, 50, 0);
    command(A, 101, 3000, 500);
    at(3000000);
    expect_speed(450);
    at(11000000);
    expect_position(3000000, 1075);
    expect_pulse(3000, 10000000, 1);
    ck_assert_uint_eq(pulses(), 3000);
}
END_TEST

START_TEST(X20_a_stop_on_the_last_ramp)
{
    slot(0, 102, 3000, 500);
    slot(6000000, 108, 0, 0);
    at(9000000);
    ck_assert_uint_eq(pulses(), 3000);
    expect_pulse(3000, 8400000, 1);
    expect_status(8400001, 0x20);
}
END_TEST

START_TEST(X20_a_stop_on_the_last_ramp_takes_the_present_deceleration)
{
    slot(0, 102, 3000, 500);
    slot(6000000, 13, 50, 0);
    command(A, 108, 0, 0);
    at(12000000);
    ck_assert_uint_eq(pulses(), 3528);
    expect_pulse(3528, 10800000, 1);
    expect_status(10800001, 0x20);
}
END_TEST

START_TEST(X21_the_immediate_stop)
{
    slot(0, 14, 200, 0);
    command(A, 105, 500, 0);
    ck_assert_uint_eq(in(0x1a), 200);
    ck_assert_uint_eq(in(0x19), 100);
    slot(3000000, _i == 0 ? 109 : 108, 0, 0);
    at(8000000);
    expect_reached(_i == 0 ? 1700 : 2300, _i == 0 ? 5000000 : 7000000, 0);
    ck_assert_uint_eq(pulses(), _i == 0 ? 1700 : 2300);
    expect_status(8000000, 0x20);
}
END_TEST

START_TEST(X21_only_the_operating_deceleration_is_limited)
{
    slot(0, 14, 200, 0);
    ck_assert_uint_eq(in(0x11), 0x20);
    command(A, 13, 200, 0);
    ck_assert_uint_eq(in(0x11), 0x30);
    ck_assert_uint_eq(in(0x12), 4);
    ck_assert_uint_eq(in(0x19), 100);
}
END_TEST

START_TEST(X22_from_position_mode_to_speed_mode)
{
    slot(0, 101, 3000, 500);
    slot(3000000, 105, 200, 0);
    at(20000000);
    expect_status(5999999, 0x21);
    expect_status(6000000, 0x25);
    expect_position(6000000, 2150);
    expect_status(20000000, 0x25);
}
END_TEST

START_TEST(X22_from_speed_mode_to_position_mode)
{
    slot(0, 105, 500, 0);
    slot(3000000, 102, 2000, 500);
    at(9000000);
    expect_status(2999999, 0x25);
    expect_status(3000000, 0x21);
    expect_reached(3100, 8600000, 0);
    expect_status(8599999, 0x21);
    expect_status(8600000, 0x28);
}
END_TEST

START_TEST(X27_a_distance_of_nothing_on_the_way)
{
    slot(0, 105, 500, 0);
    slot(3000000, 102, 0, 500);
    at(12000000);
    expect_pulse(2300, 7000000, 0);
    expect_reached(1100, 11684659, 1);
    ck_assert_uint_eq(pulses(), 2300 + 1200);
    expect_status(11684660, 0x2A);
}
END_TEST

START_TEST(X32_a_turn_after_a_wrap_goes_back_its_few_pulses)
{
    cib_advance_to(10);
    command(A, 100, 2147483600, 0);
    slot(0, 105, 500, 0);
    slot(3000000, 102, 0, 500);
    at(12000000);
    expect_pulse(2300, 7000000, 0);
    expect_pulse(3500, 11684659, 1);
    ck_assert_uint_eq(pulses(), 3500);
    ck_assert_int_eq(position(), -2147482596);
    expect_status(11684660, 0x2A);
}
END_TEST

/* ---- Without ramps, and s raised ---- */

START_TEST(X23_a_turn_without_ramps)
{
    slot(0, 105, 500, 0);
    slot(3000000, 9, 0, 0);
    command(A, 105, -300, 0);
    at(3100000);
    expect_position(3000000, 1100);
    expect_status(2999999, 0x25);
    expect_status(3000000, 0x07);
    expect_pulse(1101, 3003334, 0);
    expect_reached(1099, 3003334, 0);
}
END_TEST

START_TEST(X23_a_turn_without_ramps_at_the_next_pulse)
{
    slot(0, 105, 500, 0);
    slot(3001000, 9, 0, 0);
    command(A, 105, -300, 0);
    at(3100000);
    expect_pulse(1101, 3002000, 0);
    expect_pulse(1102, 3005334, 0);
    expect_position(3002000, 1101);
    expect_position(3005334, 1100);
}
END_TEST

START_TEST(X24_a_change_and_a_stop_without_ramps)
{
    slot(0, 9, 0, 0);
    command(A, 105, 400, 0);
    slot(1000000, 105, 250, 0);
    slot(2001000, 108, 0, 0);
    at(3000000);
    expect_pulse(400, 1000000, 0);
    expect_pulse(401, 1004000, 0);
    expect_status(999999, 0x05);
    expect_status(1000000, 0x05);
    expect_pulse(650, 2000000, 0);
    expect_pulse(651, 2004000, 0);
    expect_status(2004000, 0x00);
    ck_assert_uint_eq(pulses(), 651);
}
END_TEST

START_TEST(X25_the_minimum_speed_is_raised)
{
    slot(0, 105, 150, 0);
    at(999999);
    expect_speed(150);
    slot(1000000, 11, 300, 0);
    command(A, 105, 500, 0);
    at(1000001);
    expect_speed(300);
    at(3000000);
    expect_position(1000000, 143);
    expect_status(1999999, 0x21);
    expect_status(2000000, 0x25);
    expect_position(2000000, 543);
}
END_TEST

START_TEST(X30_a_refused_command_changes_nothing)
{
    slot(0, 105, 500, 0);
    slot(3000000, 102, 100, 1001);
    ck_assert_uint_eq(in(0x12), 4);
    at(4000001);
    expect_status(2999999, 0x25);
    expect_status(3000000, 0x35);
    expect_position(4000000, 1600);
    expect_status(4000000, 0x35);
}
END_TEST

static Suite *cib_change_suite(void)
{
    Suite *suite = suite_create("cib_change");
    TCase *tests = tcase_create("change");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, X9_the_speed_falls);
    tcase_add_test(tests, X9_the_speed_rises);
    tcase_add_test(tests, X10_a_turn_in_speed_mode);
    tcase_add_test(tests, X11_the_target_changes_twice);
    tcase_add_test(tests, X11_the_target_changes_once);
    tcase_add_test(tests, X12_the_target_lies_behind);
    tcase_add_test(tests, X13_the_target_is_just_in_reach);
    tcase_add_test(tests, X13_the_target_is_just_out_of_reach);
    tcase_add_test(tests, X13_the_target_is_out_of_reach);
    tcase_add_test(tests, X15_a_stop_at_a_slow_speed);
    tcase_add_test(tests, X15_a_stop_at_a_pulse);
    tcase_add_test(tests, X17_a_stop_on_the_way_up);
    tcase_add_test(tests, X18_a_stop_at_no_whole_place);
    tcase_add_test(tests, X19_the_parameters_of_the_slot_hold);
    tcase_add_test(tests, X19_the_command_again_takes_new_ones);
    tcase_add_test(tests, X20_a_stop_on_the_last_ramp);
    tcase_add_test(tests, X20_a_stop_on_the_last_ramp_takes_the_present_deceleration);
    tcase_add_loop_test(tests, X21_the_immediate_stop, 0, 2);
    tcase_add_test(tests, X21_only_the_operating_deceleration_is_limited);
    tcase_add_test(tests, X22_from_position_mode_to_speed_mode);
    tcase_add_test(tests, X22_from_speed_mode_to_position_mode);
    tcase_add_test(tests, X23_a_turn_without_ramps);
    tcase_add_test(tests, X23_a_turn_without_ramps_at_the_next_pulse);
    tcase_add_test(tests, X24_a_change_and_a_stop_without_ramps);
    tcase_add_test(tests, X25_the_minimum_speed_is_raised);
    tcase_add_test(tests, X26_a_turn_revoked);
    tcase_add_test(tests, X27_a_distance_of_nothing_on_the_way);
    tcase_add_test(tests, X30_a_refused_command_changes_nothing);
    tcase_add_test(tests, X32_a_turn_after_a_wrap_goes_back_its_few_pulses);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_change_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
