/* SPDX-License-Identifier: MIT */
/* Knife edges of the planner: where a step more or less hangs on the last places (R5, P7). The motions were searched for among
 * some 10^11. test_motion_stop and test_motion_change judge many more by a reference. */
#include <check.h>
#include <stdio.h>
#include <string.h>

#include "rig.h"

static struct rig rig;

static void setup(void)
{
    rig_power_up(&rig, NULL);
}

static void teardown(void)
{
    rig_free(&rig);
}

/* K at `ms`. Returns the steps of the motion that it has stopped. */
static uint32_t steps_held_at(uint64_t ms)
{
    rig_accept_at(&rig, ms * MS, "K");
    rig_to(&rig, rkm04_now(&rig.unit) + 600 * SECOND);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_HELD);
    return rig_motor(&rig, 1).steps;
}

/* A program whose last command is R, and K in the slot `slot` ms after that of R. */
static uint32_t steps_of_stop(const char *program, unsigned commands, unsigned slot)
{
    rig_accept(&rig, '1', program);
    return steps_held_at(commands + slot);
}

/* ---- The end of a stop ------------------------------------------------------------------------------------------------ */

/* From an irrational speed at the end of the first segment to constant speed in the last one. */
static const struct {
    unsigned a1, n1, a3, n3, slot;
    uint32_t steps; /* N' */
} irrational[] = {
    {115, 38, 41836, 8, 4811, 39762}, /* x' = 39762.000 000 999 999 291 */
    {411, 80, 53080, 4, 4394, 39591}, /* x' = 39591.000 000 999 999 601 */
    {226, 112, 21774, 8, 5132, 39883}, /* x' = 39882.000 001 000 000 104 */
    {4551, 3, 36799, 8, 4812, 39775}, /* x' = 39774.000 001 000 000 072 */
    {409, 85, 5485, 2, 4903, 39799}, /* x' = 39798.000 001 000 000 415 */
    {1025, 17, 31682, 6, 4862, 39792}, /* x' = 39791.000 001 000 000 391 */
};

START_TEST(R5_an_irrational_way_adds_a_step_from_a_millionth_of_a_step_on)
{
    char text[120];
    sprintf(text, "S300 V401 A%u F%u Y A59999 F5 Y V403 A%u F%u Y V407 A1 F1000000 Y R", irrational[_i].a1, irrational[_i].n1,
            irrational[_i].a3, irrational[_i].n3);
    ck_assert_uint_eq(steps_of_stop(text, 17, irrational[_i].slot), irrational[_i].steps);
}
END_TEST

/* All speeds and times are rational. */
static const struct {
    unsigned a1, n1, a2, n2, slot;
    uint32_t steps;
} rational[] = {
    {5149, 2, 27506, 6, 5036, 1256}, /* x' = 1255 + 1.433 / (8 * 10^12) */
    {13483, 5, 24061, 7, 4767, 1227}, /* x' = 1226 + 1.519 / (8 * 10^12) */
    {15296, 8, 43337, 2, 4879, 1239}, /* x' = 1238 + 1.703 / (8 * 10^12) */
};

START_TEST(R5_a_rational_way_adds_a_step_however_little_is_left)
{
    char text[120];
    sprintf(text, "S100 V101 A%u F%u Y V103 A%u F%u Y V107 A1 F1000000 Y R", rational[_i].a1, rational[_i].n1, rational[_i].a2,
            rational[_i].n2);
    ck_assert_uint_eq(steps_of_stop(text, 14, rational[_i].slot), rational[_i].steps);
}
END_TEST

/* x' = 1000 t + 900 at constant speed, t seconds after the begin, wherever on the ramp the speed was changed: there it is no
 * finite binary fraction. */
START_TEST(R5_C4_after_a_change_at_any_speed_a_whole_way_adds_no_step)
{
    rig_accept(&rig, '1', "S100 A100 V2000 G+");
    rig_accept_at(&rig, (4 + (uint64_t)_i) * MS, "V1000");
    ck_assert_uint_eq(steps_held_at(4 + 9500), 9500 + 900);
}
END_TEST

/* x' = 4350 + (221^2 - 110^2) / 120000 + 221 (0.999 - 111 / 60000) + (221^2 - 100^2) / 120000 = 4571, wherever at A1 the speed
 * was changed to 110. */
START_TEST(R5_C4_after_a_change_in_a_slow_segment_a_whole_way_adds_no_step_in_a_fast_one)
{
    rig_accept(&rig, '1', "S100 A1 V130 F4350 Y V221 A60000 F1000000 Y R");
    rig_accept_at(&rig, (10 + (uint64_t)_i) * MS, "V110");
    ck_assert_uint_eq(steps_held_at(10 + 40999), 4571);
}
END_TEST

/* ---- Break points ------------------------------------------------------------------------------------------------------ */

/* 100 steps/s; half a second after the begin x is 50, and there is no step left to do. */
START_TEST(P7_no_point_lies_after_the_last_step_of_a_stop)
{
    ck_assert_uint_eq(steps_of_stop("V100 F1000 R", 3, 500), 50);
    ck_assert_str_eq(rig_ask(&rig, 6, 1), " 3;[(1;100),(50;100),(50;0)]");
}
END_TEST

/* x lies less than 2^-34 of a step below a whole number. */
static const struct {
    unsigned a1, n1, a2, n2, slot, step;
} below[] = {
    {1133, 5, 2082, 3, 4845, 510}, /* x = 509.999 999 999 958 05 */
    {1209, 5, 2437, 8, 4987, 525}, /* x = 524.999 999 999 957 25 */
    {1206, 7, 42152, 2, 5042, 531}, /* x = 530.999 999 999 953 84 */
};

START_TEST(P7_a_point_hardly_below_a_whole_step_is_still_of_that_step)
{
    char text[120];
    sprintf(text, "S100 V101 A%u F%u Y V103 A%u F%u Y V107 A1 F1000000 Y R", below[_i].a1, below[_i].n1, below[_i].a2,
            below[_i].n2);
    rig_accept(&rig, '1', text);
    rig_accept_at(&rig, (14 + below[_i].slot) * MS, "K");
    rig_to(&rig, rkm04_now(&rig.unit) + 1);
    sprintf(text, "(%u;107),", below[_i].step);
    ck_assert_msg(strstr(rig_ask(&rig, 6, 1), text) != NULL, "%s is not in %s", text, rig_ask(&rig, 6, 1));
}
END_TEST

/* Up for 0.2 s from 1 to 1.2 steps/s at 1 step/s^2 and down again are 0.44 steps, and 2 * 1.2^2 is no finite binary fraction.
 * Here 0.6 s at 1 step/s lie between two such changes, and 0.52 s after them. */
START_TEST(P7_a_whole_step_is_shown_as_such_after_two_changes_at_broken_speeds)
{
    rig_accept(&rig, '1', "S1 A1 V16000 G+");
    rig_accept_at(&rig, 4 * MS + 200 * MS, "V1");
    rig_accept_at(&rig, 4 * MS + 1000 * MS, "V16000");
    rig_accept_at(&rig, 4 * MS + 1200 * MS, "V1");
    rig_accept_at(&rig, 4 * MS + 1920 * MS, "V16000");
    rig_to(&rig, rkm04_now(&rig.unit) + 1);
    ck_assert_str_eq(rig_ask(&rig, 6, 1), " 4;[(1;1),(2;1),(3;1),(128000002;16000)]");
}
END_TEST

/* Again 0.44 steps, 0.56 s, and from step 1 a triangle of 1000 steps: p^2 = 1 + 1000 at 501, wherever on the way it is planned
 * again. */
START_TEST(P7_R6_a_peak_at_a_whole_step_is_shown_there_after_changes)
{
    uint64_t slot = 961 + 37 * (uint64_t)_i;
    const char wanted[] = ",(502;31),(1001;0)]";
    rig_accept(&rig, '1', "S1 A1 V16000 F1001 R");
    rig_accept_at(&rig, 5 * MS + 200 * MS, "V1");
    rig_accept_at(&rig, 5 * MS + 960 * MS, "V16000");
    rig_accept_at(&rig, (5 + slot) * MS, "V15000");
    rig_to(&rig, rkm04_now(&rig.unit) + 1);
    ck_assert_msg(strstr(rig_ask(&rig, 6, 1), wanted) != NULL, "%s is not in %s", wanted, rig_ask(&rig, 6, 1));
}
END_TEST

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))

static Suite *profile_suite(void)
{
    Suite *suite = suite_create("profile");
    TCase *stop = tcase_create("stop");
    tcase_add_checked_fixture(stop, setup, teardown);
    tcase_add_loop_test(stop, R5_an_irrational_way_adds_a_step_from_a_millionth_of_a_step_on, 0, COUNT(irrational));
    tcase_add_loop_test(stop, R5_a_rational_way_adds_a_step_however_little_is_left, 0, COUNT(rational));
    tcase_add_loop_test(stop, R5_C4_after_a_change_at_any_speed_a_whole_way_adds_no_step, 1001, 1008);
    tcase_add_loop_test(stop, R5_C4_after_a_change_in_a_slow_segment_a_whole_way_adds_no_step_in_a_fast_one, 1001, 1008);
    suite_add_tcase(suite, stop);
    TCase *points = tcase_create("points");
    tcase_add_checked_fixture(points, setup, teardown);
    tcase_add_test(points, P7_no_point_lies_after_the_last_step_of_a_stop);
    tcase_add_loop_test(points, P7_a_point_hardly_below_a_whole_step_is_still_of_that_step, 0, COUNT(below));
    tcase_add_test(points, P7_a_whole_step_is_shown_as_such_after_two_changes_at_broken_speeds);
    tcase_add_loop_test(points, P7_R6_a_peak_at_a_whole_step_is_shown_there_after_changes, 0, 80);
    suite_add_tcase(suite, points);
    return suite;
}

int main(void)
{
    return rig_run(profile_suite(), "./test_profile");
}
