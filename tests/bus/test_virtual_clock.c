/* SPDX-License-Identifier: MIT */
/* test_virtual_clock.c: --clock real|xN|max. One test alone: CK_RUN_CASE=clock ./test_virtual_clock */
#include <check.h>
#include <stdlib.h>

#include "bus/virtual_clock.h"

#define SECOND UINT64_C(1000000000) /* ns */
#define BEGIN UINT64_C(123456789)   /* any ns */

static struct virtual_clock clock_at(const char *text)
{
    struct virtual_clock clock;
    ck_assert_msg(virtual_clock_read(&clock, text), "%s was refused", text);
    virtual_clock_start(&clock, BEGIN, 0);
    return clock;
}

START_TEST(a_second_has_a_million_ticks_times_N)
{
    static const struct {
        const char *text;
        uint64_t ticks;
    } of[] = {{"real", 1000000}, {"max", 1000000},   {"x1", 1000000},   {"x0.001", 1000},
              {"x2.5", 2500000}, {"x0.25", 250000}, {"x10000", 10000000000}, {"x9999.999", 9999999000}};
    struct virtual_clock clock = clock_at(of[_i].text);
    ck_assert_uint_eq(virtual_clock_tick(&clock, BEGIN), 0);
    ck_assert_uint_eq(virtual_clock_tick(&clock, BEGIN + SECOND), of[_i].ticks);
    ck_assert_uint_eq(virtual_clock_tick(&clock, BEGIN + 31536000 * SECOND), 31536000 * of[_i].ticks);
}
END_TEST

START_TEST(when_is_the_first_moment_of_a_tick)
{
    static const char *const texts[] = {"real", "x0.001", "x0.3", "x3", "x7.777", "x10000"};
    struct virtual_clock clock = clock_at(texts[_i]);
    const uint64_t fifty_years = UINT64_C(1576800000) * 1000 * clock.thousandths;
    for (uint64_t tick = 1; tick < fifty_years; tick = tick * 3 + 1) {
        uint64_t when = virtual_clock_when(&clock, tick);
        ck_assert_uint_ge(virtual_clock_tick(&clock, when), tick);
        ck_assert_uint_lt(virtual_clock_tick(&clock, when - 1), tick);
    }
}
END_TEST

START_TEST(after_a_leap_time_goes_on_from_there)
{
    struct virtual_clock clock = clock_at("max");
    virtual_clock_leap(&clock, BEGIN + SECOND, 5000000);
    ck_assert_uint_eq(virtual_clock_tick(&clock, BEGIN + SECOND), 5000000);
    ck_assert_uint_eq(virtual_clock_tick(&clock, BEGIN + 2 * SECOND), 6000000);
    ck_assert_uint_eq(virtual_clock_when(&clock, 6000000), BEGIN + 2 * SECOND);
}
END_TEST

START_TEST(only_max_runs_ahead)
{
    ck_assert(clock_at("max").runs_ahead);
    ck_assert(!clock_at("real").runs_ahead);
    ck_assert(!clock_at("x10000").runs_ahead);
}
END_TEST

START_TEST(anything_else_is_refused)
{
    static const char *const texts[] = {"",    "x",   "x0",     "x0.000", "x0.0001", "x1.2345", "x10000.001",
                                        "x-1", "x+1", "x1.",    "x.5",    "x1.5.5",  "x1e3",    "x10001",
                                        "x 1", "10",  "real ",  "Real",   "maximum", "x99999999999999999999"};
    struct virtual_clock clock;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        ck_assert_msg(!virtual_clock_read(&clock, texts[i]), "%s was taken", texts[i]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("virtual_clock");
    TCase *clock = tcase_create("clock");
    tcase_add_loop_test(clock, a_second_has_a_million_ticks_times_N, 0, 8);
    tcase_add_loop_test(clock, when_is_the_first_moment_of_a_tick, 0, 6);
    tcase_add_test(clock, after_a_leap_time_goes_on_from_there);
    tcase_add_test(clock, only_max_runs_ahead);
    tcase_add_test(clock, anything_else_is_refused);
    suite_add_tcase(suite, clock);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
