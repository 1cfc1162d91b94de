/* SPDX-License-Identifier: MIT */
/* PWM of the CIB module: X34, BW1, BW2, and edges against the closed form. */
#include <check.h>

#include "cib_rig.h"

/* Every so many periods are tried, all of them with -DPERIOD_STRIDE=1 (more than seven minutes, and CK_FORK=no: the assertions
 * of Check write to a pipe). */
#ifndef PERIOD_STRIDE
#define PERIOD_STRIDE 1013
#endif

static struct cib_config config;

static void setup(void)
{
    config = cib_example;
    for (unsigned i = 0; i < CIB_USES; i++)
        config.setup.use[i] = CIB_USE_PWM;
    cib_power_up(&config);
}

static void expect_edge(unsigned n, uint64_t tick, uint16_t driven)
{
    ck_assert_uint_eq(edge_tick(n), tick);
    ck_assert_uint_eq(edge_driven(n), driven);
}

START_TEST(X34_a_new_duty_counts_from_the_next_period_on)
{
    set(1, 2500);
    cib_advance_to(400);
    set(1, 7500);
    ck_assert_uint_eq(out(1), 7500);
    cib_advance_to(1000);
    ck_assert_uint_eq(in(1), 0); /* in front of the edge of this tick */
    cib_advance_to(1001);
    ck_assert_uint_eq(in(1), 1);
    cib_advance_to(2000);
    ck_assert_uint_eq(edges(), 4);
    expect_edge(0, 0, 1);
    expect_edge(1, 250, 0);
    expect_edge(2, 1000, 1);
    expect_edge(3, 1750, 0);
    ck_assert_uint_eq(events(CIB_EVENT_DUTY), 2);
    ck_assert_uint_eq(last_event(CIB_EVENT_DUTY), 7500);
}
END_TEST

START_TEST(BW2_a_duty_written_at_the_beginning_of_a_period_is_for_it)
{
    set(1, 2500);
    cib_advance_to(1000);
    set(1, 9000);
    set(1, 5000);
    ck_assert_uint_eq(in(1), 0);
    cib_advance_to(1600);
    set(1, 1000);
    set(1, 2000); /* the last one before the period counts */
    cib_advance_to(2600);
    ck_assert_uint_eq(edges(), 6);
    expect_edge(2, 1000, 1);
    expect_edge(3, 1500, 0);
    expect_edge(4, 2000, 1);
    expect_edge(5, 2200, 0);
}
END_TEST

START_TEST(X34_active_low)
{
    config.setup.active = 0xfe;
    cib_power_up(&config);
    ck_assert_uint_eq(in(1), 1); /* rest */
    set(1, 2500);
    cib_advance_to(1000);
    ck_assert_uint_eq(edges(), 2);
    expect_edge(0, 0, 0);
    expect_edge(1, 250, 1);
}
END_TEST

START_TEST(BW1_bipolar)
{
    config.setup.bipolar = 3;
    config.setup.active = 0xfd;
    cib_power_up(&config);
    ck_assert_uint_eq(in(1), 0x0d02); /* PWM1 -, PWM2 + at rest, PWM3 and 4 -, DO5-8 off */
    set(1, 2500);
    set(2, 5000);
    cib_advance_to(1000);
    ck_assert_uint_eq(edges(), 3);
    expect_edge(0, 0, 0x0e01);
    expect_edge(1, 250, 0x0f00);
    expect_edge(2, 500, 0x0d02);
}
END_TEST

START_TEST(BW2_the_groups_have_their_periods)
{
    config.setup.period[0] = 300;
    config.setup.period[1] = 500;
    config.setup.period[2] = 700;
    cib_power_up(&config);
    set(2, 5000);
    set(3, 5000);
    set(8, 5000);
    cib_advance_to(700);
    ck_assert_uint_eq(edges(), 8);
    expect_edge(0, 0, 0x86);
    expect_edge(1, 150, 0x84);
    expect_edge(2, 250, 0x80);
    expect_edge(3, 300, 0x82);
    expect_edge(4, 350, 0x02);
    expect_edge(5, 450, 0x00);
    expect_edge(6, 500, 0x04);
    expect_edge(7, 600, 0x06);
}
END_TEST

START_TEST(BW2_periods_begin_at_apply)
{
    set(1, 5000);
    cib_advance_to(1234);
    set(0x100, 1);
    ck_assert_uint_eq(in(1), 0); /* at rest at once */
    ck_assert_uint_eq(out(1), 0);
    ck_assert_uint_eq(last_event(CIB_EVENT_DUTY), 0);
    cib_advance_to(1300);
    set(1, 5000);
    cib_advance_to(3000);
    ck_assert_uint_eq(edges(), 5);
    expect_edge(3, 2234, 1);
    expect_edge(4, 2734, 0);
}
END_TEST

START_TEST(BU3_duties_of_other_outputs_are_kept_without_effect)
{
    config.setup.use[0] = config.setup.use[1] = CIB_USE_DRIVE;
    config.setup.use[2] = CIB_USE_DO;
    cib_power_up(&config);
    set(1, 5000);
    set(8, 5000);
    set(0, 0x0f);
    cib_advance_to(5000);
    ck_assert_uint_eq(edges(), 0);
    ck_assert_uint_eq(in(1), 0);
    ck_assert_uint_eq(out(1), 5000);
    ck_assert_uint_eq(out(0), 0x0f);
    ck_assert_uint_eq(cib_next_event(&cib), CIB_NEVER);
}
END_TEST

START_TEST(edges_are_computed_only_for_who_watches)
{
    cib_see(SEEN_STEPS);
    set(1, 5000);
    ck_assert_uint_eq(cib_next_event(&cib), CIB_NEVER);
    cib_advance_to(400);
    ck_assert_uint_eq(in(1), 1);
    cib_see(SEEN_ALL);
    ck_assert_uint_eq(cib_next_event(&cib), 500);
    ck_assert_uint_eq(cib_next_report(&cib), 500);
    cib_advance_to(1000);
    ck_assert_uint_eq(edges(), 1);
    expect_edge(0, 500, 0);
}
END_TEST

START_TEST(BK2_a_pulse_comes_in_front_of_an_edge_of_its_tick)
{
    config.setup.use[0] = config.setup.use[1] = CIB_USE_DRIVE;
    cib_power_up(&config);
    command(A, 102, 2, 100);
    set(5, 5000);
    at(20001);
    expect_pulse(1, 10000, 0);
    ck_assert_uint_eq(driven_at_pulse(1), 0x03); /* the edge of this tick follows */
    ck_assert_uint_eq(driven_at_pulse(2), 0x06);
    ck_assert_uint_eq(edges(), 43);
    expect_edge(22, 11000, 0x13);
    expect_edge(42, 21000, 0x16);
}
END_TEST

/* ---- The closed form ---- */

/* Edges of PWM5 in two periods: the pulse is period * duty / 10 000, ties up. */
static void expect_edges(uint32_t period, uint32_t duty)
{
    const uint64_t twice = 2 * (uint64_t)period * duty;
    uint64_t pulse = twice / 20000;
    if (twice % 20000 >= 10000)
        pulse++;
    config.setup.period[2] = period;
    cib_power_up(&config);
    set(5, (uint16_t)duty);
    cib_advance_to(2 * (uint64_t)period);
    if (pulse == 0 || pulse == period) {
        ck_assert_uint_eq(edges(), pulse > 0);
        if (pulse > 0)
            expect_edge(0, 0, 0x10);
        return;
    }
    ck_assert_uint_eq(edges(), 4);
    expect_edge(0, 0, 0x10);
    expect_edge(1, pulse, 0);
    expect_edge(2, period, 0x10);
    expect_edge(3, period + pulse, 0);
}

START_TEST(X34_rounding)
{
    const struct {
        uint32_t period, duty;
    } examples[] = {{15, 5000}, {10, 449}, {10, 499}, {10, 500}, {10, 9499}, {10, 9500}, {1000000, 1}, {1000000, 9999}};
    const uint32_t expected[] = {8, 0, 0, 1, 9, 10, 100, 999900};
    for (unsigned i = 0; i < 8; i++) {
        expect_edges(examples[i].period, examples[i].duty);
        if (edges() > 1)
            ck_assert_uint_eq(edge_tick(1), expected[i]);
    }
}
END_TEST

static const uint32_t some_periods[] = {10, 97, 1000, 10001, 123457, 1000000};

START_TEST(BW2_all_duties)
{
    for (uint32_t duty = 0; duty <= CIB_DUTY_MAX; duty++)
        expect_edges(some_periods[_i], duty);
}
END_TEST

START_TEST(BW2_all_periods)
{
    const uint32_t duties[] = {0, 1, 49, 50, 51, 3333, 4999, 5000, 5001, 6667, 9949, 9950, 9951, 9999, 10000};
    for (uint32_t period = CIB_PERIOD_MIN; period <= CIB_PERIOD_MAX; period += PERIOD_STRIDE)
        for (unsigned i = 0; i < sizeof duties / sizeof *duties; i++)
            expect_edges(period, duties[i]);
}
END_TEST

static Suite *cib_pwm_suite(void)
{
    Suite *suite = suite_create("cib_pwm");
    TCase *tests = tcase_create("pwm");
    tcase_add_checked_fixture(tests, setup, NULL);
    tcase_set_timeout(tests, 200);
    tcase_add_test(tests, X34_a_new_duty_counts_from_the_next_period_on);
    tcase_add_test(tests, BW2_a_duty_written_at_the_beginning_of_a_period_is_for_it);
    tcase_add_test(tests, X34_active_low);
    tcase_add_test(tests, BW1_bipolar);
    tcase_add_test(tests, BW2_the_groups_have_their_periods);
    tcase_add_test(tests, BW2_periods_begin_at_apply);
    tcase_add_test(tests, BU3_duties_of_other_outputs_are_kept_without_effect);
    tcase_add_test(tests, edges_are_computed_only_for_who_watches);
    tcase_add_test(tests, BK2_a_pulse_comes_in_front_of_an_edge_of_its_tick);
    tcase_add_test(tests, X34_rounding);
    tcase_add_loop_test(tests, BW2_all_duties, 0, sizeof some_periods / sizeof *some_periods);
    tcase_add_test(tests, BW2_all_periods);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_pwm_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
