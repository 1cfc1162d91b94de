/* SPDX-License-Identifier: MIT */
/* test_prt_motion.c: what Get Tabul Run and Get Pozic Run answer, P7 and P9 of the specification. */
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
    ck_assert_uint_eq(rig.flash.misuse, 0);
    rig_free(&rig);
}

static void exchange(const char *request, size_t request_length, const char *answer, size_t answer_length)
{
    uint8_t got[512];
    size_t length = rkm04_exchange(&rig.unit, (const uint8_t *)request, request_length, got, sizeof got);
    ck_assert_msg(length == answer_length, "an answer of %zu bytes, not %zu", length, answer_length);
    for (size_t i = 0; i < length; i++)
        ck_assert_msg(got[i] == (uint8_t)answer[i], "byte %zu of the answer is %02X, not %02X", i, got[i], (uint8_t)answer[i]);
}

/* Both are string literals without their final zero. */
#define ASK(request, answer) exchange(request, sizeof(request) - 1, answer, sizeof(answer) - 1)


START_TEST(P7_without_a_motion_there_are_no_points)
{
    ASK("\x06" "1", "\x06" "1 0;[]");
    rig_accept(&rig, '1', "F100 R");
    rig_to(&rig, 1 * SECOND);
    ASK("\x06" "1", "\x06" "1 0;[]");
}
END_TEST

/* d = (1000^2 - 100^2) / (2 * 2000) = 247.5 on both sides. */
START_TEST(P7_a_trapezoid_has_four_points)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 2 * MS + 1);
    ASK("\x06" "1", "\x06" "1 4;[(1;100),(248;1000),(4753;1000),(5000;0)]");
    rig_to(&rig, 5 * SECOND); /* and keeps them to its end */
    ASK("\x06" "1", "\x06" "1 4;[(1;100),(248;1000),(4753;1000),(5000;0)]");
}
END_TEST

/* p^2 = 100^2 + 2000 * 1000, p = 1417.7 at d = 500. */
START_TEST(P7_a_triangle_has_three_points)
{
    rig_accept(&rig, '1', "V3000 F1000 R");
    rig_to(&rig, 100 * MS);
    ASK("\x06" "1", "\x06" "1 3;[(1;100),(501;1417),(1000;0)]");
}
END_TEST

START_TEST(P7_a_constant_speed_has_two_points)
{
    rig_accept(&rig, '1', "V50 F10 R");
    rig_to(&rig, 100 * MS);
    ASK("\x06" "1", "\x06" "1 2;[(1;50),(10;0)]");
}
END_TEST

/* d = (101^2 - 100^2) / (2 * 100) = 1.005 and 3 - 1.005 = 1.995: the same step, the same speed. */
START_TEST(P7_equal_points_merge)
{
    rig_accept(&rig, '1', "A100 V101 F3 R");
    rig_to(&rig, 10 * MS);
    ASK("\x06" "1", "\x06" "1 3;[(1;100),(2;101),(3;0)]");
}
END_TEST

START_TEST(P7_the_compound_motion_of_the_manual_has_thirteen_points)
{
    rig_accept(&rig, '1', "S100 A2000 V500 F2000 Y V2000 Y V500 F5000 Y V3000 A1000 Y V1500 F2000 Y V500 Y R");
    rig_to(&rig, 1 * SECOND);
    ck_assert_str_eq(rig_ask(&rig, 6, 1), " 13;[(1;100),(61;500),(2001;500),(2938;2000),(3063;2000),(4001;500),(9001;500),"
                                          "(12001;2500),(14001;1500),(15001;1500),(16001;500),(17881;500),(18000;0)]");
}
END_TEST

START_TEST(P7_an_endless_motion_has_no_last_point)
{
    rig_accept(&rig, '1', "G+");
    rig_accept(&rig, '2', "V50 G-");
    rig_to(&rig, 1 * SECOND);
    ASK("\x06" "1", "\x06" "1 2;[(1;100),(248;1000)]");
    ASK("\x06" "2", "\x06" "2 1;[(1;50)]");
}
END_TEST

START_TEST(P7_a_limit_move_has_one_point)
{
    rig_accept(&rig, '1', ")05");
    rig_to(&rig, 1 * SECOND);
    ASK("\x06" "1", "\x06" "1 1;[(1;100)]");
}
END_TEST

/* R in slot 2000; one second later x = 247.5 + 550 = 797.5, and the way down to S is another 247.5. */
START_TEST(P7_a_stop_keeps_the_points_passed_and_adds_the_way_down)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1002 * MS);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 1003 * MS);
    ASK("\x06" "1", "\x06" "1 4;[(1;100),(248;1000),(798;1000),(1045;0)]");
}
END_TEST

START_TEST(P7_a_held_motion_shows_how_far_it_went)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1002 * MS);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 3 * SECOND);
    ASK("\x06" "1", "\x06" "1 4;[(1;100),(248;1000),(798;1000),(1045;0)]");
    ASK("\x07" "1", "\x07" "1 1045; 2");
}
END_TEST

/* 0.2 s of rising: x = 60, v = 500, down to S in another 60 steps. */
START_TEST(P7_points_that_a_stop_has_made_void_are_gone)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 202 * MS);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 203 * MS);
    ASK("\x06" "1", "\x06" "1 3;[(1;100),(61;500),(120;0)]");
}
END_TEST

/* At x = 797.5 from 1000 down to 500: 187.5 steps; and 60 steps from 500 to S at the end. */
START_TEST(P7_a_change_of_speed_adds_its_corners)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1002 * MS);
    rig_accept(&rig, '1', "V500");
    rig_to(&rig, 1003 * MS);
    ASK("\x06" "1", "\x06" "1 6;[(1;100),(248;1000),(798;1000),(986;500),(4941;500),(5000;0)]");
}
END_TEST


START_TEST(P7_R6_a_change_of_speed_on_the_final_ramp_adds_no_corner)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 5200 * MS, "V500");
    rig_to(&rig, 5210 * MS);
    ASK("\x06" "1", "\x06" "1 4;[(1;100),(248;1000),(4753;1000),(5000;0)]");
}
END_TEST

/* Every change up to S happens at once and adds two corners, before and after it: of more than the table holds, the oldest are
 * forgotten. G+ begins at 3 ms with `speed`; it is first + by * i after the i-th change, at 100 + 70 * i ms. Multiples of 10. */
static void expect_newest_corners(unsigned speed, int first, int by)
{
    enum { CHANGES = RKM04_BREAKS_MAX, KEPT = RKM04_BREAKS_MAX / 2 };
    char text[30], wanted[40 * KEPT + 20];
    unsigned tenths = speed * 97 / 100; /* of a step: where the next change is */
    sprintf(text, "S1000 V%u G+", speed);
    rig_accept(&rig, '1', text);
    size_t length = (size_t)sprintf(wanted, " %u;[", RKM04_BREAKS_MAX);
    for (unsigned i = 0; i < CHANGES; i++) {
        unsigned before = speed, step = tenths / 10 + 1;
        speed = (unsigned)(first + by * (int)i);
        sprintf(text, "V%u", speed);
        rig_accept_at(&rig, (100 + 70 * i) * MS - 500, text);
        if (i >= CHANGES - KEPT)
            length += (size_t)sprintf(wanted + length, "(%u;%u),(%u;%u)%s", step, before, step, speed,
                                      i + 1 < CHANGES ? "," : "]");
        tenths += speed * 7 / 10;
    }
    rig_to(&rig, 10 * SECOND);
    ck_assert_str_eq(rig_ask(&rig, 6, 1), wanted);
}

START_TEST(P7_of_many_changes_to_more_speed_the_newest_corners_are_kept)
{
    expect_newest_corners(1000, 200, 10);
}
END_TEST

START_TEST(P7_of_many_changes_to_less_speed_the_newest_corners_are_kept)
{
    expect_newest_corners(1000, 900, -10);
}
END_TEST

START_TEST(P9_the_index_is_the_place_of_the_command_being_executed)
{
    ASK("\x07" "1", "\x07" "1 0; 0");
    rig_accept(&rig, '1', "W5 F1000 R O03 U");
    rig_to(&rig, 3 * MS);
    ASK("\x07" "1", "\x07" "1 0; 1"); /* in the dwell */
    rig_to(&rig, 8 * MS + 250 * MS);
    ck_assert_str_eq(strchr(rig_ask(&rig, 7, 1), ';'), "; 3"); /* in the motion */
    rig_to(&rig, 3 * SECOND);
    ASK("\x07" "1", "\x07" "1 0; 4"); /* in the wait */
    rig_input_at(&rig, 3 * SECOND, 3, true);
    rig_to(&rig, 4 * SECOND);
    ASK("\x07" "1", "\x07" "1 0; 0"); /* idle */
}
END_TEST

START_TEST(P9_between_arrival_and_its_slot_the_first_new_command_is_shown)
{
    rig_accept(&rig, '1', "T01 T02");
    rig_to(&rig, 10 * MS + 500);
    ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 0");
    rig_accept(&rig, '1', "T03");
    ck_assert_str_eq(rig_ask(&rig, 7, 1), " 0; 3");
}
END_TEST

START_TEST(P9_the_index_stays_at_the_fault)
{
    rig_accept(&rig, '1', "U U J5 U");
    rig_to(&rig, 1 * SECOND);
    ASK("\x07" "1", "\x07" "1 0; 3");
}
END_TEST

START_TEST(P9_the_index_is_0_after_a_total_stop)
{
    rig_accept(&rig, '1', "X04 W1000");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_to(&rig, 200 * MS);
    ASK("\x07" "1", "\x07" "1 0; 0");
}
END_TEST

START_TEST(P9_the_steps_count_up_during_a_motion_and_are_0_after_it)
{
    rig_accept(&rig, '1', "F5000 R W10000");
    rig_to(&rig, 1002 * MS + 1); /* x = 797.5 */
    ASK("\x07" "1", "\x07" "1 797; 2");
    rig_to(&rig, 1003 * MS + 1);
    ASK("\x07" "1", "\x07" "1 798; 2");
    rig_to(&rig, 8 * SECOND);
    ASK("\x07" "1", "\x07" "1 0; 3");
}
END_TEST

START_TEST(P9_a_compound_motion_counts_as_one)
{
    rig_accept(&rig, '1', "V100 F100 Y Y Y R");
    rig_to(&rig, 6 * MS + 2500 * MS + 1); /* 100 steps/s all the way */
    ASK("\x07" "1", "\x07" "1 250; 6");
}
END_TEST

START_TEST(P9_the_steps_stay_during_a_hold_and_go_on_counting_after_it)
{
    rig_accept(&rig, '1', "V100 F1000 R");
    rig_to(&rig, 3 * MS + 500 * MS);
    rig_accept(&rig, '1', "K");
    rig_to(&rig, 1 * SECOND);
    uint32_t held = rig_motor(&rig, 1).steps;
    ck_assert_uint_ge(held, 50);
    ck_assert_uint_le(held, 51);
    ck_assert_str_eq(strchr(rig_ask(&rig, 7, 1), ';'), "; 3");
    rig_accept(&rig, '1', "C75");
    rig_to(&rig, 1 * SECOND + 100 * MS + 1);
    ck_assert_uint_eq(rig_motor(&rig, 1).steps, held + 10);
}
END_TEST

static Suite *prt_motion_suite(void)
{
    Suite *suite = suite_create("prt_motion");

    TCase *table = tcase_create("table");
    tcase_add_checked_fixture(table, setup, teardown);
    tcase_add_test(table, P7_without_a_motion_there_are_no_points);
    tcase_add_test(table, P7_a_trapezoid_has_four_points);
    tcase_add_test(table, P7_a_triangle_has_three_points);
    tcase_add_test(table, P7_a_constant_speed_has_two_points);
    tcase_add_test(table, P7_equal_points_merge);
    tcase_add_test(table, P7_the_compound_motion_of_the_manual_has_thirteen_points);
    tcase_add_test(table, P7_an_endless_motion_has_no_last_point);
    tcase_add_test(table, P7_a_limit_move_has_one_point);
    tcase_add_test(table, P7_a_stop_keeps_the_points_passed_and_adds_the_way_down);
    tcase_add_test(table, P7_a_held_motion_shows_how_far_it_went);
    tcase_add_test(table, P7_points_that_a_stop_has_made_void_are_gone);
    tcase_add_test(table, P7_a_change_of_speed_adds_its_corners);
    tcase_add_test(table, P7_R6_a_change_of_speed_on_the_final_ramp_adds_no_corner);
    tcase_add_test(table, P7_of_many_changes_to_more_speed_the_newest_corners_are_kept);
    tcase_add_test(table, P7_of_many_changes_to_less_speed_the_newest_corners_are_kept);
    suite_add_tcase(suite, table);

    TCase *progress = tcase_create("progress");
    tcase_add_checked_fixture(progress, setup, teardown);
    tcase_add_test(progress, P9_the_index_is_the_place_of_the_command_being_executed);
    tcase_add_test(progress, P9_between_arrival_and_its_slot_the_first_new_command_is_shown);
    tcase_add_test(progress, P9_the_index_stays_at_the_fault);
    tcase_add_test(progress, P9_the_index_is_0_after_a_total_stop);
    tcase_add_test(progress, P9_the_steps_count_up_during_a_motion_and_are_0_after_it);
    tcase_add_test(progress, P9_a_compound_motion_counts_as_one);
    tcase_add_test(progress, P9_the_steps_stay_during_a_hold_and_go_on_counting_after_it);
    suite_add_tcase(suite, progress);

    return suite;
}

int main(void)
{
    return rig_run(prt_motion_suite(), "./test_prt_motion");
}
