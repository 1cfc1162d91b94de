/* SPDX-License-Identifier: MIT */
/* test_estimate.c: durations, steps and speeds of programs, as the unit runs them. One case alone: CK_RUN_CASE=estimate
 * ./test_estimate */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "program_tools/program_tools.h"

static struct estimate estimate;
static struct estimate_options options;

static void set_up(void)
{
    options = (struct estimate_options){.errors = stderr};
}

static void tear_down(void)
{
    estimate_free(&estimate);
}

static enum estimate_result run_two(const char *first, const char *second)
{
    const struct program_source sources[] = {{"x", first, strlen(first), 1}, {"y", second, strlen(second), 2}};
    estimate_free(&estimate);
    return estimate_programs(sources, second[0] != '\0' ? 2 : 1, &options, &estimate);
}

static void run(const char *text)
{
    ck_assert_int_eq(run_two(text, ""), ESTIMATE_OK);
}

static void run_on_plant(const char *text, const char *plant)
{
    options.plant = plant;
    options.plant_length = strlen(plant);
    options.plant_name = "plant";
    run(text);
}

/* Manual 7.36: 18 000 steps in 24.469167 s, 13 break points. */
START_TEST(P7_a_compound_motion_has_its_duration_peak_and_break_points)
{
    run("S100 V500 A2000 F2000 Y V2000 Y V500 F5000 Y V3000 A1000 Y V1500 F2000 Y V500 Y R");
    ck_assert_int_eq(estimate.end, ESTIMATE_DONE);
    ck_assert_uint_eq(estimate.motion_count, 1);
    const struct estimate_motion *motion = &estimate.motions[0];
    ck_assert_uint_eq(motion->place.column, 81);
    ck_assert_uint_eq(motion->times, 1);
    ck_assert_uint_eq(motion->steps, 18000);
    ck_assert_uint_eq(motion->duration, 24469167);
    ck_assert_uint_eq(motion->peak, 2500);
    ck_assert_uint_eq(motion->point_count, 13);
    ck_assert_uint_eq(motion->points[7].step, 12001);
    ck_assert_uint_eq(motion->points[7].speed, 2500);
    /* R is the 19th command; the motor is idle in the slot after the motion. */
    ck_assert_uint_eq(estimate.duration, 19000 + 24469167 / 1000 * 1000 + 1000);
}
END_TEST

/* Manual 4.6: three motions of 1.317745 s. */
START_TEST(R1_a_command_in_a_loop_is_counted)
{
    run("S100 A2000 F1000 V3000\nL3 R W200 E \nB300");
    ck_assert_uint_eq(estimate.motion_count, 1);
    ck_assert_uint_eq(estimate.motions[0].times, 3);
    ck_assert_uint_eq(estimate.motions[0].all_steps, 3000);
    ck_assert_uint_eq(estimate.motions[0].duration, 1317745);
    ck_assert(!estimate.motions[0].varies);
    ck_assert_uint_eq(estimate.peak, 1417);
    ck_assert_uint_eq(estimate.steps[0], 3000);
    ck_assert_int_eq(estimate.position[0], 3000);
}
END_TEST

START_TEST(of_an_endless_loop_a_round_is_told)
{
    char text[160];
    run("F500 R @1 F100 R W200 B50 R J1");
    ck_assert_int_eq(estimate.end, ESTIMATE_ROUND);
    ck_assert_uint_eq(estimate.steps[0], 150);
    ck_assert_uint_eq(estimate.motion_count, 3);
    ck_assert(!estimate.motions[0].in_round);
    ck_assert_uint_eq(estimate.motions[0].times, 1);
    ck_assert(estimate.motions[1].in_round);
    ck_assert_uint_eq(estimate.motions[1].times, 1);
    /* Two motions, 0.2 s, and one slot each for the label, F, B and J; K4. */
    ck_assert_uint_eq(estimate.round, 359000 + 200000 + 232000 + 4000);
    ck_assert_str_eq(estimate_summary(&estimate, text), "0.795000 s a round, 150 steps, peak 1000 steps/s");
}
END_TEST

START_TEST(an_endless_motion_is_no_round)
{
    run("F100 R G+");
    ck_assert_int_eq(estimate.end, ESTIMATE_ENDLESS);
    ck_assert_uint_eq(estimate.steps[0], 100);
    ck_assert(estimate.motions[1].endless);
    ck_assert_uint_eq(estimate.motions[1].peak, 1000);
}
END_TEST

START_TEST(C7_a_fault_ends_it)
{
    run("F100 R E F100 R");
    ck_assert_int_eq(estimate.end, ESTIMATE_STOPPED);
    ck_assert_uint_eq(estimate.motion_count, 1);
}
END_TEST

START_TEST(a_wait_for_an_input_ends_it_or_is_passed)
{
    run("W5 O03 F100 R Z03 F200 R");
    ck_assert_int_eq(estimate.end, ESTIMATE_WAITS);
    ck_assert_uint_eq(estimate.wait_count, 1);
    ck_assert_uint_eq(estimate.waits[0].place.offset, 3);
    ck_assert_uint_eq(estimate.waits[0].since, 6000);
    ck_assert(!estimate.deadlock);
    options.pass_inputs = true;
    run("W5 O03 F100 R Z03 F200 R");
    ck_assert_int_eq(estimate.end, ESTIMATE_DONE);
    ck_assert_uint_eq(estimate.steps[0], 300);
    ck_assert_uint_eq(estimate.assumed, 4);
}
END_TEST

START_TEST(the_moment_is_told_from_which_two_motors_wait_for_each_other)
{
    ck_assert_int_eq(run_two("W50 O80 T81", "W300 O81 T80"), ESTIMATE_OK);
    ck_assert_int_eq(estimate.end, ESTIMATE_WAITS);
    ck_assert(estimate.deadlock);
    ck_assert_uint_eq(estimate.deadlock_at, 301000);
    ck_assert_int_eq(run_two("W50 T81 O80", "W300 O81 T80"), ESTIMATE_OK);
    ck_assert_int_eq(estimate.end, ESTIMATE_DONE);
    ck_assert(!estimate.deadlock);
}
END_TEST

START_TEST(a_guarded_motion_has_the_steps_that_it_did)
{
    /* With the plant, a switch at 3000 stops it on a ramp. */
    run_on_plant("S100 V1000 A2000 M02 F9000 R", "motors: {1: {stops: {low: -10, high: 20000}}}\n"
                                                 "switches: [{input: 02, motor: 1, at_least: 3000}]\n");
    ck_assert_uint_eq(estimate.motion_count, 1);
    ck_assert_uint_gt(estimate.motions[0].steps, 3200);
    ck_assert_uint_lt(estimate.motions[0].steps, 3300);
    ck_assert_int_eq(estimate.position[0], (int32_t)estimate.motions[0].steps);
    ck_assert_uint_eq(estimate.collisions_all, 0);
}
END_TEST

START_TEST(a_collision_with_a_stop_is_told)
{
    const char *plant = "motors: {1: {stops: {low: -10, high: 2000}}}\n";
    run_on_plant("F1500 R", plant);
    ck_assert_uint_eq(estimate.collision_count, 0);
    run_on_plant("F2500 R", plant);
    ck_assert_uint_eq(estimate.collision_count, 1);
    ck_assert_ptr_nonnull(strstr(estimate.collisions[0].text, "end stop"));
    run_on_plant("@1 F500 R J1", plant); /* some rounds later */
    ck_assert_int_eq(estimate.end, ESTIMATE_ROUND);
    ck_assert_uint_gt(estimate.collisions_all, 0);
}
END_TEST

START_TEST(homing_against_a_switch_has_an_end)
{
    run_on_plant("(01 C100 F200 R", "motors: {1: {offset: 700, stops: {low: -50, high: 2000}}}\n"
                                    "switches: [{input: 01, motor: 1, at_most: 0}]\n");
    ck_assert_int_eq(estimate.end, ESTIMATE_DONE);
    ck_assert_uint_eq(estimate.motion_count, 2);
    ck_assert_uint_eq(estimate.motions[0].steps, 700);
    ck_assert_int_eq(estimate.position[0], 200);
}
END_TEST

START_TEST(what_takes_too_long_is_given_up)
{
    run("L255 L255 L255 L255 L255 D E E E E E");
    ck_assert_int_eq(estimate.end, ESTIMATE_LIMIT);
}
END_TEST

START_TEST(a_text_with_an_error_is_refused)
{
    ck_assert_int_eq(run_two("F100 q", ""), ESTIMATE_REFUSED);
}
END_TEST

static Suite *estimate_suite(void)
{
    Suite *suite = suite_create("estimate");
    TCase *all = tcase_create("estimate");
    tcase_add_checked_fixture(all, set_up, tear_down);
    tcase_set_timeout(all, 120);
    tcase_add_test(all, P7_a_compound_motion_has_its_duration_peak_and_break_points);
    tcase_add_test(all, R1_a_command_in_a_loop_is_counted);
    tcase_add_test(all, of_an_endless_loop_a_round_is_told);
    tcase_add_test(all, an_endless_motion_is_no_round);
    tcase_add_test(all, C7_a_fault_ends_it);
    tcase_add_test(all, a_wait_for_an_input_ends_it_or_is_passed);
    tcase_add_test(all, the_moment_is_told_from_which_two_motors_wait_for_each_other);
    tcase_add_test(all, a_guarded_motion_has_the_steps_that_it_did);
    tcase_add_test(all, a_collision_with_a_stop_is_told);
    tcase_add_test(all, homing_against_a_switch_has_an_end);
    tcase_add_test(all, what_takes_too_long_is_given_up);
    tcase_add_test(all, a_text_with_an_error_is_refused);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(estimate_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=estimate ./test_estimate");
    return failed > 0;
}
