/* SPDX-License-Identifier: MIT */
/* Motions of a PMC: the examples of docs/PMC.md, whose numbers come from exact arithmetic. Ticks count from the slot in which a
 * motion begins. */
#include <stdlib.h>

#include "pmc_rig.h"

static const struct pmc_config two_axes = {.axes = 2};

/* Power up, with parameters of X from `m` to the start speed (0: as in T1). */
static void begin(int32_t m, int32_t acceleration, int32_t deceleration, int32_t start_speed)
{
    const int32_t value[] = {m, acceleration, deceleration, start_speed};
    pmc_rig_begin(&two_axes);
    for (unsigned i = 0; i < 4; i++)
        if (value[i] != 0)
            set(0, (enum pmc_parameter)(PMC_MULTIPLIER + i), value[i]);
}

/* One move of X from slot 1 at a fifth speed. */
static void move(int32_t speed, int32_t way)
{
    must(PMC_SET_SPEED, 1, speed, 0);
    must(PMC_MOVE_BY, 1, way, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], (size_t)abs(way));
}

/* Tick of pulse k of X, from the slot of its begin, slot 1. */
static uint64_t tick(size_t k)
{
    ck_assert_uint_le(k, pulses[0]);
    return pulse[0][k - 1] - SLOT;
}

#define ck_ticks(...) check_ticks((const uint64_t[]){__VA_ARGS__}, sizeof(uint64_t[]){__VA_ARGS__} / sizeof(uint64_t))

/* Pairs of a pulse and its tick. */
static void check_ticks(const uint64_t *pairs, size_t count)
{
    for (size_t i = 0; i < count; i += 2)
        ck_assert_msg(tick((size_t)pairs[i]) == pairs[i + 1], "pulse %u at %u, expected %u", (unsigned)pairs[i],
                      (unsigned)tick((size_t)pairs[i]), (unsigned)pairs[i + 1]);
}

START_TEST(AX1_the_values_for_a_start_at_speed)
{
    begin(10, 52, 0, 50);
    move(2000, 10000);
    const struct pmc_motion *motion = &unit.axis[0].motion;
    ck_assert_int_eq(motion->point[0].slope, 65000);
    ck_assert_int_eq(motion->point[0].w.whole / 16000000, 500);
    ck_assert_int_eq(motion->point[1].w.whole / 16000000, 20000);
    ck_assert_uint_eq(motion->point[1].at.high, UINT64_C(3075) << 32);
    ck_assert_uint_eq(motion->point[1].at.low, 0);
}
END_TEST

START_TEST(AX2_equal_accelerations)
{
    begin(10, 52, 0, 50);
    move(2000, 10000);
    ck_ticks(1, 14332, 2, 26357, 3, 36924, 3075, 2400000, 3076, 2400400, 5000, 3170000, 6925, 3940000, 9999, 6325669, 10000,
             6340000);
}
END_TEST

/* A place or a speed of a break point, for people. */
static double place_of(unsigned i)
{
    return (double)unit.axis[0].motion.point[i].at.high / 4294967296.0;
}

static double speed_of(unsigned i)
{
    return ((double)unit.axis[0].motion.point[i].w.whole + (double)unit.axis[0].motion.point[i].w.part / 18446744073709551616.0) /
           16e6;
}

START_TEST(AX3_another_deceleration)
{
    begin(10, 52, 400, 50);
    move(2000, 10000);
    ck_assert_double_eq_tol(place_of(2), 9600.25, 1e-9);
    ck_ticks(9998, 5306100, 9999, 5312212, 10000, 5322100);
}
END_TEST

START_TEST(AX4_a_triangle_with_two_accelerations)
{
    begin(10, 52, 400, 50);
    move(2000, 3000);
    ck_assert_double_eq_tol(place_of(1), 2654.8672566, 1e-7);
    ck_assert_double_eq_tol(speed_of(1), 18584.4758700, 1e-6);
    ck_ticks(1500, 1658239, 2998, 2499134, 2999, 2505245, 3000, 2515134);
}
END_TEST

START_TEST(AX5_below_the_start_speed)
{
    begin(0, 0, 0, 0);
    move(10, 100);
    for (size_t k = 1; k <= 100; k++)
        ck_ticks(k, 80000 * k);
}
END_TEST

START_TEST(AX6_a_ramp_shorter_than_a_pulse)
{
    begin(0, 0, 0, 0);
    move(100, 1000);
    ck_ticks(1, 10000, 2, 18000, 3, 26000, 999, 7994000, 1000, 8004000);
}
END_TEST

START_TEST(AX7_a_ramp_with_a_part_of_a_pulse)
{
    begin(0, 0, 0, 0);
    move(1000, 1000);
    ck_ticks(1, 9889, 2, 16000, 3, 20845, 99, 151399, 100, 152200, 101, 153000, 999, 934512, 1000, 944400);
}
END_TEST

START_TEST(AX8_triangle_and_trapezoid_at_V4)
{
    begin(0, 0, 0, 0);
    move(8000, 10000);
    ck_assert_double_eq_tol(speed_of(1), 70712.4458635, 1e-6);
    ck_ticks(10000, 2246799);
    begin(0, 0, 0, 0);
    move(8000, 20000);
    ck_assert_double_eq_tol(place_of(1), 6399.75, 1e-9);
    ck_ticks(20000, 3264050);
}
END_TEST

START_TEST(AX9_short_moves)
{
    begin(0, 0, 0, 0);
    move(1000, 1);
    ck_ticks(1, 11713);
    begin(0, 0, 0, 0);
    move(1000, 20);
    ck_ticks(1, 9889, 10, 43225, 19, 76562, 20, 86450);
}
END_TEST

START_TEST(AX10_slow_up_and_steep_down)
{
    begin(1, 1, 8000, 1);
    move(8000, 10);
    ck_ticks(1, 949951, 2, 1368514, 3, 1689881, 4, 1960870, 5, 2199647, 6, 2415536, 7, 2614077, 8, 2798883, 9, 2972462, 10,
             3136833);
}
END_TEST

START_TEST(AX11_four_million_pulses_a_second)
{
    begin(500, 8000, 4000, 1);
    must(PMC_SET_SPEED, 1, 8000, 0);
    must(PMC_MOVE_BY, 1, 100000, 0);
    run_through_slot(2);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), 1);
    run_until_idle(0);
    ck_ticks(1, 499, 2, 708, 3, 869, 15999, 63991, 16000, 63993, 16001, 63995, 50000, 131993, 99999, 295277, 100000, 295977);
    for (size_t k = 16001; k <= 67999; k++)
        ck_assert_uint_eq(tick(k) - tick(k - 1), 2);
}
END_TEST

START_TEST(AX12_an_odd_speed_without_ramps)
{
    begin(437, 0, 0, 8000);
    move(7777, 1000);
    ck_ticks(1, 3, 2, 5, 3, 8, 10, 24, 100, 236, 1000, 2354);
}
END_TEST

/* ---- Stops and changes of speed ---- */

/* JOG of X at a fifth speed from slot 1, STO in the slot `stop` behind it. */
static void jog_and_stop(int32_t speed, uint64_t stop)
{
    must(PMC_SET_SPEED, 1, speed, 0);
    must(PMC_JOG, 1, 1, 0);
    run_to_slot(1 + stop);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
}

START_TEST(AX29_stop_of_a_jog)
{
    static const struct {
        unsigned slot, pulses, last;
    } rows[] = {{1, 2, 24000}, {5, 18, 88000}, {10, 60, 160000}, {19, 200, 312000}, {100, 1010, 960000}};
    const unsigned i = (unsigned)_i % 5;
    begin(0, 0, 0, 0);
    if (_i >= 5) /* without an end at the software limit */
        set(0, PMC_FLAGS, 0x0103);
    jog_and_stop(1000, rows[i].slot);
    ck_assert_uint_eq(pulses[0], rows[i].pulses);
    ck_ticks(rows[i].pulses, rows[i].last);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX30_stop_with_another_deceleration)
{
    begin(0, 0, 52, 0);
    jog_and_stop(1000, 100);
    ck_assert_uint_eq(pulses[0], 1678);
    ck_ticks(1678, 1984308);
    begin(121, 7054, 5592, 936);
    jog_and_stop(3391, 10);
    ck_assert_uint_eq(pulses[0], 4610);
    ck_ticks(4610, 108168);
}
END_TEST

START_TEST(AX31_the_fifth_speed_changes_in_a_jog)
{
    begin(0, 0, 0, 0);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_JOG, 1, 1, 0);
    static const int32_t speed[] = {2000, 500, 20};
    static const unsigned passed[] = {909, 2809, 3534, 3577};
    for (unsigned i = 0; i < 4; i++) {
        run_through_slot(1 + 100 * (i + 1));
        ck_assert_uint_eq(pulses[0], passed[i]);
        pmc_rig_begin(&two_axes); /* from the begin again, a change further */
        must(PMC_SET_SPEED, 1, 1000, 0);
        must(PMC_JOG, 1, 1, 0);
        for (unsigned j = 0; j <= i && j < 3; j++) {
            run_to_slot(1 + 100 * (j + 1));
            must(PMC_SET_SPEED, 1, speed[j], 0);
            ck_assert_uint_eq(axis_state(0).fifth, (unsigned)speed[j]);
        }
    }
    run_to_slot(401);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 3578);
    ck_ticks(3578, 3212000);
}
END_TEST

START_TEST(AX32_the_fifth_speed_changes_in_a_move)
{
    static const struct {
        int32_t speed;
        uint64_t last;
    } rows[] = {{0, 1744400}, {2000, 1228200}, {8000, 1162342}};
    begin(0, 0, 0, 0);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_MOVE_BY, 1, 2000, 0);
    run_to_slot(51);
    if (rows[_i].speed != 0)
        must(PMC_SET_SPEED, 1, rows[_i].speed, 0);
    run_through_slot(51);
    if (_i == 2)
        ck_assert_double_eq_tol(speed_of(1), 29073.1835202, 1e-6);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 2000);
    ck_ticks(2000, rows[_i].last);
}
END_TEST

/* ---- Limits ---- */

START_TEST(AX27_software_limits)
{
    begin(0, 0, 0, 0);
    set(0, PMC_SOFT_PLUS, 500);
    reg(0, 0, (struct pmc_command){.op = PMC_ABS, .value = 10000, .speed = 3});
    reg(0, 1, (struct pmc_command){.op = PMC_INC, .value = 10, .speed = 1});
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(1 + 69);
    ck_assert_uint_eq(pulses[0], 500);
    ck_ticks(500, 544400);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(0).state, PMC_PROGRAM);
    run_through_slot(1 + 69);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    must(PMC_MOVE_BY, 1, 1, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 500);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
    must(PMC_MOVE_BY, 1, -10, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 510);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(0).commanded, 490);
}
END_TEST

START_TEST(AX28_software_limits_in_units)
{
    begin(0, 0, 0, 0);
    set(0, PMC_NUMERATOR, 5);
    set(0, PMC_DENOMINATOR, 1);
    set(0, PMC_SOFT_PLUS, 100);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_JOG, 1, 1, 0);
    run_to_slot(70);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_through_slot(70);
    ck_assert_uint_eq(pulses[0], 500);
    ck_ticks(500, 544400);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
}
END_TEST

START_TEST(AX33_a_limit_switch)
{
    static const struct rig_switch sw = {PMC_LIMIT_PLUS, 20000, RIG_FAR, 0};
    const bool slow = _i == 1;
    begin(0, 0, 0, 0);
    set(0, PMC_FLAGS, 0x0122 | slow);
    rig_plant(0, 0, &sw, 1);
    must(PMC_SET_SPEED, 1, 8000, 0);
    must(PMC_JOG, 1, 1, 0);
    run_to_slot(331);
    ck_ticks(20000, 2632025);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_through_slot(331);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_PLUS);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], slow ? 26480 : 20079);
    ck_ticks(pulses[0], slow ? 3920000 : 2639925);
    const size_t before = pulses[0];
    must(PMC_JOG, 1, 1, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], before);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_PLUS);
    must(PMC_JOG, 1, -1, 0);
    run_to(pmc_now(&unit) + 20 * SLOT);
    ck_assert_uint_gt(pulses[0], before);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX34_emergency)
{
    begin(0, 0, 0, 0);
    must(PMC_SET_SPEED, 3, 1000, 1000);
    must(PMC_JOG, 3, 1, 1);
    run_to_slot(51);
    rig_inputs(PMC_EMG);
    run_through_slot(51);
    ck_assert(pmc_emergency(&unit));
    for (unsigned i = 0; i < 2; i++) {
        ck_assert_int_eq(axis_state(i).errors, PMC_ERROR_EMG);
        ck_assert_uint_eq(pulses[i], 409);
        ck_assert_uint_eq(pulse[i][408] - SLOT, 399400);
    }
    run_until_idle(0);
    must(PMC_JOG, 1, 1, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_EMG);
    rig_inputs(0);
    must(PMC_JOG, 1, 1, 0);
    run_to(pmc_now(&unit) + 20 * SLOT);
    ck_assert_uint_gt(pulses[0], 409);
    ck_assert_uint_eq(pulses[1], 409);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(1).errors, PMC_ERROR_EMG);
}
END_TEST

static Suite *motion_suite(void)
{
    Suite *suite = suite_create("pmc_motion");
    TCase *rest = tcase_create("from rest"), *way = tcase_create("on the way"), *limits = tcase_create("limits");
    tcase_add_test(rest, AX1_the_values_for_a_start_at_speed);
    tcase_add_test(rest, AX2_equal_accelerations);
    tcase_add_test(rest, AX3_another_deceleration);
    tcase_add_test(rest, AX4_a_triangle_with_two_accelerations);
    tcase_add_test(rest, AX5_below_the_start_speed);
    tcase_add_test(rest, AX6_a_ramp_shorter_than_a_pulse);
    tcase_add_test(rest, AX7_a_ramp_with_a_part_of_a_pulse);
    tcase_add_test(rest, AX8_triangle_and_trapezoid_at_V4);
    tcase_add_test(rest, AX9_short_moves);
    tcase_add_test(rest, AX10_slow_up_and_steep_down);
    tcase_add_test(rest, AX11_four_million_pulses_a_second);
    tcase_add_test(rest, AX12_an_odd_speed_without_ramps);
    tcase_add_loop_test(way, AX29_stop_of_a_jog, 0, 10);
    tcase_add_test(way, AX30_stop_with_another_deceleration);
    tcase_add_test(way, AX31_the_fifth_speed_changes_in_a_jog);
    tcase_add_loop_test(way, AX32_the_fifth_speed_changes_in_a_move, 0, 3);
    tcase_add_test(limits, AX27_software_limits);
    tcase_add_test(limits, AX28_software_limits_in_units);
    tcase_add_loop_test(limits, AX33_a_limit_switch, 0, 2);
    tcase_add_test(limits, AX34_emergency);
    suite_add_tcase(suite, rest);
    suite_add_tcase(suite, way);
    suite_add_tcase(suite, limits);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(motion_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
