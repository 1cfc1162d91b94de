/* SPDX-License-Identifier: MIT */
/* Options of the CIB module, and its edges: comm_timeout (BC9), acc_unit (BP2), ramps off in the configuration, MCSTAT in
 * front of a slot (BC5), events, ways that have more than 32 bits. */
#include <check.h>

#include "cib_rig.h"

static struct cib_config config;

static void setup(void)
{
    config = cib_example;
    cib_power_up(&config);
}

static void power_up_with_timeout(uint32_t ms)
{
    config.comm_timeout = ms;
    cib_power_up(&config);
}

/* ---- BC9 ---- */

START_TEST(BC9_a_request_in_the_last_tick_comes_in_time)
{
    power_up_with_timeout(1000);
    at(0);
    cib_note_request(&cib);
    command(A, 105, 500, 0);
    at(1000000);
    cib_note_request(&cib);
    at(2000000);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 0);
    at(2000001);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
    expect_status(2000000, 0x21);
}
END_TEST

START_TEST(BC9_the_shortest_time)
{
    power_up_with_timeout(1);
    cib_advance_to(1000);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 0);
    cib_advance_to(1001);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
}
END_TEST

START_TEST(BC9_it_counts_from_power_up_once_until_the_next_request)
{
    power_up_with_timeout(5);
    command(A, 102, 1, 100); /* by a method, which is no request */
    command(B, 9, 2, 0);
    at(3999);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 0);
    at(4001);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
    ck_assert_uint_eq(in(0x22), 3); /* stay */
    ck_assert_uint_eq(in(0x21), 0x30);
    command(A, 102, 2, 100);
    at(900000);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
    ck_assert_int_eq(position(), 2); /* from the slot on, in front of the stop's last pulse */
}
END_TEST

START_TEST(BC9_what_is_cleared_and_what_stays)
{
    config.setup.use[2] = CIB_USE_PWM;
    power_up_with_timeout(1000);
    at(0);
    cib_note_request(&cib);
    set(8, 5000);
    command(A, 102, 1, 100);
    command(B, 5, 0, 0);
    at(500000);
    ck_assert_uint_eq(in(0x11), 0x28);
    command(A, 77, 0, 0);
    ck_assert_uint_eq(in(0x11), 0x38);
    at(1000001);
    ck_assert_uint_eq(in(0x11), 0x30);
    ck_assert_uint_eq(in(0x12), 1);
    ck_assert_uint_eq(in(0x10), 2);
    ck_assert_uint_eq(out(8), 5000);
    ck_assert_uint_eq(in(0x21), 0x10);
}
END_TEST

START_TEST(BC9_the_stop_comes_in_the_slot)
{
    config.setup.drive[A].deceleration_max = 200;
    power_up_with_timeout(1000);
    at(0);
    command(A, 13, 100, 0);
    command(A, 105, 500, 0);
    at(2500);
    cib_note_request(&cib); /* the time is over at 1 002 500: the slot is 1 003 000 */
    at(1003000);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
    expect_speed(300);
    at(1003500);
    struct cib_drive_state state;
    cib_drive_state(&cib, A, &state);
    ck_assert(state.stopping && !state.turning);
    at(4000000);
    expect_status(1002999, 0x21);
    expect_status(4000000, 0x20);
    /* d! is 200: from 300.6 to 100 takes 1.003 s */
    expect_pulse(pulses(), 2007000, 9000);
}
END_TEST

START_TEST(BC9_a_command_after_it_acts_instead)
{
    power_up_with_timeout(1000);
    at(0);
    command(A, 105, 500, 0);
    at(500);
    cib_note_request(&cib);
    at(1000600); /* it was over at 1 000 500 */
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
    cib_note_request(&cib);
    command(A, 105, 300, 0);
    at(1900000);
    expect_speed(300);
    ck_assert_uint_eq(in(0x11), 0x25);
}
END_TEST

START_TEST(BC9_another_request_after_it_does_not_revoke_it)
{
    power_up_with_timeout(1000);
    at(0);
    command(A, 105, 500, 0);
    at(500);
    cib_note_request(&cib);
    at(1000600);
    cib_note_request(&cib);
    command(A, 14, 50, 0); /* d! of the slot */
    at(1500000);
    expect_speed(275);
    at(2000601);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 2);
}
END_TEST

START_TEST(BC9_a_turn_is_given_up)
{
    power_up_with_timeout(1000);
    at(0);
    command(A, 105, 500, 0);
    at(1000);
    cib_note_request(&cib);
    at(900000);
    command(A, 105, -500, 0);
    at(9000000);
    expect_status(9000000, 0x20);
    ck_assert_int_gt(position(), 0);
    ck_assert_uint_eq(pulses(), (unsigned)position());
}
END_TEST

START_TEST(BU8_apply_keeps_the_time_of_BC9)
{
    power_up_with_timeout(1000);
    at(500000);
    set(0x100, 1);
    at(999000);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 0);
    at(999001);
    ck_assert_uint_eq(events(CIB_EVENT_TIMEOUT), 1);
}
END_TEST

/* ---- Accelerations, ramps ---- */

START_TEST(BP2_the_unit_of_accelerations)
{
    config.acc_unit = _i == 0 ? 10 : 100;
    cib_power_up(&config);
    const int64_t part = config.acc_unit;
    at(0);
    command(A, 105, 500, 0);
    ck_assert_uint_eq(in(0x18), 200);
    at(3000000);
    command(A, 108, 0, 0);
    at(9000000);
    expect_status(2000000 / part - 1, 0x21);
    expect_status(2000000 / part, 0x25);
    expect_status(9000000, 0x20);
    expect_pulse(pulses(), 3000000 + 4000000 / part, 10000);
}
END_TEST

START_TEST(BP2_the_stop_has_the_unit_too)
{
    config.acc_unit = 100;
    cib_power_up(&config);
    at(0);
    command(A, 14, 5, 0);
    command(A, 105, 500, 0);
    at(1000000);
    command(A, 109, 0, 0); /* 500 pulses/s^2: 0.8 s */
    at(3000000);
    expect_pulse(pulses(), 1800000, 10000);
}
END_TEST

START_TEST(BM4_ramps_off_in_the_configuration)
{
    config.setup.drive[A].ramps = 0;
    cib_power_up(&config);
    at(0);
    ck_assert_uint_eq(in(0x11), 0);
    ck_assert_uint_eq(in(0x21), 0x20);
    command(A, 102, 2, 500);
    at(10000);
    expect_pulse(1, 2000, 0);
    expect_pulse(2, 4000, 0);
    expect_status(4000, 0x08);
}
END_TEST

/* ---- MCSTAT ---- */

START_TEST(BC5_a_speed_that_is_reached_in_front_of_the_slot_does_not_show)
{
    config.setup.drive[A].acceleration_max = 240;
    cib_power_up(&config);
    at(0);
    command(A, 105, 500, 0);
    at(1666500);
    command(A, 105, 400, 0); /* the ramp ends at 1 666 667 */
    at(3000000);
    expect_status(1666499, 0x21);
    expect_status(1666667, 0x21);
    expect_status(1667000, 0x21);
    expect_status(2666666, 0x21);
    expect_status(2667000, 0x25);
}
END_TEST

START_TEST(BC5_the_way_back_of_a_turn_does_not_show_its_speed)
{
    config.setup.drive[A].start_speed = 300;
    cib_power_up(&config);
    at(0);
    command(A, 105, 300, 0);
    at(12000);
    command(A, 105, -200, 0); /* turns at pulse 4, at 13 334 */
    at(13200);
    command(A, 105, -250, 0);
    at(20000);
    expect_status(12000, 0x21);
    expect_status(13333, 0x21);
    expect_status(13334, 0x23); /* no ramp, but INVEL is that of the command */
    expect_status(13999, 0x23);
    expect_status(14000, 0x27);
}
END_TEST

START_TEST(BM5_a_target_at_the_pulse_already_sent)
{
    at(0);
    command(A, 105, 50, 0);
    at(40000);
    command(A, 101, 2, 50); /* pulse 2 comes in front of the slot */
    at(100000);
    expect_status(39999, 0x25);
    expect_status(40000, 0x28);
    ck_assert_uint_eq(pulses(), 2);
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 2);
    ck_assert_uint_eq(last_event(CIB_EVENT_MOTION), 0);
}
END_TEST

START_TEST(BM8_a_target_is_in_reach_whatever_the_error)
{
    config.brake_error = (int8_t)(_i == 0 ? 20 : -20);
    cib_power_up(&config);
    at(0);
    command(A, 101, 3000, 500);
    at(3000000);
    command(A, 101, 2290, 500); /* 10 too near: it turns */
    at(12000000);
    ck_assert_uint_eq(pulses(), 2310);
    expect_reached(2300, 7000000, 0);
    ck_assert_int_eq(position(), 2290);
    expect_status(12000000, 0x2A);
}
END_TEST

START_TEST(BM8_up_to_the_minimum_speed_it_makes_no_difference)
{
    config.brake_error = (int8_t)(_i == 0 ? 20 : -20);
    cib_power_up(&config);
    at(0);
    command(A, 102, 30, 90);
    at(1000000);
    ck_assert_uint_eq(pulses(), 30);
    for (int64_t k = 1; k <= 30; k++)
        expect_pulse((unsigned)k, (k * 1000000 + 89) / 90, 0);
}
END_TEST

START_TEST(BM8_it_brakes_at_once_if_the_place_is_too_near)
{
    config.brake_error = 20;
    cib_power_up(&config);
    at(0);
    command(A, 101, 3000, 500);
    at(3000000);
    command(A, 101, 2305, 500); /* a stop ends at 2300, the rest follows at 100 */
    at(12000000);
    expect_reached(2300, 7000000, 0);
    expect_reached(2301, 7010000, 1);
    expect_reached(2305, 7050000, 1);
    ck_assert_uint_eq(pulses(), 2305);
}
END_TEST

/* ---- Ways of more than 32 bits ---- */

START_TEST(BC7_a_turn_at_the_end_of_the_counter)
{
    const bool back = _i % 2 != 0;
    config.setup.drive[A].speed_max = 10000;
    config.acc_unit = 100;
    config.brake_error = (int8_t)(_i < 2 ? 0 : -20);
    cib_power_up(&config);
    cib_see(SEEN_NOTHING);
    at(-500);
    command(A, 100, back ? INT32_MIN + 20000 : INT32_MAX - 20000, 0);
    at(0);
    command(A, 105, back ? -10000 : 10000, 0);
    at(2000000);
    command(A, 101, back ? INT32_MAX : INT32_MIN, 10000);
    while ((in(0x11) & CIB_MOVE) != 0)
        cib_advance(&cib, UINT64_C(1000000000));
    ck_assert_uint_eq(in(0x11), back ? 0x28 : 0x2A);
    ck_assert_int_eq(position(), back ? INT32_MAX : INT32_MIN);
    /* It turns behind the wrap: 2^32 pulses and more at 10 000/s. */
    ck_assert_uint_gt(cib_now(&cib), UINT64_C(429496000000));
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 0);
}
END_TEST

/* ---- Events ---- */

static unsigned directions;
static bool last_forward;

static void on_direction(void *context, uint64_t tick, unsigned axis, bool forward)
{
    (void)context, (void)tick;
    ck_assert_uint_eq(axis, 1);
    directions++;
    last_forward = forward;
}

START_TEST(the_port_is_told_of_directions)
{
    static const struct cib_port port = {.direction = on_direction};
    directions = 0;
    cib_begin(&cib, &config, &port, NULL);
    command(A, 102, -1, 100);
    at(500000);
    ck_assert(directions == 1 && !last_forward);
    command(A, 102, -1, 100);
    at(1000000);
    ck_assert_uint_eq(directions, 1);
    set(0x100, 1);
    ck_assert(directions == 2 && last_forward);
    ck_assert_int_eq(position(), 0);
}
END_TEST

START_TEST(apply_reports_what_it_ends)
{
    at(0);
    command(A, 105, 100, 0);
    at(100500);
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 1);
    ck_assert_uint_eq(events(CIB_EVENT_POSITION), 0);
    expect_driven(100500, 6);
    set(0x100, 1);
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 2);
    ck_assert_uint_eq(last_event(CIB_EVENT_MOTION), 0);
    ck_assert_uint_eq(events(CIB_EVENT_POSITION), 1);
    expect_driven(100500, 0);
    const unsigned before = events(CIB_EVENT_STATUS);
    set(0x100, 1); /* nothing more to report */
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 2);
    ck_assert_uint_eq(events(CIB_EVENT_POSITION), 1);
    ck_assert_uint_eq(events(CIB_EVENT_STATUS), before);
}
END_TEST

static Suite *cib_options_suite(void)
{
    Suite *suite = suite_create("cib_options");
    TCase *tests = tcase_create("options");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 60);
    tcase_add_test(tests, BC9_a_request_in_the_last_tick_comes_in_time);
    tcase_add_test(tests, BC9_the_shortest_time);
    tcase_add_test(tests, BC9_it_counts_from_power_up_once_until_the_next_request);
    tcase_add_test(tests, BC9_what_is_cleared_and_what_stays);
    tcase_add_test(tests, BC9_the_stop_comes_in_the_slot);
    tcase_add_test(tests, BC9_a_command_after_it_acts_instead);
    tcase_add_test(tests, BC9_another_request_after_it_does_not_revoke_it);
    tcase_add_test(tests, BC9_a_turn_is_given_up);
    tcase_add_test(tests, BU8_apply_keeps_the_time_of_BC9);
    tcase_add_loop_test(tests, BP2_the_unit_of_accelerations, 0, 2);
    tcase_add_test(tests, BP2_the_stop_has_the_unit_too);
    tcase_add_test(tests, BM4_ramps_off_in_the_configuration);
    tcase_add_test(tests, BC5_a_speed_that_is_reached_in_front_of_the_slot_does_not_show);
    tcase_add_test(tests, BC5_the_way_back_of_a_turn_does_not_show_its_speed);
    tcase_add_test(tests, BM5_a_target_at_the_pulse_already_sent);
    tcase_add_loop_test(tests, BM8_a_target_is_in_reach_whatever_the_error, 0, 2);
    tcase_add_loop_test(tests, BM8_up_to_the_minimum_speed_it_makes_no_difference, 0, 2);
    tcase_add_test(tests, BM8_it_brakes_at_once_if_the_place_is_too_near);
    tcase_add_loop_test(tests, BC7_a_turn_at_the_end_of_the_counter, 0, 4);
    tcase_add_test(tests, the_port_is_told_of_directions);
    tcase_add_test(tests, apply_reports_what_it_ends);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_options_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
