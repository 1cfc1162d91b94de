/* SPDX-License-Identifier: MIT */
/* Worked examples of the CIB module: phases and motions from rest, X1-X8, X14, X16, X31, X32. Drive A, mode 20, s 100, maximum
 * speed 1000, a 200, d 100; times in us from the slot in which the first motion command acts. */
#include <check.h>
#include <string.h>

#include "cib_rig.h"

static void setup(void)
{
    cib_power_up(&cib_example);
}

/* Drive A with other figures. */
static void power_up_with(uint16_t start_speed, uint16_t speed_max, uint16_t acceleration, uint16_t deceleration)
{
    struct cib_config config = cib_example;
    config.setup.drive[A] = (struct cib_drive_setup){20, start_speed, speed_max, acceleration, deceleration, 1};
    cib_power_up(&config);
}

/* ---- X1 ---- */

static const struct {
    uint16_t mode;
    uint8_t forward[8], back[3];
} phases[] = {
    {16, {1, 2, 4, 8, 1, 2, 4, 8}, {4, 2, 1}},   {17, {1, 2, 4, 8, 1, 2, 4, 8}, {4, 2, 1}},
    {20, {3, 6, 12, 9, 3, 6, 12, 9}, {12, 6, 3}}, {21, {3, 6, 12, 9, 3, 6, 12, 9}, {12, 6, 3}},
    {32, {1, 3, 2, 6, 4, 12, 8, 9}, {8, 12, 4}}, {33, {1, 3, 2, 6, 4, 12, 8, 9}, {8, 12, 4}},
};

static void power_up_in_mode(enum drive_name drive, uint16_t mode)
{
    struct cib_config config = cib_example;
    config.setup.drive[drive].mode = mode;
    cib_power_up(&config);
}

static unsigned pattern_of(uint16_t mode, unsigned on)
{
    return mode % 2 != 0 ? on | (15 - on) << 8 : on;
}

START_TEST(X1_each_mode_has_its_patterns)
{
    const uint16_t mode = phases[_i].mode;
    power_up_in_mode(A, mode);
    ck_assert_uint_eq(cib_driven(&cib), 0);
    at(0);
    command(A, 102, 8, 100);
    at(500000);
    command(A, 102, -3, 100);
    at(1000000);
    ck_assert_uint_eq(pulses(), 11);
    for (unsigned i = 0; i < 11; i++)
        ck_assert_uint_eq(driven_at_pulse(i + 1), pattern_of(mode, i < 8 ? phases[_i].forward[i] : phases[_i].back[i - 8]));
    ck_assert_uint_eq(in(0x16), mode < 32 ? 1 : 5);
    ck_assert_uint_eq(in(1), driven_at_pulse(11));
}
END_TEST

START_TEST(X1_drive_b_has_the_other_four_outputs)
{
    power_up_in_mode(B, 33);
    at(0);
    command(B, 102, -2, 100);
    at(1000000);
    ck_assert_uint_eq(cib_driven(&cib), 0x30c0);
    ck_assert_uint_eq(in(0x26), 6);
}
END_TEST

START_TEST(X1_before_the_first_pulse_the_last_row_is_there_unseen)
{
    power_up_in_mode(A, 32);
    ck_assert_uint_eq(in(0x16), 0);
    at(0);
    command(A, 102, -2, 100);
    at(500000);
    command(A, 102, 3, 100);
    at(1000000);
    const uint8_t expected[] = {8, 12, 8, 9, 1};
    ck_assert_uint_eq(pulses(), 5);
    for (unsigned i = 0; i < 5; i++)
        ck_assert_uint_eq(driven_at_pulse(i + 1), expected[i]);
    ck_assert_uint_eq(in(0x16), 1);
}
END_TEST

/* ---- X2-X8: motions from rest ---- */

START_TEST(X2_a_path_of_three_phases)
{
    at(0);
    command(A, 102, 3000, 500);
    at(1000001);
    expect_speed(300);
    at(6000000);
    expect_speed(340);
    at(9000000);
    expect_position(6000000, 2472);
    static const struct {
        unsigned number;
        int64_t t;
    } expected[] = {{1, 9902},       {2, 19616},      {600, 2000000},  {601, 2002000}, {1800, 4400000},
                    {1801, 4402001}, {2999, 8390050}, {3000, 8400000}};
    for (unsigned i = 0; i < sizeof expected / sizeof *expected; i++)
        expect_pulse(expected[i].number, expected[i].t, 0);
    ck_assert_uint_eq(pulses(), 3000);
    expect_status(-1, 0x20);
    expect_status(0, 0x21);
    expect_status(8399999, 0x21);
    expect_status(8400000, 0x28);
    expect_driven(9000000, 9);
    ck_assert_uint_eq(in(0x15), 0);
}
END_TEST

START_TEST(X3_a_path_too_short_for_its_speed)
{
    at(0);
    command(A, 102, 900, 500);
    at(5000000);
    expect_pulse(299, 1300000, 0);
    expect_pulse(300, 1302776, 0);
    expect_pulse(301, 1305551, 1);
    expect_pulse(900, 3908327, 1);
    ck_assert_uint_eq(pulses(), 900);
}
END_TEST

START_TEST(X4_with_one_acceleration_it_is_exact)
{
    power_up_with(100, 1000, 100, 100);
    at(0);
    command(A, 102, 900, 500);
    at(5000000);
    expect_pulse(1, 9951, 0);
    expect_pulse(450, 2162278, 0);
    expect_pulse(451, 2165442, 0);
    expect_pulse(900, 4324556, 0);
}
END_TEST

START_TEST(X5_a_steep_rise_and_a_gentle_fall)
{
    power_up_with(100, 1000, 240, 70);
    at(0);
    command(A, 102, 1000, 900);
    at(5000000);
    expect_pulse(1, 9883, 0);
    expect_pulse(2, 19542, 0);
    expect_pulse(500, 1891713, 1);
    expect_pulse(999, 4493786, 1);
    expect_pulse(1000, 4503752, 1);
}
END_TEST

START_TEST(X6_the_fastest_and_longest)
{
    power_up_with(5, 10000, 240, 240);
    cib_see(_i == 0 ? SEEN_STEPS : SEEN_ALL);
    at(0);
    command(A, 102, 500000, 10000);
    at(92000000);
    expect_pulse(1, 72801, 0);
    expect_pulse(208334, 41645906, 0);
    expect_pulse(291666, 49979106, 0);
    expect_pulse(500000, 91625011, 0);
    ck_assert_uint_eq(pulses(), 500000);
    expect_status(91625011, 0x28);
}
END_TEST

START_TEST(X6_unseen_pulses_are_counted)
{
    power_up_with(5, 10000, 240, 240);
    cib_see(SEEN_NOTHING);
    at(0);
    command(A, 102, 500000, 10000);
    at(41645907);
    ck_assert_int_eq(position(), 208334);
    at(91625011);
    ck_assert_int_eq(position(), 499999);
    ck_assert_uint_eq(in(0x11), 0x21);
    at(91625012);
    ck_assert_int_eq(position(), 500000);
    ck_assert_uint_eq(in(0x11), 0x28);
}
END_TEST

START_TEST(X7_without_ramps)
{
    at(0);
    command(A, 9, 0, 0);
    command(A, 102, 900, 500);
    at(2000000);
    for (unsigned k = 1; k <= 900; k++)
        expect_pulse(k, 2000 * (int64_t)k, 0);
    ck_assert_uint_eq(pulses(), 900);
    expect_status(1799999, 0x01);
    expect_status(1800000, 0x08);
}
END_TEST

START_TEST(X8_a_permanent_motion)
{
    at(0);
    command(A, 105, 500, 0);
    at(1000001);
    expect_speed(300);
    at(3000001);
    expect_status(0, 0x21);
    expect_position(1000000, 200);
    expect_status(1999999, 0x21);
    expect_status(2000000, 0x25);
    expect_position(2000000, 600);
    expect_position(3000000, 1100);
}
END_TEST

START_TEST(X14_up_to_the_minimum_speed_there_is_no_ramp)
{
    at(0);
    command(A, 102, 10, 50);
    at(1000000);
    for (unsigned k = 1; k <= 10; k++)
        expect_pulse(k, 20000 * (int64_t)k, 0);
    ck_assert_uint_eq(pulses(), 10);
}
END_TEST

START_TEST(X16_nothing_to_do)
{
    at(0);
    command(A, 108, 0, 0);
    ck_assert_uint_eq(in(0x11), 0x20);
    at(1000);
    command(A, 102, 0, 500);
    ck_assert_uint_eq(in(0x11), 0x20);
    at(1001);
    ck_assert_uint_eq(in(0x11), 0x28);
    at(2000);
    command(A, 101, 0, 500);
    ck_assert_uint_eq(in(0x11), 0x20);
    at(1000000);
    ck_assert_uint_eq(in(0x11), 0x28);
    ck_assert_uint_eq(pulses(), 0);
    ck_assert_uint_eq(events(CIB_EVENT_MOTION), 0);
}
END_TEST

/* ---- X31: brake_error ---- */

static void power_up_with_error(int8_t brake_error)
{
    struct cib_config config = cib_example;
    config.brake_error = brake_error;
    cib_power_up(&config);
}

START_TEST(X31_the_minimum_speed_comes_early)
{
    power_up_with_error(10);
    at(0);
    command(A, 102, 3000, 500);
    at(9000000);
    expect_reached(1790, 4380000, 0);
    expect_reached(2990, 8380000, 0);
    expect_reached(2991, 8390000, 0);
    expect_reached(3000, 8480000, 0);
    ck_assert_uint_eq(pulses(), 3000);
    expect_status(8480000, 0x28);
}
END_TEST

START_TEST(X31_the_target_comes_early)
{
    power_up_with_error(-10);
    at(0);
    command(A, 102, 3000, 500);
    at(9000000);
    expect_reached(1810, 4420000, 0);
    expect_reached(3000, 8324555, 1);
    ck_assert_uint_eq(pulses(), 3000);
    expect_status(8324553, 0x21);
    expect_status(8324556, 0x28);
}
END_TEST

START_TEST(X31_a_short_way_is_done_at_the_minimum_speed)
{
    power_up_with_error(10);
    at(0);
    command(A, 102, 5, 500);
    at(9000000);
    for (unsigned k = 1; k <= 5; k++)
        expect_pulse(k, 10000 * (int64_t)k, 0);
    ck_assert_uint_eq(pulses(), 5);
}
END_TEST

/* ---- X32: 32 bits ---- */

START_TEST(X32_the_position_wraps)
{
    cib_advance_to(500);
    command(A, 100, 2147483646, 0);
    at(0);
    command(A, 102, 3, 100);
    at(100000);
    expect_pulse(1, 10000, 0);
    expect_pulse(2, 20000, 0);
    expect_pulse(3, 30000, 0);
    ck_assert_uint_eq(in(0x13), 0x8000);
    ck_assert_uint_eq(in(0x14), 1);
    expect_position(20000, INT32_MIN);
}
END_TEST

START_TEST(X32_a_way_is_never_the_shorter_one_round)
{
    power_up_with(100, 10000, 200, 100);
    cib_advance_to(500);
    command(A, 100, -2147483647, 0);
    at(0);
    cib_see(SEEN_NOTHING);
    command(A, 101, 2147483646, 10000);
    at(INT64_C(429000000000));
    ck_assert_uint_eq(in(0x11), 0x21);
    while ((in(0x11) & CIB_MOVE) != 0)
        cib_advance(&cib, 1000);
    ck_assert_uint_eq(in(0x11), 0x28);
    ck_assert_uint_eq(in(0x13), 0x7fff);
    ck_assert_uint_eq(in(0x14), 0xfffe);
    /* (10 000 - 100) / 200 and / 100 s of ramps, and the rest of 4 294 967 293 pulses level, up to a whole number. */
    ck_assert_uint_ge(cib_now(&cib), BASE + UINT64_C(429570229300));
    ck_assert_uint_le(cib_now(&cib), BASE + UINT64_C(429570241300));
}
END_TEST

static Suite *cib_motion_suite(void)
{
    Suite *suite = suite_create("cib_motion");
    TCase *tests = tcase_create("motion");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 60);
    tcase_add_loop_test(tests, X1_each_mode_has_its_patterns, 0, sizeof phases / sizeof *phases);
    tcase_add_test(tests, X1_drive_b_has_the_other_four_outputs);
    tcase_add_test(tests, X1_before_the_first_pulse_the_last_row_is_there_unseen);
    tcase_add_test(tests, X2_a_path_of_three_phases);
    tcase_add_test(tests, X3_a_path_too_short_for_its_speed);
    tcase_add_test(tests, X4_with_one_acceleration_it_is_exact);
    tcase_add_test(tests, X5_a_steep_rise_and_a_gentle_fall);
    tcase_add_loop_test(tests, X6_the_fastest_and_longest, 0, 2);
    tcase_add_test(tests, X6_unseen_pulses_are_counted);
    tcase_add_test(tests, X7_without_ramps);
    tcase_add_test(tests, X8_a_permanent_motion);
    tcase_add_test(tests, X14_up_to_the_minimum_speed_there_is_no_ramp);
    tcase_add_test(tests, X16_nothing_to_do);
    tcase_add_test(tests, X31_the_minimum_speed_comes_early);
    tcase_add_test(tests, X31_the_target_comes_early);
    tcase_add_test(tests, X31_a_short_way_is_done_at_the_minimum_speed);
    tcase_add_test(tests, X32_the_position_wraps);
    tcase_add_test(tests, X32_a_way_is_never_the_shorter_one_round);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_motion_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
