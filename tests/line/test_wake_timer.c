/* SPDX-License-Identifier: MIT */
/* test_wake_timer.c: the timer of the event loop. One test alone: CK_RUN_CASE=timer ./test_wake_timer */
#include <check.h>
#include <stdlib.h>

#include "line/line.h"

#define MS UINT64_C(1000000) /* ns */

static uv_loop_t loop;
static struct wake_timer timer;
static unsigned calls;
static uint64_t called; /* ns of the last one */

static void on_expired(void *context)
{
    ck_assert_ptr_eq(context, &calls);
    calls++;
    called = uv_hrtime();
}

static void begin(void)
{
    calls = 0;
    timer = (struct wake_timer){0};
    ck_assert_int_eq(uv_loop_init(&loop), 0);
    ck_assert(wake_timer_open(&timer, &loop, on_expired, &calls));
}

static void end(void)
{
    wake_timer_close(&timer);
    uv_run(&loop, UV_RUN_DEFAULT);
    ck_assert_int_eq(uv_loop_close(&loop), 0);
}

static void stop(uv_timer_t *other)
{
    uv_close((uv_handle_t *)other, NULL);
    uv_stop(&loop);
}

/* Let the loop run for so many ms. */
static void run_for(uint64_t ms)
{
    uv_timer_t other;
    uv_timer_init(&loop, &other);
    uv_timer_start(&other, stop, ms, 0);
    uv_run(&loop, UV_RUN_DEFAULT);
    uv_run(&loop, UV_RUN_NOWAIT);
}

START_TEST(it_goes_off_once_and_not_too_early)
{
    uint64_t when = uv_hrtime() + 3 * MS;
    begin();
    wake_timer_set(&timer, when);
    while (calls == 0)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert_uint_ge(called, when);
    run_for(20);
    ck_assert_uint_eq(calls, 1);
    end();
}
END_TEST

START_TEST(a_time_that_is_past_is_now)
{
    begin();
    wake_timer_set(&timer, 1);
    ck_assert_uint_eq(calls, 0);
    while (calls == 0)
        uv_run(&loop, UV_RUN_ONCE);
    wake_timer_set(&timer, uv_hrtime());
    while (calls == 1)
        uv_run(&loop, UV_RUN_ONCE);
    end();
}
END_TEST

START_TEST(what_is_set_last_counts)
{
    begin();
    wake_timer_set(&timer, uv_hrtime() + 2 * MS);
    uint64_t when = uv_hrtime() + 30 * MS;
    wake_timer_set(&timer, when);
    while (calls == 0)
        uv_run(&loop, UV_RUN_ONCE);
    ck_assert_uint_ge(called, when);
    wake_timer_set(&timer, uv_hrtime() + 3600000 * MS);
    wake_timer_set(&timer, uv_hrtime() + MS);
    while (calls == 1)
        uv_run(&loop, UV_RUN_ONCE);
    end();
}
END_TEST

START_TEST(one_that_went_off_unseen_and_is_set_again_does_not_count)
{
    begin();
    wake_timer_set(&timer, uv_hrtime() + MS);
    for (uint64_t until = uv_hrtime() + 5 * MS; uv_hrtime() < until;)
        ;
    wake_timer_set(&timer, 0);
    run_for(20);
    ck_assert_uint_eq(calls, 0);
    end();
}
END_TEST

static struct wake_timer pair[2];

static void on_either(void *context)
{
    const struct wake_timer *self = context;
    calls++;
    wake_timer_set(&pair[self == &pair[0]], 0);
}

START_TEST(one_that_went_off_in_the_same_turn_as_another_that_stops_it_does_not_count)
{
    begin();
    for (unsigned i = 0; i < 2; i++) {
        pair[i] = (struct wake_timer){0};
        ck_assert(wake_timer_open(&pair[i], &loop, on_either, &pair[i]));
        wake_timer_set(&pair[i], 1);
    }
    run_for(20);
    ck_assert_uint_eq(calls, 1);
    for (unsigned i = 0; i < 2; i++)
        wake_timer_close(&pair[i]);
    end();
}
END_TEST

START_TEST(a_closed_one_is_silent_and_can_be_set_and_closed_again)
{
    begin();
    wake_timer_set(&timer, 1);
    wake_timer_close(&timer);
    wake_timer_set(&timer, 1);
    run_for(10);
    ck_assert_uint_eq(calls, 0);
    end();
    timer = (struct wake_timer){0};
    wake_timer_set(&timer, 1);
    wake_timer_close(&timer);
}
END_TEST

static Suite *wake_timer_suite(void)
{
    Suite *suite = suite_create("wake_timer");
    TCase *timer_case = tcase_create("timer");
    tcase_add_test(timer_case, it_goes_off_once_and_not_too_early);
    tcase_add_test(timer_case, a_time_that_is_past_is_now);
    tcase_add_test(timer_case, what_is_set_last_counts);
    tcase_add_test(timer_case, one_that_went_off_unseen_and_is_set_again_does_not_count);
    tcase_add_test(timer_case, one_that_went_off_in_the_same_turn_as_another_that_stops_it_does_not_count);
    tcase_add_test(timer_case, a_closed_one_is_silent_and_can_be_set_and_closed_again);
    tcase_set_timeout(timer_case, 60);
    suite_add_tcase(suite, timer_case);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(wake_timer_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
