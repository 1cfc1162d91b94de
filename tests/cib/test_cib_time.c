/* SPDX-License-Identifier: MIT */
/* Time of the CIB module may be cut in any way (BK1), and it makes no difference what is reported. */
#include <check.h>

#include "cib_rig.h"
#include "digest/cib_story.h"

static void expect_same_drives(const struct cib_digest *a, const struct cib_digest *b)
{
    ck_assert_uint_eq(a->drive[0], b->drive[0]);
    ck_assert_uint_eq(a->drive[1], b->drive[1]);
    ck_assert_uint_eq(a->unit, b->unit);
    ck_assert_uint_eq(a->pulses, b->pulses);
}

START_TEST(BK1_time_may_be_cut_in_any_way)
{
    static struct cib_digest whole, cut;
    const enum cib_seen seen = (enum cib_seen)(_i % 3);
    for (unsigned number = 0; number < CIB_STORIES / 2; number++) {
        cib_story(number, CIB_CUT_NONE, seen, &whole);
        cib_story(number, _i < 3 ? CIB_CUT_EVENTS : CIB_CUT_RANDOM, seen, &cut);
        expect_same_drives(&whole, &cut);
        ck_assert_uint_eq(whole.outputs, cut.outputs);
        ck_assert_uint_eq(whole.end, cut.end);
        ck_assert_uint_eq(whole.edges, cut.edges);
    }
}
END_TEST

START_TEST(pulses_are_the_same_one_by_one_and_in_blocks)
{
    static struct cib_digest single, blocks;
    uint64_t pulses = 0;
    for (unsigned number = 0; number < CIB_STORIES; number++) {
        cib_story(number, CIB_CUT_NONE, CIB_SEEN_ALL, &single);
        cib_story(number, CIB_CUT_NONE, CIB_SEEN_STEPS, &blocks);
        expect_same_drives(&single, &blocks);
        pulses += single.pulses;
    }
    ck_assert_uint_gt(pulses, 100 * CIB_STORIES);
}
END_TEST

START_TEST(BK1_nothing_happens_before_the_next_event)
{
    cib_power_up(&cib_example);
    ck_assert_uint_eq(cib_next_event(&cib), CIB_NEVER);
    at(-500);
    command(A, 105, 500, 0);
    ck_assert_uint_eq(cib_next_event(&cib), BASE);
    at(1);
    ck_assert_uint_eq(cib_next_event(&cib), BASE + 9902);
    cib_set_inputs(&cib, 1);
    ck_assert_uint_eq(cib_next_event(&cib), BASE + 5001);
    at(9902);
    ck_assert_uint_eq(cib_next_event(&cib), BASE + 9902);
    ck_assert_int_eq(position(), 0);
    at(9903);
    ck_assert_int_eq(position(), 1);
    cib_see(SEEN_NOTHING); /* next: INVEL, in front of the end of the ramp */
    ck_assert_uint_gt(cib_next_report(&cib), BASE + 1999000);
    ck_assert_uint_le(cib_next_report(&cib), BASE + 2000000);
    ck_assert_uint_lt(cib_next_event(&cib), BASE + 20000);
}
END_TEST

static uint64_t promised;
static unsigned reported;

static void on_event(void *context, uint64_t tick, unsigned axis, enum cib_event what, uint32_t value)
{
    (void)context, (void)axis, (void)what, (void)value;
    ck_assert_uint_ge(tick, promised);
    reported++;
}

START_TEST(nothing_is_reported_before_the_next_report)
{
    static const struct cib_port port = {.event = on_event};
    struct cib_config config = cib_example;
    config.brake_error = (int8_t)(_i < 2 ? 0 : -10);
    promised = reported = 0;
    cib_begin(&cib, &config, &port, NULL);
    command(_i % 2 == 0 ? A : B, 102, _i < 4 ? 3000 : 1, 500);
    const unsigned taken = reported;
    unsigned turns = 0;
    while ((promised = cib_next_report(&cib)) != CIB_NEVER) {
        cib_advance(&cib, promised + 1 - cib_now(&cib));
        turns++;
    }
    ck_assert_uint_eq(reported, taken + 3); /* begun, ended, MCSTAT */
    ck_assert_uint_lt(turns, 200); /* not pulse by pulse */
}
END_TEST

static unsigned order[8];
static unsigned ordered;

static void on_steps(void *context, unsigned axis, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    (void)context, (void)tick, (void)position, (void)forward;
    ck_assert_uint_eq(count, 1);
    ck_assert_uint_lt(ordered, 8);
    order[ordered++] = axis;
}

static void on_outputs(void *context, uint64_t tick, uint16_t driven)
{
    (void)context, (void)tick, (void)driven;
}

START_TEST(BK2_drive_a_comes_in_front_of_drive_b)
{
    static const struct cib_port port = {.steps = on_steps, .outputs = on_outputs};
    const unsigned expected[] = {2, 1, 2, 2, 1, 2};
    struct cib_config config = cib_example;
    config.setup.drive[A].ramps = config.setup.drive[B].ramps = 0;
    ordered = 0;
    cib_begin(&cib, &config, &port, NULL);
    command(B, 102, 4, 200);
    command(A, 102, 2, 100); /* with every other pulse of B */
    at(30000);
    ck_assert_uint_eq(ordered, 6);
    for (unsigned i = 0; i < 6; i++)
        ck_assert_uint_eq(order[i], expected[i]);
}
END_TEST

START_TEST(BK1_the_end_of_time)
{
    cib_power_up(&cib_example);
    cib_advance(&cib, 10);
    cib_advance(&cib, UINT64_MAX);
    ck_assert_uint_eq(cib_now(&cib), CIB_NEVER);
    cib_advance(&cib, 10);
    ck_assert_uint_eq(cib_now(&cib), CIB_NEVER);
}
END_TEST

static Suite *cib_time_suite(void)
{
    Suite *suite = suite_create("cib_time");
    TCase *tests = tcase_create("time");
    tcase_set_timeout(tests, 200);
    tcase_add_loop_test(tests, BK1_time_may_be_cut_in_any_way, 0, 6);
    tcase_add_test(tests, pulses_are_the_same_one_by_one_and_in_blocks);
    tcase_add_test(tests, BK1_nothing_happens_before_the_next_event);
    tcase_add_loop_test(tests, nothing_is_reported_before_the_next_report, 0, 6);
    tcase_add_test(tests, BK2_drive_a_comes_in_front_of_drive_b);
    tcase_add_test(tests, BK1_the_end_of_time);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(cib_time_suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
