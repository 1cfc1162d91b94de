/* SPDX-License-Identifier: MIT */
/* The block machine of a CNC872: worked examples of docs/CNC872.md (W...), blocks and sections. */
#include "cnc_rig.h"

#define PARABOLIC "<ChannelConfig AccelerationType=\"1\"/>"

static void start_in(uint64_t turn)
{
    run_to(turn - 1);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
}

START_TEST(power_up)
{
    rig_power(NULL, NULL);
    ck_assert(!bit("SF_STOP") && !bit("PO_F") && bit("INPOS") && bit("INPOS_STOP") && bit("MPXPI") && bit("VAZBA_X"));
    ck_assert_int_eq(cnc_start(&cnc), CNC_NO_PROGRAM);
    rig_power(NULL, "G1 X1 F1000");
    ck_assert(bit("SF_STOP"));
}
END_TEST

START_TEST(W30_delay)
{
    rig_begin("G04 P0.1");
    run_to(110);
    ck_assert_uint_eq(at(1).phase, CNC_INIT);
    for (uint64_t turn = 2; turn <= 101; turn++)
        ck_assert_uint_eq(at(turn).phase, CNC_DELAY);
    ck_assert_uint_eq(at(102).phase, CNC_DONE);
    ck_assert_uint_eq(first_end(1), 103);
}
END_TEST

START_TEST(W30_stop_in_a_delay)
{
    rig_begin("G04 P0.1");
    run_to(49);
    ck_assert(bit("PRODLEVA") && bit("SF_DELAYINPROGR"));
    cnc_stop(&cnc);
    run_to(60);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_eq(cell("STATUS_RESTART", 0), CNC_DELAY);
    start_in(200);
    run_to(253);
    ck_assert(bit("PRODLEVA"));
    run_to(254);
    ck_assert(!bit("PRODLEVA"));
    run_to(300);
    ck_assert_uint_eq(first_end(1), 255);
}
END_TEST

START_TEST(W31_programmed_stop)
{
    rig_begin("M0\nM8");
    run_to(7);
    ck_assert(!at(2).sf_stop && at(3).sf_stop && !at(3).po_stop && !at(3).po_f);
    start_in(8);
    run_to(8);
    ck_assert(bit("PO_F") && !bit("SF_STOP"));
    ck_assert_uint_eq(cnc.machine.block, 1);
}
END_TEST

START_TEST(stops_of_the_panel)
{
    rig_begin("M1\nM1\nM8\nM8");
    run_to(3);
    ck_assert_uint_eq(cnc.machine.block, 1); /* M01 is off */
    cnc.panel.m01 = true;
    run_to(5);
    ck_assert(bit("SF_STOP") && bit("SF_CONDSTOPMODE") && bit("SF_BLOCKFINISHED"));
    cnc.panel.block_by_block = true;
    start_in(7);
    run_to(20);
    ck_assert(bit("SF_STOP") && bit("SF_BLOCKBYBLOCK") && !bit("PO_STOP"));
    ck_assert_uint_eq(cnc.machine.next, 3);
}
END_TEST

START_TEST(W32_two_blocks)
{
    rig_begin("G0 X1\nG1 X1.5 F1000 M30");
    run_to(64);
    ck_assert(bit("G00PI") && bit("PO_POL"));
    run_to(65);
    ck_assert(!bit("G00PI") && !bit("PO_POL") && bit("PO_F"));
    run_to(140);
    ck_assert_uint_eq(first_reached(1), 64);
    ck_assert_uint_eq(at(65).block, 1);
    ck_assert_int_eq(at(65).v, 0);
    ck_assert_int_gt(at(66).v, 0);
    ck_assert_uint_eq(first_reached(65), 128);
    ck_assert_uint_eq(first_end(1), 129);
    ck_assert(at(129).sf_stop);
    ck_assert_uint_eq(cnc.machine.next, 0);
}
END_TEST

/* ---- Sections ------------------------------------------------------------------------------------------------------------ */

static const char w33[] = "G23\nG1 X10 F1000\nX20 Y1 F600\nX30 Y2 F1000";
static const char w33_without[] = "G24\nG1 X10 F1000\nX20 Y1 F600\nX30 Y2 F1000";

/* The section without its own block for G23: the numbers of W33 count from the start of its first motion. */
static void begin_section(const char *xml)
{
    rig_begin_with(xml, "G23 G1 X10 F1000\nX20 Y1 F600\nX30 Y2 F1000");
}

/* The speed in the T in which the path has got to the border of a segment; that T. */
static uint64_t first_behind(unsigned segment, int64_t *v)
{
    uint64_t turn = 1;
    int64_t way = 0;
    for (; turn <= cnc.turn; turn++) {
        way += at(turn).v;
        if (way >= cnc.move.section.segment[segment].border)
            break;
    }
    *v = at(turn).v;
    return turn;
}

static const struct {
    const char *xml;
    uint64_t border[3];
    int64_t v[3];
    uint64_t published[2], end, time_dist, rest;
    int64_t rest_x;
    uint64_t end_after_stop;
} section[] = {
    {NULL, {620, 1625, 2247}, {658508, 655360, 20370}, {621, 1626}, 2248, 2146, 649, 670684527, 2614},
    {PARABOLIC, {655, 1660, 2316}, {655360, 655360, 435}, {656, 1661}, 2317, 2215, 700, 666413613, 2680},
};

START_TEST(W33_section)
{
    begin_section(section[_i].xml);
    run_to(1);
    ck_assert(!bit("G23ACT"));
    run_to(2);
    ck_assert(bit("G23ACT"));
    run_to(101);
    ck_assert_int_eq(cell("TIME_DIST", 0), (int64_t)section[_i].time_dist);
    run_to(section[_i].published[1]);
    for (unsigned k = 0; k < 2; k++) {
        int64_t v;
        ck_assert_uint_eq(first_behind(k, &v), section[_i].border[k]);
        ck_assert_int_eq(v, section[_i].v[k]);
        ck_assert_uint_eq(at(section[_i].published[k]).block, k + 1);
        ck_assert_uint_eq(at(section[_i].published[k] - 1).block, k);
    }
    run_to(section[_i].border[2] - 1);
    ck_assert(bit("G23ACT"));
    ck_assert_int_eq(cell("TIME_DIST", 0), 1);
    run_to(section[_i].border[2]);
    ck_assert(!bit("G23ACT"));
    ck_assert_int_eq(cell("TIME_DIST", 0), 0);
    ck_assert_int_eq(at(cnc.turn).v, section[_i].v[2]);
    run_to(section[_i].end);
    ck_assert_uint_eq(first_end(1), section[_i].end);
    ck_assert_int_eq(at(cnc.turn).x, 30 * MM);
    ck_assert_int_eq(at(cnc.turn).y, 2 * MM);
}
END_TEST

START_TEST(W33_stop_in_a_section)
{
    begin_section(section[_i].xml);
    run_to(639);
    cnc_stop(&cnc);
    run_to(900);
    const int64_t time = cell("TIME_DIST", 0);
    run_to(999);
    ck_assert_int_eq(cell("TIME_DIST", 0), time); /* it stands */
    ck_assert_int_gt(time, 0);
    start_in(1000);
    run_to(2700);
    ck_assert_uint_eq(first_rest(640), section[_i].rest);
    ck_assert_int_eq(at(section[_i].rest).x, section[_i].rest_x);
    ck_assert_uint_eq(first_stop(1), section[_i].rest);
    ck_assert_int_eq(at(1000).v, 0);
    ck_assert_int_ge(at(1002).v, 1);
    ck_assert_uint_eq(first_end(1), section[_i].end_after_stop);
    ck_assert_int_eq(at(2700).x, 30 * MM);
}
END_TEST

START_TEST(W33_without_G23)
{
    rig_begin("G1 X10 F1000\nX20 Y1 F600\nX30 Y2 F1000");
    run_to(2300);
    ck_assert_uint_eq(first_end(1), 2297);
    rig_begin(w33); /* a block G23 of its own takes two T's */
    run_to(2300);
    ck_assert_uint_eq(first_end(1), 2250);
    rig_begin(w33_without);
    run_to(2300);
    ck_assert_uint_eq(first_end(1), 2299);
}
END_TEST

/* How many segments the first section of a program has. */
static unsigned count_segments(const char *xml, const char *nc)
{
    rig_begin_with(xml, nc);
    run_to(1);
    return cnc.move.section.count;
}

START_TEST(what_ends_a_section)
{
    static const char breaks[] = "<ChannelConfig><MFunctions><MFunc No=\"80\" BreakCont=\"1\"/>"
                                 "<MFunc No=\"81\" BreakContEnd=\"1\"/></MFunctions></ChannelConfig>";
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX2\nX3"), 3);
    ck_assert_uint_eq(count_segments(NULL, "G1 X1 F100\nX2\nX3"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX2\nG24 X3"), 2);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nG0 X2"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G0 X1\nG1 X2 F100"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nG4 P1"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nG4 P1 X2"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX1\nX2"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX0"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nY1"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nM0 X2\nX3"), 2);
    ck_assert_uint_eq(count_segments(breaks, "G23 G1 X1 F100\nM80 X2\nX3"), 1);
    ck_assert_uint_eq(count_segments(breaks, "G23 G1 X1 F100 M80\nX2\nX3"), 3);
    ck_assert_uint_eq(count_segments(breaks, "G23 G1 X1 F100\nM81 X2\nX3"), 2);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX2\nX3\nX4\nX5\nX6\nX7\nX8\nX9\nX10\nX11\nX12\nX13\n"
                                           "X14\nX15\nX16"), 15);
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX2 Y0.1763"), 2); /* 9.998 degrees */
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X1 F100\nX2 Y0.1764"), 1); /* 10.004 degrees */
    ck_assert_uint_eq(count_segments(NULL, "G23 G1 X200000 F100\nX-200000"), 1);
}
END_TEST

/* The cosine is 984 807 / 1 000 000 exactly; the target 1/1 000 000 mm short makes the angle larger. */
START_TEST(the_angle_that_ends_a_section)
{
    static const char five_axes[] = "<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Y\"/><Axis Name=\"Z\"/><Axis Name=\"4\"/>"
                                    "<Axis Name=\"5\"/></ChannelConfig>";
    ck_assert_uint_eq(count_segments(five_axes, "G23 G1 X10 F100\nX133.100875 Y21.706375 Z0.088625 A4=0.001625 A5=0.00125"), 2);
    ck_assert_uint_eq(count_segments(five_axes, "G23 G1 X10 F100\nX133.100874 Y21.706375 Z0.088625 A4=0.001625 A5=0.00125"), 1);
    ck_assert_uint_eq(count_segments(NULL, "G23 G33 X1 F1\nX2"), 2);
}
END_TEST

/* NB2: M02 and M30 rewind the program in its midst. */
START_TEST(an_end_in_the_midst_of_a_program)
{
    static const char *const programs[] = {"M8\nM2\nM9", "M8\nM30\nM9"};
    for (unsigned i = 0; i < 2; i++) {
        rig_begin(programs[i]);
        run_to(20);
        ck_assert(bit("SF_STOP") && !bit("PO_F") && bit("M08PI"));
        ck_assert_uint_eq(cnc.machine.next, 0);
        ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK), 2);
    }
}
END_TEST

/* TIME_DIST: the path ends in more than 2^31 T's, or its ramps take too many of them. */
START_TEST(a_section_that_is_too_long_to_look_at)
{
    rig_begin("G23 G1 X100 F0.001\nX200");
    run_to(10);
    ck_assert_int_eq(cell("TIME_DIST", 0), INT32_MAX);
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" Acceleration=\"0.001\"/></ChannelConfig>", "G23 G1 X100 F1000\nX200");
    run_to(10);
    ck_assert_int_eq(cell("TIME_DIST", 0), INT32_MAX);
}
END_TEST

START_TEST(block_by_block_makes_no_section)
{
    rig_power(NULL, "G23 G1 X1 F1000\nX2");
    cnc.panel.block_by_block = true;
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(300);
    ck_assert_int_eq(at(300).x, 1 * MM);
    ck_assert(bit("SF_STOP") && !bit("PO_F"));
}
END_TEST

START_TEST(block_by_block_within_a_section_stops_at_its_end)
{
    rig_begin("G23 G1 X1 F1000\nX2\nG24 X3");
    run_to(20);
    cnc.panel.block_by_block = true;
    run_to(600);
    ck_assert_int_eq(at(600).x, 2 * MM);
    ck_assert(bit("SF_STOP") && !bit("PO_F"));
}
END_TEST

START_TEST(a_section_of_two_blocks_that_is_annulled)
{
    rig_begin("G23 G1 X1 F1000\nX2");
    run_to(20);
    ck_assert(bit("G23ACT"));
    ck_assert_int_gt(cell("TIME_DIST", 0), 0);
    cnc_reset(&cnc);
    run_to(100);
    ck_assert(!bit("PO_F") && !bit("G23ACT"));
    ck_assert_int_eq(cell("TIME_DIST", 0), 0);
}
END_TEST

START_TEST(a_section_that_does_not_end)
{
    begin_section(_i == 0 ? NULL : PARABOLIC);
    run_to(99);
    cnc.panel.feed = 0;
    run_to(300);
    ck_assert_int_eq(cell("TIME_DIST", 0), INT32_MAX);
    ck_assert(bit("G23ACT"));
    cnc.panel.feed = 100;
    run_to(351);
    cnc.panel.feed = 90; /* worked out anew within a ramp */
    run_to(352);
    const int64_t time = cell("TIME_DIST", 0);
    run_to(352 + (uint64_t)time);
    ck_assert_int_eq(at(cnc.turn).x, 30 * MM);
    ck_assert_int_lt(at(cnc.turn - 1).x, 30 * MM);
}
END_TEST

static Suite *block_suite(void)
{
    Suite *suite = suite_create("cnc_block");
    TCase *blocks = tcase_create("blocks"), *sections = tcase_create("sections");
    tcase_add_test(blocks, power_up);
    tcase_add_test(blocks, W30_delay);
    tcase_add_test(blocks, W30_stop_in_a_delay);
    tcase_add_test(blocks, W31_programmed_stop);
    tcase_add_test(blocks, stops_of_the_panel);
    tcase_add_test(blocks, W32_two_blocks);
    tcase_add_loop_test(sections, W33_section, 0, 2);
    tcase_add_loop_test(sections, W33_stop_in_a_section, 0, 2);
    tcase_add_test(sections, W33_without_G23);
    tcase_add_test(sections, what_ends_a_section);
    tcase_add_test(sections, the_angle_that_ends_a_section);
    tcase_add_test(sections, an_end_in_the_midst_of_a_program);
    tcase_add_test(sections, a_section_that_is_too_long_to_look_at);
    tcase_add_test(sections, block_by_block_makes_no_section);
    tcase_add_test(sections, block_by_block_within_a_section_stops_at_its_end);
    tcase_add_test(sections, a_section_of_two_blocks_that_is_annulled);
    tcase_add_loop_test(sections, a_section_that_does_not_end, 0, 2);
    suite_add_tcase(suite, blocks);
    suite_add_tcase(suite, sections);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(block_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
