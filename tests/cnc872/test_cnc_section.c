/* SPDX-License-Identifier: MIT */
/* Sections of a continuous path (NM8): borders, angles, TIME_DIST and G23ACT, beside the worked examples of test_cnc_block.c. */
#include "cnc_rig.h"

START_TEST(NM8_a_section_of_fifteen_blocks)
{
    rig_begin("G23 G1 X1 F1000\nX2\nX3\nX4\nX5\nX6\nX7\nX8\nX9\nX10\nX11\nX12\nX13\nX14\nX15\nX16\nX17");
    run_to(20);
    ck_assert_double_gt(cnc_queue_real(&cnc, 14, CNC_QUEUE_FeedCriterial, 0), 999);
    ck_assert_double_eq(cnc_queue_real(&cnc, 15, CNC_QUEUE_FeedCriterial, 0), 0);
    const uint64_t end = 20 + (uint64_t)cell("TIME_DIST", 0);
    run_to(end);
    ck_assert_int_eq(at(end).x, 15 * MM);
    ck_assert_int_lt(at(end - 1).x, 15 * MM);
    run_to(2000);
    ck_assert_int_eq(at(2000).x, 17 * MM);
    ck_assert(bit("SF_STOP"));
}
END_TEST

/* LinearAccel / ParabAccel = 2 T, the shortest average there is: 100 mm/min at the very border, and up to the next one. */
START_TEST(NM8_a_border_with_the_shortest_average)
{
    rig_begin_with("<ChannelConfig AccelerationType=\"1\">"
                   "<Axis Name=\"X\" LinearAccel=\"400\" ParabAccel=\"200\"/></ChannelConfig>",
                   "G23 G1 X1 F1000\nX1.5 F100\nX2 F1000");
    run_to(11);
    ck_assert_int_eq(cell("TIME_DIST", 0), 457);
    run_to(470);
    ck_assert_int_eq(at(99).x, 65426774);
    ck_assert_int_eq(at(100).x, MM);
    for (uint64_t turn = 100; turn <= 400; turn++)
        ck_assert_int_eq(at(turn).v, 109226);
    ck_assert_int_lt(at(467).x, 2 * MM);
    ck_assert_int_eq(at(468).x, 2 * MM);
}
END_TEST

START_TEST(NM8_TIME_DIST_stands_in_a_hold)
{
    rig_begin("G23 G1 X10 F1000\nX20");
    run_to(100);
    set_bit("MPXPI", false);
    run_to(101);
    const int64_t time = cell("TIME_DIST", 0);
    ck_assert_int_gt(time, 1000);
    run_to(200);
    ck_assert_int_eq(cell("TIME_DIST", 0), time);
    ck_assert(bit("G23ACT"));
    set_bit("MPXPI", true);
    run_to(201);
    const uint64_t end = 201 + (uint64_t)cell("TIME_DIST", 0);
    run_to(end);
    ck_assert_int_eq(at(end).x, 20 * MM);
}
END_TEST

/* A hold that stops at once changes neither acceleration nor target: TIME_DIST is worked out anew behind it all the same. */
START_TEST(NM8_TIME_DIST_behind_a_hold_that_stops_at_once)
{
    for (unsigned critical = 0; critical < 2; critical++) {
        rig_begin_with(critical ? NULL : "<ChannelConfig AccelerationType=\"1\"><Axis Name=\"X\"/></ChannelConfig>",
                       "G23 G1 X10 F1000\nX20");
        run_to(100);
        set_bit("MPXPI", critical);
        cnc_set_critical(&cnc, critical ? 7 : 0);
        run_to(200);
        ck_assert(at(200).v == 0 && bit("G23ACT"));
        set_bit("MPXPI", true);
        cnc_set_critical(&cnc, 0);
        run_to(201);
        const uint64_t end = 201 + (uint64_t)cell("TIME_DIST", 0);
        run_to(end);
        ck_assert_int_eq(at(end).x, 20 * MM);
        ck_assert_int_lt(at(end - 1).x, 20 * MM);
    }
}
END_TEST

START_TEST(NM8_G23ACT_from_the_first_T_also_in_a_hold)
{
    rig_begin_with("<ChannelConfig AccelerationType=\"1\"><Axis Name=\"X\"/></ChannelConfig>", "G23 G1 X10 F1000\nX20");
    set_bit("MPXPI", false);
    run_to(2);
    ck_assert(bit("G23ACT"));
    set_bit("MPXPI", true);
    run_to(3);
    run_to(3 + (uint64_t)cell("TIME_DIST", 0));
    ck_assert_int_eq(cnc.axis[0].position, 20 * MM);
}
END_TEST

/* The same angle as in cnc_block, exactly 984 807 / 1 000 000, between ways whose products have all their digits. */
START_TEST(NM8_the_angle_in_all_its_digits)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Y\"/><Axis Name=\"Z\"/><Axis Name=\"4\"/><Axis Name=\"5\"/>"
                   "</ChannelConfig>", "G23 G1 X1 F100\nX2");
    static const int64_t b[] = {984807, 173651, 709, 13, 10};
    for (int64_t more = -1; more <= 1; more++) {
        int64_t values[16] = {16777213}; /* of X in the first block, then of the second one */
        for (unsigned i = 0; i < 5; i++)
            values[1 + i] = b[i] * 16777259 + (i == 0 ? 16777213 + more : 0);
        struct cnc_nc_block blocks[] = {program.blocks[0], program.blocks[1]};
        blocks[0].values = 0;
        blocks[1].values = 1;
        blocks[1].axes = 0x1F;
        const struct cnc_nc_program own = {.blocks = blocks, .values = values, .block_count = 2, .value_count = 6};
        const int64_t place[CNC_AXES] = {0};
        struct cnc_section section;
        cnc_section_build(&section, &config, &own, 0, place, false);
        ck_assert_uint_eq(section.count, more >= 0 ? 2 : 1);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_section");
    TCase *all = tcase_create("sections");
    tcase_add_test(all, NM8_a_section_of_fifteen_blocks);
    tcase_add_test(all, NM8_a_border_with_the_shortest_average);
    tcase_add_test(all, NM8_TIME_DIST_stands_in_a_hold);
    tcase_add_test(all, NM8_TIME_DIST_behind_a_hold_that_stops_at_once);
    tcase_add_test(all, NM8_G23ACT_from_the_first_T_also_in_a_hold);
    tcase_add_test(all, NM8_the_angle_in_all_its_digits);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
