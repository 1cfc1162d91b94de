/* SPDX-License-Identifier: MIT */
/* test_plant_stall.c: which pulses a rotor follows. One test case alone: CK_RUN_CASE=limits ./test_plant_stall */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "plant_rig.h"

#define SECOND UINT64_C(1000000)
#define STALL(text) "motors: {1: {stall: " text "}}"

static struct plant_rig rig;

static void teardown(void)
{
    plant_rig_end(&rig);
}

/* Run a program of motor 1 with this plant. Returns how many steps were lost. */
static int64_t lost(const char *plant, const char *program)
{
    bool ok = plant_rig_begin(&rig, "1", plant);
    ck_assert_msg(ok, "%s", rig.errors);
    plant_rig_program(&rig, 1, '1', program);
    plant_rig_run(&rig, 100 * SECOND);
    return counter(&rig, 1) - true_position(&rig, 1);
}

/* ---- Limits --------------------------------------------------------------------------------------------------------- */

START_TEST(without_a_limit_nothing_stalls)
{
    ck_assert_int_eq(lost("motors: {1: }", "S2000 V16000 A60000 F100000 R B100000 R"), 0);
}
END_TEST

/* A motion exactly at its limits, for every kind of speed: rounding of ticks is no reason to stall. */
static const struct {
    unsigned start, top, acceleration;
} exact[] = {{1, 10, 1},          {100, 1000, 2000},    {100, 1000, 60000},  {500, 4000, 20000}, {2000, 16000, 60000},
             {2000, 16000, 1000}, {1000, 16000, 30000}, {37, 12347, 5557},   {2000, 2001, 60000}, {50, 16000, 100},
             {1999, 15999, 777},  {1, 16000, 60000}};

START_TEST(a_motion_at_its_very_limit_does_not_stall)
{
    char plant[200], program[100];
    snprintf(plant, sizeof plant, STALL("{start: %u, limit: [{speed: %u, acceleration: %u}]}"), exact[_i].start, exact[_i].top,
             exact[_i].acceleration);
    snprintf(program, sizeof program, "S%u V%u A%u F50000 R B70 R F7 R F900 R", exact[_i].start, exact[_i].top,
             exact[_i].acceleration);
    ck_assert_int_eq(lost(plant, program), 0);
    ck_assert_uint_eq(rig.news, 0);
}
END_TEST

/* A number from 1 to `most`, small ones as often as large ones. */
static unsigned some(unsigned most)
{
    unsigned limit = 1u + (unsigned)rand() % most;
    return 1u + (unsigned)rand() % limit;
}

START_TEST(any_motions_at_their_very_limit_do_not_stall)
{
    char plant[200], program[300];
    srand((unsigned)_i);
    for (unsigned i = 0; i < 20; i++) {
        unsigned start = some(2000), speed = some(16000), acceleration = some(60000);
        snprintf(plant, sizeof plant, STALL("{start: %u, limit: [{speed: %u, acceleration: %u}]}"), start,
                 speed > start ? speed : start, acceleration);
        snprintf(program, sizeof program, "S%u V%u A%u F%u R F%u R W%u B%u R F%u Y F%u V%u Y F%u R", start, speed, acceleration,
                 some(20), some(2000), some(50), some(20000), some(5000), some(3000), some(speed), some(50));
        ck_assert_msg(lost(plant, program) == 0, "%s %s: %s", plant, program, rig.report[0].text);
        teardown();
    }
    plant_rig_begin(&rig, "1", NULL);
}
END_TEST

static const char plain[] = STALL("{start: 500, limit: [{speed: 4000, acceleration: 20000}]}");

START_TEST(one_that_is_faster_stalls)
{
    ck_assert_int_gt(lost(plain, "S100 V4200 A10000 F10000 R"), 1000);
    ck_assert_uint_eq(rig.report[0].what, PLANT_STALL);
}
END_TEST

START_TEST(one_that_is_a_little_faster_at_high_speed_stalls)
{
    static const char plant[] = STALL("{start: 500, limit: [{speed: 15900, acceleration: 60000}]}");
    ck_assert_int_gt(lost(plant, "S100 V16000 A10000 F50000 R"), 1000);
}
END_TEST

START_TEST(one_that_is_steeper_stalls)
{
    ck_assert_int_gt(lost(plain, "S100 V3900 A24000 F10000 R"), 1000);
}
END_TEST

START_TEST(one_that_starts_too_fast_stalls_at_once)
{
    ck_assert_int_gt(lost(plain, "S1000 V1000 F1000 R"), 990);
    ck_assert_int_ge(true_position(&rig, 1), 1);
    ck_assert_int_lt(true_position(&rig, 1), 10);
}
END_TEST

START_TEST(up_to_the_start_speed_any_change_is_followed)
{
    static const char plant[] = STALL("{start: 2000, limit: [{speed: 4000, acceleration: 1}]}");
    ck_assert_int_eq(lost(plant, "S2000 V2000 A60000 F1000 R B1000 R"), 0);
}
END_TEST

/* 30 000 steps/s² from standing, none left at 4000 steps/s: at 2000 steps/s it is 15 000. */
static const char curve[] = STALL("{start: 200, limit: [{speed: 1, acceleration: 30000}, {speed: 4000, acceleration: 0}]}");

START_TEST(between_two_points_of_the_curve_the_limit_is_on_the_line)
{
    ck_assert_int_eq(lost(curve, "S100 V2000 A14900 F10000 R"), 0);
}
END_TEST

START_TEST(an_acceleration_that_is_right_at_low_speed_is_too_much_at_high_speed)
{
    ck_assert_int_gt(lost(curve, "S100 V2800 A14900 F10000 R"), 0);
    ck_assert_int_gt(true_position(&rig, 1), 100); /* up to about 2000 steps/s it follows */
    ck_assert_uint_eq(rig.report[0].what, PLANT_STALL);
}
END_TEST

START_TEST(braking_too_hard_stalls_too)
{
    static const char plant[] = STALL("{start: 200, limit: [{speed: 3000, acceleration: 5000}]}");
    ck_assert_int_gt(lost(plant, "S100 A4900 F10000 V2000 Y F8000 A60000 Y R"), 0);
}
END_TEST

/* ---- Afterwards ----------------------------------------------------------------------------------------------------- */

START_TEST(a_stalled_motor_stops_until_pulses_come_slowly_enough)
{
    static const char plant[] = STALL("{start: 500, limit: [{speed: 1500, acceleration: 20000}]}");
    int64_t steps = lost(plant, "S100 V3000 A10000 F2000 R");
    ck_assert_int_gt(steps, 500);
    ck_assert_uint_eq(rig.news, 2);
    ck_assert_uint_eq(rig.report[1].what, PLANT_FREE); /* at the end of the ramp it continues */
    char text[PLANT_TEXT_SIZE];
    snprintf(text, sizeof text, "motor 1 moves again, at %lld, after %lld lost steps",
             (long long)true_position(&rig, 1) - 12, (long long)steps);
    ck_assert_str_eq(rig.report[1].text, text); /* 500² = 100² + 2·10000·12 */
    plant_rig_program(&rig, 1, '1', "V400 F100 R");
    plant_rig_run(&rig, 10 * SECOND);
    ck_assert_int_eq(counter(&rig, 1) - true_position(&rig, 1), steps);
}
END_TEST

START_TEST(a_motor_that_was_jammed_at_speed_stays_behind_when_the_jam_ends)
{
    static const char plant[] = "motors: {1: {stall: {start: 500, limit: [{speed: 4000, acceleration: 20000}]},"
                                " jam: {from: 1s, to: 1100ms}}}";
    int64_t steps = lost(plant, "S100 V1000 A2000 F3000 R");
    ck_assert_int_gt(steps, 1000);
    ck_assert_uint_eq(rig.report[0].what, PLANT_JAM);
    ck_assert_uint_eq(rig.report[1].what, PLANT_STALL);
}
END_TEST

/* The first pulse of a motion is followed, also the other way round. */
START_TEST(a_turn_of_direction_counts_as_a_new_start)
{
    static const char plant[] = STALL("{start: 100, limit: [{speed: 300, acceleration: 20000}]}");
    ck_assert_int_eq(lost(plant, "S1000 V1000 F30 R"), 29);
    plant_rig_program(&rig, 1, '1', "R D R");
    plant_rig_run(&rig, SECOND);
    ck_assert_int_eq(true_position(&rig, 1), 1 + 1 - 1);
}
END_TEST

static Suite *plant_stall_suite(void)
{
    Suite *suite = suite_create("plant_stall");
    TCase *limits = tcase_create("limits");
    tcase_add_checked_fixture(limits, NULL, teardown);
    tcase_add_test(limits, without_a_limit_nothing_stalls);
    tcase_add_loop_test(limits, a_motion_at_its_very_limit_does_not_stall, 0, sizeof exact / sizeof exact[0]);
    tcase_add_loop_test(limits, any_motions_at_their_very_limit_do_not_stall, 0, 20);
    tcase_add_test(limits, one_that_is_faster_stalls);
    tcase_add_test(limits, one_that_is_a_little_faster_at_high_speed_stalls);
    tcase_add_test(limits, one_that_is_steeper_stalls);
    tcase_add_test(limits, one_that_starts_too_fast_stalls_at_once);
    tcase_add_test(limits, up_to_the_start_speed_any_change_is_followed);
    tcase_add_test(limits, between_two_points_of_the_curve_the_limit_is_on_the_line);
    tcase_add_test(limits, an_acceleration_that_is_right_at_low_speed_is_too_much_at_high_speed);
    tcase_add_test(limits, braking_too_hard_stalls_too);
    suite_add_tcase(suite, limits);

    TCase *afterwards = tcase_create("afterwards");
    tcase_add_checked_fixture(afterwards, NULL, teardown);
    tcase_add_test(afterwards, a_stalled_motor_stops_until_pulses_come_slowly_enough);
    tcase_add_test(afterwards, a_motor_that_was_jammed_at_speed_stays_behind_when_the_jam_ends);
    tcase_add_test(afterwards, a_turn_of_direction_counts_as_a_new_start);
    suite_add_tcase(suite, afterwards);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(plant_stall_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=limits|afterwards ./test_plant_stall");
    return failed > 0;
}
