/* SPDX-License-Identifier: MIT */
/* The block machine of a CNC872: worked examples of docs/CNC872.md (W...), starts, stops, annulment. */
#include "cnc_rig.h"

#define PARABOLIC "<ChannelConfig AccelerationType=\"1\"/>"

static void set_in(uint64_t turn, const char *name, bool value)
{
    run_to(turn - 1);
    set_bit(name, value);
}

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

START_TEST(a_section_that_does_not_end)
{
    begin_section(NULL);
    run_to(99);
    cnc.panel.feed = 0;
    run_to(300);
    ck_assert_int_eq(cell("TIME_DIST", 0), INT32_MAX);
    ck_assert(bit("G23ACT"));
    cnc.panel.feed = 100;
    run_to(301);
    const int64_t time = cell("TIME_DIST", 0);
    run_to(301 + (uint64_t)time);
    ck_assert_int_eq(at(cnc.turn).x, 30 * MM);
    ck_assert_int_lt(at(cnc.turn - 1).x, 30 * MM);
}
END_TEST

/* ---- Starts and stops ---------------------------------------------------------------------------------------------------- */

START_TEST(W36_a_program_outside)
{
    rig_power(NULL, "G1 X1 F1000");
    set_bit("EXT_PLC", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(29);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_INIT);
    set_bit("PLC_PASS_DONE", true);
    run_to(30);
    ck_assert(!bit("PLC_PASS_DONE"));
    ck_assert_int_eq(cell("PLC_PASS", 0), 0);
    run_to(199);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_DONE);
    set_bit("PLC_PASS_DONE", true);
    run_to(220);
    ck_assert_int_eq(at(29).x, 0);
    ck_assert_int_eq(at(30).x, 32768);
    ck_assert_uint_eq(first_reached(1), 122);
    ck_assert_uint_eq(first_end(1), 200);
}
END_TEST

START_TEST(W37_central_annulment)
{
    rig_begin("G1 X10 F1000");
    run_to(199);
    cnc_reset(&cnc);
    run_to(216);
    ck_assert(!bit("CAPI") && bit("PO_F"));
    run_to(217);
    ck_assert(bit("CAPI") && !bit("AUTPI") && !bit("PO_STOP") && bit("PO_F") && !bit("PO_OSXPI"));
    ck_assert_int_eq(cnc_start(&cnc), CNC_UNDER_WAY);
    run_to(300);
    ck_assert_uint_eq(first_rest(200), 216);
    ck_assert_uint_eq(first_end(1), 219);
    ck_assert_int_eq(at(300).x, 207170098);
    ck_assert(bit("CAPI") && bit("SF_STOP"));
    start_in(301);
    run_to(302);
    ck_assert(!bit("CAPI") && bit("AUTPI"));
    ck_assert_uint_eq(cnc.machine.block, 0);
}
END_TEST

START_TEST(annulment_at_rest)
{
    rig_begin("G1 X10 F1000\nG1 X20");
    run_to(640);
    cnc_stop(&cnc);
    run_to(700);
    cnc_reset(&cnc);
    run_to(701);
    ck_assert(bit("CAPI"));
    run_to(703);
    ck_assert(!bit("PO_F"));
    ck_assert_uint_eq(cnc.machine.next, 0);
    cnc_reset(&cnc); /* with nothing under way: its passes are passed */
    run_to(704);
    ck_assert(bit("PO_F") && bit("CAPI"));
    run_to(706);
    ck_assert(!bit("PO_F"));
}
END_TEST

START_TEST(annulment_while_a_pass_waits)
{
    rig_power(NULL, "G1 X1 F1000");
    set_bit("EXT_PLC", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(10);
    cnc_reset(&cnc);
    run_to(11);
    ck_assert(bit("CAPI"));
    run_to(20);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_INIT); /* it runs on */
    set_bit("PLC_PASS_DONE", true);
    run_to(21);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_DONE);
    set_bit("PLC_PASS_DONE", true);
    run_to(22);
    ck_assert(!bit("PO_F"));
    ck_assert_int_eq(at(22).x, 0);
}
END_TEST

START_TEST(annulment_with_an_open_position_loop)
{
    rig_begin("G1 X1 F1000");
    set_bit("VAZBA_X", false);
    run_to(200);
    ck_assert(bit("PO_F") && !bit("PO_POL"));
    cnc_reset(&cnc);
    run_to(203);
    ck_assert(!bit("PO_F") && bit("SF_STOP"));
}
END_TEST

START_TEST(W40_starts_that_are_dropped)
{
    rig_begin("G1 X10 F1000");
    set_in(200, "STOP_REQ", true);
    run_to(204);
    ck_assert_int_eq(cnc_start(&cnc), CNC_UNDER_WAY);
    run_to(400);
    ck_assert_uint_eq(first_rest(200), 216);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_eq(at(400).x - at(199).x, 8563360);
    ck_assert_uint_eq(count_events(CNC_EVENT_START_REFUSED), 1);
    rig_begin("G1 X10 F1000");
    run_to(99);
    ck_assert_int_eq(cnc_start(&cnc), CNC_UNDER_WAY);
    set_in(200, "STOP_REQ", true);
    run_to(400);
    ck_assert_uint_eq(first_rest(200), 216);
    ck_assert(bit("PO_STOP"));
}
END_TEST

START_TEST(W39_starts_that_are_disabled_or_held_back)
{
    rig_power(NULL, "G1 X1 F1000");
    set_bit("START_DISABLE", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_DISABLED);
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_DISABLED);
    set_bit("START_DISABLE", false);
    set_bit("STOPPI", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_STOPPI);
    set_bit("STOPPI", false);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    set_bit("START_DISABLE", true); /* comes after it, but before the T */
    run_to(5);
    ck_assert(!bit("PO_F"));
    ck_assert_uint_eq(count_events(CNC_EVENT_START_REFUSED), 3);
    set_bit("START_DISABLE", false);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    cnc_stop(&cnc);
    run_to(10);
    ck_assert(!bit("PO_F"));
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_STOPPED);
}
END_TEST

START_TEST(an_axis_without_reference)
{
    static const char xml[] = "<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Y\" NeedRef=\"1\"/></ChannelConfig>";
    rig_power(xml, "G1 X1 F1000");
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK); /* Y is not in the program */
    run_to(200);
    rig_load_nc("G1 X2 F1000\nY1");
    ck_assert_int_eq(cnc_start(&cnc), CNC_NO_REFERENCE);
    set_cell("HOMING", 0, 2);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
}
END_TEST

START_TEST(W41_the_same_program_twice)
{
    rig_begin("G1 X1 F1000");
    start_in(300);
    run_to(310);
    ck_assert_uint_eq(first_end(1), 95);
    ck_assert(at(300).po_f && at(301).po_f && !at(302).po_f);
    ck_assert_int_eq(at(310).x, 1 * MM);
}
END_TEST

START_TEST(W44_permission_to_move)
{
    static const struct {
        const char *name;
        bool value, may;
    } row[] = {{"MPXPI", false, false}, {"MPXPI", true, true}, {"KHX1", true, false}, {"KHX1", false, true},
               {"VAZBA_X", false, true}};
    rig_power(NULL, NULL);
    ck_assert(bit("MPX"));
    for (unsigned i = 0; i < sizeof row / sizeof *row; i++) {
        set_bit(row[i].name, row[i].value);
        run_to(i + 1);
        ck_assert_int_eq(bit("MPX"), row[i].may);
    }
    cnc_set_critical(&cnc, 7);
    run_to(10);
    ck_assert(!bit("MPX"));
    ck_assert_int_eq(last_event(CNC_EVENT_CRITICAL), 7);
}
END_TEST

START_TEST(pulses_of_STOPPI)
{
    rig_power(NULL, NULL);
    set_in(10, "STOPPI", true);
    set_in(210, "STOPPI", false);
    run_to(220);
    ck_assert_uint_eq(count_events(CNC_EVENT_SHORT_STOPPI), 0);
    set_in(300, "STOPPI", true);
    set_in(499, "STOPPI", false);
    run_to(520);
    ck_assert_int_eq(last_event(CNC_EVENT_SHORT_STOPPI), 199);
    ck_assert(!bit("PO_STOP"));
}
END_TEST

START_TEST(STOPPI_counts_by_its_edge)
{
    rig_begin("G04 P1");
    set_in(10, "STOPPI", true);
    run_to(20);
    ck_assert(bit("PO_STOP") && bit("STOPPI"));
    set_bit("STOPPI", false);
    start_in(21);
    run_to(30);
    ck_assert(!bit("PO_STOP"));
    ck_assert_uint_eq(cnc.machine.phase, CNC_DELAY);
}
END_TEST

START_TEST(a_stop_in_the_first_pass_moves_nothing)
{
    rig_begin("G1 X1 F1000");
    run_to(1);
    cnc_stop(&cnc);
    run_to(100);
    ck_assert_uint_eq(first_stop(1), 2);
    ck_assert_int_eq(cell("STATUS_RESTART", 0), CNC_INIT);
    ck_assert_int_eq(at(100).x, 0);
    start_in(101);
    run_to(102);
    ck_assert_int_eq(at(102).x, 32768);
}
END_TEST

START_TEST(a_program_is_not_changed_under_way)
{
    rig_begin("G1 X1 F1000");
    run_to(10);
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_UNDER_WAY);
    ck_assert_int_eq(cnc_select(&cnc, 0, true), CNC_UNDER_WAY);
    run_to(200);
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_OK);
    ck_assert_int_eq(cnc_start(&cnc), CNC_NO_PROGRAM);
    ck_assert_int_eq(cnc_select(&cnc, 0, true), CNC_NO_SUCH_BLOCK);
}
END_TEST

static Suite *block_suite(void)
{
    Suite *suite = suite_create("cnc_block");
    TCase *blocks = tcase_create("blocks"), *sections = tcase_create("sections"), *starts = tcase_create("starts");
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
    tcase_add_test(sections, block_by_block_makes_no_section);
    tcase_add_test(sections, block_by_block_within_a_section_stops_at_its_end);
    tcase_add_test(sections, a_section_that_does_not_end);
    tcase_add_test(starts, W36_a_program_outside);
    tcase_add_test(starts, W37_central_annulment);
    tcase_add_test(starts, annulment_at_rest);
    tcase_add_test(starts, annulment_while_a_pass_waits);
    tcase_add_test(starts, annulment_with_an_open_position_loop);
    tcase_add_test(starts, W40_starts_that_are_dropped);
    tcase_add_test(starts, W39_starts_that_are_disabled_or_held_back);
    tcase_add_test(starts, an_axis_without_reference);
    tcase_add_test(starts, W41_the_same_program_twice);
    tcase_add_test(starts, W44_permission_to_move);
    tcase_add_test(starts, pulses_of_STOPPI);
    tcase_add_test(starts, STOPPI_counts_by_its_edge);
    tcase_add_test(starts, a_stop_in_the_first_pass_moves_nothing);
    tcase_add_test(starts, a_program_is_not_changed_under_way);
    suite_add_tcase(suite, blocks);
    suite_add_tcase(suite, sections);
    suite_add_tcase(suite, starts);
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
