/* SPDX-License-Identifier: MIT */
/* Motions of a CNC872: the worked examples of docs/CNC872.md (W...), whose numbers a reference in whole numbers computes. */
#include "cnc_rig.h"

#define PARABOLIC "<ChannelConfig AccelerationType=\"1\"/>"
#define FULL 1092266 /* u/T: 1000 mm/min */

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

START_TEST(W1_conversions)
{
    ck_assert_int_eq(cnc_speed_of(1000000), FULL);
    ck_assert_int_eq(cnc_speed_of(300000), 327680);
    ck_assert_int_eq(cnc_speed_of(12000000), 13107200);
    ck_assert_int_eq(cnc_acceleration_of(500000), 32768);
    ck_assert_int_eq(cnc_acceleration_of(1000000), 65536);
    ck_assert_int_eq(cnc_acceleration_of(2000000), 131072);
    rig_power(NULL, NULL);
    ck_assert_int_eq(config.axis[0].smoothing[CNC_SET_NORMAL], 50);
}
END_TEST

START_TEST(W2_a_feed_block)
{
    rig_begin("G1 X10 F1000");
    run_to(1);
    ck_assert(bit("PO_F") && bit("PO_OSXPI") && bit("PO_OSX") && bit("AUTPI"));
    run_to(633);
    ck_assert(bit("PO_OSXPI") && !bit("PO_POL"));
    run_to(634);
    ck_assert(!bit("PO_OSXPI") && !bit("PO_OSX") && bit("PO_POL") && bit("PO_F"));
    run_to(640);
    ck_assert_int_eq(at(2).x, 32768);
    ck_assert_int_eq(at(3).x, 98304);
    ck_assert_int_eq(at(35).x, 19475114);
    ck_assert_int_eq(at(35).v, FULL);
    ck_assert_int_eq(at(100).x, 90472404);
    ck_assert_int_eq(at(634).x, 10 * MM);
    ck_assert_uint_eq(first_reached(1), 634);
    ck_assert_uint_eq(first_end(1), 635);
    ck_assert(bit("SF_STOP") && !bit("PO_STOP"));
    ck_assert_int_eq(cell("POSITION_POS5_EX", 0), 10 * MM);
}
END_TEST

START_TEST(W3_rapid)
{
    rig_begin("G0 X10");
    run_to(300);
    ck_assert_int_eq(at(2).x, 65536);
    ck_assert_int_eq(top_speed(), 6553600);
    ck_assert_uint_eq(first_reached(1), 200);
    ck_assert_uint_eq(first_end(1), 201);
}
END_TEST

START_TEST(W4_too_short_for_the_feed)
{
    rig_begin("G1 X0.1 F1000");
    run_to(60);
    ck_assert_int_eq(top_speed(), 458752);
    ck_assert_uint_eq(first_reached(1), 29);
    ck_assert_uint_eq(first_end(1), 30);
}
END_TEST

START_TEST(W5_two_axes)
{
    rig_begin("G1 X3 Y4 F1000");
    run_to(400);
    ck_assert_int_eq(at(2).x, 24576);
    ck_assert_int_eq(at(2).y, 32768);
    ck_assert_int_eq(at(100).x, 56467426);
    ck_assert_int_eq(at(100).y, 75289902);
    ck_assert_uint_eq(first_reached(1), 327);
}
END_TEST

/* The pot of the feed in T's 200 to 299 of W2. */
static void run_with_pot(uint16_t percent, uint64_t turns)
{
    rig_begin("G1 X10 F1000");
    run_to(199);
    cnc.panel.feed = percent;
    run_to(299);
    cnc.panel.feed = 100;
    run_to(turns);
}

START_TEST(W6_half_the_feed)
{
    run_with_pot(50, 760);
    ck_assert_int_eq(at(199).v, FULL);
    ck_assert_int_eq(at(200).v, 1059498);
    ck_assert_int_eq(at(216).v, 546133);
    ck_assert_uint_eq(first_reached(1), 684);
}
END_TEST

START_TEST(W7_no_feed)
{
    run_with_pot(0, 760);
    ck_assert_uint_eq(first_rest(200), 233);
    ck_assert_int_eq(at(233).x, 216268668);
    ck_assert_uint_eq(first_stop(1), 0);
    ck_assert_uint_eq(first_reached(1), 734);
}
END_TEST

START_TEST(W8_stop_and_restart)
{
    const char *const stop = _i == 0 ? "STOP_REQ" : "STOPPI";
    rig_begin("G1 X10 F1000");
    set_in(200, stop, true);
    run_to(216);
    ck_assert(bit("PO_STOP") && bit("SF_STOP") && bit("PO_F") && !bit("PO_POL") && bit("INPOS"));
    ck_assert_int_eq(cell("STATUS_RESTART", 0), 2);
    run_to(399);
    set_bit("STOPPI", false);
    start_in(400);
    run_to(400);
    ck_assert(bit("BLOCK_RESTART") && !bit("PO_STOP") && !bit("SF_STOP"));
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Partial, 0), 1);
    ck_assert_int_eq(cell("STATUS_RESTART", 0), 2);
    run_to(843);
    ck_assert(bit("BLOCK_RESTART"));
    run_to(900);
    ck_assert_int_eq(cell("STATUS_RESTART", 0), 0);
    ck_assert(!bit("BLOCK_RESTART"));
    ck_assert_uint_eq(first_stop(1), 216);
    ck_assert_uint_eq(first_rest(200), 216);
    ck_assert_int_eq(at(216).x - at(199).x, 8563360);
    ck_assert_int_eq(at(400).v, 0);
    ck_assert_int_gt(at(401).v, 0);
    ck_assert_uint_eq(first_reached(1), 843);
    ck_assert_uint_eq(first_end(1), 844);
    ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK), 1);
}
END_TEST

START_TEST(W9_emergency)
{
    rig_begin("G1 X10 F1000");
    set_in(200, "STOP_EMERGENCY_REQ", true);
    start_in(400);
    run_to(900);
    ck_assert_uint_eq(first_rest(200), 208);
    ck_assert_int_eq(at(208).x - at(199).x, 4019536);
    ck_assert_uint_eq(first_reached(1), 847);
}
END_TEST

START_TEST(W10_motion_not_enabled)
{
    rig_begin("G1 X10 F1000");
    set_in(200, "MPXPI", false);
    run_to(399);
    ck_assert(!bit("PO_STOP") && !bit("MPX") && bit("PO_OSXPI"));
    set_bit("MPXPI", true);
    run_to(900);
    ck_assert_uint_eq(first_rest(200), 208);
    ck_assert_int_eq(at(208).x - at(199).x, 4019536);
    ck_assert_uint_eq(first_stop(1), 0);
    ck_assert_int_gt(at(400).v, 0);
    ck_assert_uint_eq(first_reached(1), 846);
}
END_TEST

START_TEST(W11_emergency_within_a_stop)
{
    rig_begin("G1 X10 F1000");
    set_in(200, "STOP_REQ", true);
    set_in(205, "STOP_EMERGENCY_REQ", true);
    run_to(400);
    ck_assert_uint_eq(first_rest(200), 210);
    ck_assert_int_eq(at(210).x - at(199).x, 6335140);
}
END_TEST

START_TEST(W12_stop_on_the_final_ramp)
{
    rig_begin("G1 X10 F1000");
    set_in(625, "STOP_REQ", true);
    run_to(700);
    ck_assert_int_eq(at(624).v, 338614);
    ck_assert_int_eq(10 * MM - at(624).x, 1583904);
    ck_assert_int_eq(at(700).x, 654486126);
    ck_assert(bit("PO_STOP") && !bit("PO_POL"));
}
END_TEST

START_TEST(W13_parabolic)
{
    rig_begin_with(PARABOLIC, "G1 X10 F1000");
    run_to(1);
    ck_assert_int_eq(cell("dwAxGLinearAccel", 0), 32768);
    ck_assert_double_eq(cnc_real(&cnc.cells, CNC_CELL_rAxGParabAccel, 0), 655.36);
    run_to(700);
    ck_assert_int_eq(at(2).v, 655);
    ck_assert_int_eq(at(3).v, 1966);
    ck_assert_int_eq(at(4).v, 3932);
    ck_assert_int_eq(at(35).v, 389502);
    ck_assert_uint_eq(first_speed(1, FULL), 84);
    ck_assert_int_eq(at(84).x, 46235631);
    ck_assert_uint_eq(first_reached(1), 683);
    ck_assert_int_eq(at(700).x, 10 * MM);
}
END_TEST

static const struct {
    const char *name;
    bool value;
    uint64_t rest;
    int64_t way;
    uint64_t there;
} w14[] = {
    {"STOP_REQ", true, 265, 35323877, 892},
    {"STOP_EMERGENCY_REQ", true, 257, 30780053, 896},
    {"MPXPI", false, 200, 0, 924},
};

START_TEST(W14_parabolic_stops)
{
    rig_begin_with(PARABOLIC, "G1 X10 F1000");
    set_in(200, w14[_i].name, w14[_i].value);
    run_to(399);
    if (w14[_i].value)
        start_in(400);
    else
        set_bit(w14[_i].name, true);
    run_to(1000);
    ck_assert_uint_eq(first_rest(200), w14[_i].rest);
    ck_assert_int_eq(at(300).x - at(199).x, w14[_i].way);
    ck_assert_uint_eq(first_reached(1), w14[_i].there);
}
END_TEST

START_TEST(W15_too_late_for_a_parabolic_stop)
{
    rig_begin_with(PARABOLIC, "G1 X10 F1000");
    set_in(650, "STOP_REQ", true);
    run_to(790);
    ck_assert_int_eq(at(649).v, 396937);
    ck_assert_uint_eq(first_reached(1), 683);
    ck_assert_uint_eq(first_stop(1), 683);
    ck_assert_int_eq(at(683).x, 10 * MM);
    ck_assert_int_eq(cell("STATUS_RESTART", 0), CNC_DONE);
    ck_assert_uint_eq(at(790).phase, CNC_DONE);
    ck_assert(bit("PO_F"));
    start_in(800);
    run_to(810);
    ck_assert_uint_eq(first_end(1), 800);
}
END_TEST

static void limit_at_3_mm(uint64_t turn)
{
    set_bit("KHX0", cnc.axis[0].actual >= 3 * MM && turn <= 499);
}

START_TEST(W16_limit_switch)
{
    rig_begin_with(_i == 0 ? NULL : PARABOLIC, "G1 X10 F1000");
    rig_script = limit_at_3_mm;
    run_to(1000);
    ck_assert_uint_eq(first_rest(190), _i == 0 ? 207 : 288);
    ck_assert_int_eq(at(_i == 0 ? 207 : 288).x, _i == 0 ? 201534008 : 232292216);
    ck_assert_uint_eq(first_reached(1), _i == 0 ? 947 : 968);
    ck_assert_uint_eq(first_stop(1), 0);
}
END_TEST

START_TEST(W24_overrides)
{
    static const char slow[] = "<ChannelConfig><Axis Name=\"X\" FeedRT=\"1200\"/></ChannelConfig>";
    rig_begin_with(slow, "G1 X10 F1000");
    set_bit("FEED_OVR", true);
    cnc_write_number(&cnc.cells, cnc_cell_place(CNC_CELL_BZH09), CNC_WORD, 1500);
    run_to(300);
    ck_assert_int_eq(top_speed(), 1310720);
    rig_begin("G1 X10 F1000");
    cnc.panel.feed = 80;
    set_cell("FEED_OVR_MULTIPLIER", 0, 500);
    run_to(300);
    ck_assert_int_eq(top_speed(), 436906);
    rig_begin("G1 X10 F2000");
    set_cell("LIMIT_FEED", 0, 17 * 65536);
    set_bit("LIMIT_FEED_REQ", true);
    run_to(300);
    ck_assert_int_eq(top_speed(), 1114112);
    set_cell("LIMIT_FEED", 0, -5);
    run_to(400);
    ck_assert_int_eq(at(400).v, 0);
    ck_assert(!bit("PO_STOP"));
}
END_TEST

START_TEST(rapid_with_overrides)
{
    rig_begin("G0 X100");
    run_to(300);
    ck_assert_int_eq(at(300).v, 13107200);
    cnc.panel.feed = 200;
    run_to(350);
    ck_assert_int_eq(top_speed(), 13107200);
    cnc.panel.feed = 50;
    run_to(500);
    ck_assert_int_eq(at(500).v, 6553600);
    set_cell("LIMIT_FEED_G00", 0, 65536);
    set_bit("LIMIT_FEED_G00_REQ", true);
    run_to(700);
    ck_assert_int_eq(at(700).v, 65536);
    cnc.panel.feed = 100;
    set_bit("LIMIT_FEED_G00_REQ", false);
    set_bit("ZPX1", true); /* the direction is not looked at */
    run_to(720);
    ck_assert_int_eq(at(720).v, 327680);
}
END_TEST

START_TEST(W25_the_slowest_axis)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" FeedRT=\"1200\"/><Axis Name=\"Y\"/></ChannelConfig>", "G1 X30 Y40 F9000");
    run_to(301);
    ck_assert_int_eq(at(301).v, 2184533);
    ck_assert_int_eq(at(301).x - at(300).x, 1310720);
    ck_assert_int_eq(at(301).y - at(300).y, 1747626);
}
END_TEST

START_TEST(W26_open_position_loop)
{
    rig_begin("G1 X10 F1000");
    set_in(100, "VAZBA_X", false);
    run_to(199);
    ck_assert_int_eq(cell("DIFCIT_X", 0), 1666);
    ck_assert(!bit("INPOS"));
    set_bit("VAZBA_X", true);
    run_to(200);
    ck_assert_int_eq(cell("DIFCIT_X", 0), 0);
}
END_TEST

START_TEST(W26_lag)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" Lag=\"20\"/></ChannelConfig>", "G1 X10 F1000");
    run_to(300);
    ck_assert_int_eq(cell("DIFCIT_X", 0), 316);
    run_to(800);
    ck_assert_int_eq(at(633).x < 10 * MM, 1);
    ck_assert_int_eq(at(634).x, 10 * MM);
    ck_assert_uint_eq(first_reached(1), 701);
}
END_TEST

START_TEST(W45_critical_error)
{
    rig_begin("G1 X10 F1000");
    run_to(199);
    cnc_set_critical(&cnc, 7);
    run_to(300);
    ck_assert_int_eq(at(200).v, 0);
    ck_assert_int_eq(at(200).x, 198606738);
    ck_assert(bit("PO_F") && !bit("MPX"));
    ck_assert_int_eq(cnc_start(&cnc), CNC_UNDER_WAY);
    cnc_stop(&cnc);
    run_to(302);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_eq(cnc_start(&cnc), CNC_CRITICAL);
    ck_assert_uint_eq(count_events(CNC_EVENT_START_REFUSED), 2);
    cnc_reset(&cnc);
    run_to(310);
    ck_assert_int_eq(cell("BZH13", 0), 0);
    ck_assert(!bit("PO_F"));
}
END_TEST

START_TEST(W45_following_error)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" MaxLag=\"100\"/></ChannelConfig>", "G1 X10 F1000");
    set_in(100, "VAZBA_X", false);
    run_to(105);
    ck_assert_int_eq(cell("DIFCIT_X", 0), 99);
    ck_assert_int_eq(cell("BZH13", 0), 0);
    run_to(106);
    ck_assert_int_eq(cell("DIFCIT_X", 0), 116);
    ck_assert_int_eq(cell("BZH13", 0), 1);
    run_to(107);
    ck_assert_int_eq(at(106).v, FULL);
    ck_assert_int_eq(at(107).v, 0);
    cnc_reset(&cnc); /* the cause is still there */
    run_to(120);
    ck_assert_int_eq(cell("BZH13", 0), 1);
}
END_TEST

START_TEST(the_smallest_MaxLag)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" MaxLag=\"1\"/></ChannelConfig>", "G1 X-10 F1000");
    set_in(2, "VAZBA_X", false);
    run_to(2);
    ck_assert_int_eq(cell("DIFCIT_X", 0), -1); /* -0.5 um, rounded down */
    ck_assert_int_eq(cell("BZH13", 0), 0);
    run_to(3);
    ck_assert_int_eq(cell("DIFCIT_X", 0), -2);
    ck_assert_int_eq(cell("BZH13", 0), 1);
}
END_TEST

START_TEST(W49_cells_of_the_configuration)
{
    rig_power(NULL, NULL);
    ck_assert_int_eq(cell("dwAxNCAcceleration", 0), 32768);
    ck_assert_int_eq(cell("dwAxNCAccelerationRT", 0), 65536);
    ck_assert_int_eq(cell("dwAxNCAccelerationEmergency", 0), 131072);
    ck_assert_int_eq(cell("dwAxNcFeed", 0), 2184533);
    ck_assert_int_eq(cell("dwAxNcFeedRT", 0), 13107200);
    ck_assert_double_eq(cnc_real(&cnc.cells, CNC_CELL_rAxNCParabAccel, 0), 655.36);
    ck_assert_double_eq(cnc_real(&cnc.cells, CNC_CELL_rAxNCParabAccelRT, 0), 1310.72);
    ck_assert_double_eq(cnc_real(&cnc.cells, CNC_CELL_rAxNCParabAccelEmergency, 0), 2621.44);
    ck_assert_int_eq(cell("dwAxNCAcceleration", 3), 0); /* axis 4 is not configured */
}
END_TEST

START_TEST(W50_acceleration_by_request)
{
    rig_begin_with(PARABOLIC, "G1 X10 F1000");
    set_bit("REQ_LINEARACCEL", true);
    set_cell("dwAxGLinearAccel", 0, 16384);
    run_to(700);
    ck_assert_int_eq(at(2).v, 655);
    ck_assert_uint_eq(first_speed(1, FULL), 92);
    ck_assert_uint_eq(first_reached(1), 691);
    ck_assert_int_eq(cell("dwAxGLinearAccel", 0), 16384);
}
END_TEST

START_TEST(requests_that_do_not_count)
{
    rig_begin("G1 X10 F1000"); /* linear ramps */
    set_bit("REQ_LINEARACCEL", true);
    set_cell("dwAxGLinearAccel", 0, 16384);
    run_to(640);
    ck_assert_uint_eq(first_reached(1), 634);
    rig_begin_with(PARABOLIC, "G1 X10 F1000");
    set_bit("REQ_LINEARACCEL", true);
    set_bit("REQ_PARABACCEL", true);
    set_cell("dwAxGLinearAccel", 0, -1);
    cnc_put_real(&cnc.cells, CNC_CELL_rAxGParabAccel, 0, -1);
    run_to(700);
    ck_assert_uint_eq(first_reached(1), 683);
    rig_begin_with(PARABOLIC, "G0 X10");
    run_to(400);
    const uint64_t there = first_reached(1);
    rig_begin_with(PARABOLIC, "G0 X10"); /* they are of the set for feed */
    set_bit("REQ_LINEARACCEL", true);
    set_cell("dwAxGLinearAccel", 0, 16384);
    run_to(400);
    ck_assert_uint_ne(there, 0);
    ck_assert_uint_eq(first_reached(1), there);
}
END_TEST

START_TEST(B_POL_and_B_INK_make_the_position)
{
    rig_begin("G1 X1.0001 F1000\nG1 X-2");
    while (cnc.turn < 200) {
        run_to(cnc.turn + 1);
        const int64_t sum = cell("B_POL", 0) + cell("B_INK", 0);
        ck_assert_int_le(sum * 8192, at(cnc.turn).x);
        ck_assert_int_gt((sum + 1) * 8192, at(cnc.turn).x);
        ck_assert_int_eq(cell("B_POL_EX", 0) + cell("B_INK_EX", 0), at(cnc.turn).x);
    }
    ck_assert_uint_eq(at(200).block, 1);
    ck_assert_int_eq(cell("B_POL_EX", 0), 65542553);
    ck_assert(bit("SM_POXPI"));
}
END_TEST

START_TEST(spaces)
{
    rig_power("<ChannelConfig><Axis Name=\"X\" LengthCorrection=\"1\" Offset1=\"2\" Offset2=\"-0.5\"/></ChannelConfig>", NULL);
    ck_assert_int_eq(cell("POSITION_POS1_EX", 0), 0);
    ck_assert_int_eq(cell("POSITION_POS2_EX", 0), 0);
    ck_assert_int_eq(cell("POSITION_POS3_EX", 0), 1 * MM);
    ck_assert_int_eq(cell("POSITION_POS4_EX", 0), 3 * MM);
    ck_assert_int_eq(cell("POSITION_POS5_EX", 0), 5 * MM / 2);
    ck_assert_int_eq(cnc_position(&cnc, 0, 6), 5 * MM / 2);
}
END_TEST

static Suite *motion_suite(void)
{
    Suite *suite = suite_create("cnc_motion");
    TCase *way = tcase_create("way"), *stops = tcase_create("stops"), *cells = tcase_create("cells");
    tcase_add_test(way, W1_conversions);
    tcase_add_test(way, W2_a_feed_block);
    tcase_add_test(way, W3_rapid);
    tcase_add_test(way, W4_too_short_for_the_feed);
    tcase_add_test(way, W5_two_axes);
    tcase_add_test(way, W6_half_the_feed);
    tcase_add_test(way, W7_no_feed);
    tcase_add_test(way, W13_parabolic);
    tcase_add_test(way, W24_overrides);
    tcase_add_test(way, rapid_with_overrides);
    tcase_add_test(way, W25_the_slowest_axis);
    tcase_add_test(way, W50_acceleration_by_request);
    tcase_add_test(way, requests_that_do_not_count);
    tcase_add_loop_test(stops, W8_stop_and_restart, 0, 2);
    tcase_add_test(stops, W9_emergency);
    tcase_add_test(stops, W10_motion_not_enabled);
    tcase_add_test(stops, W11_emergency_within_a_stop);
    tcase_add_test(stops, W12_stop_on_the_final_ramp);
    tcase_add_loop_test(stops, W14_parabolic_stops, 0, 3);
    tcase_add_test(stops, W15_too_late_for_a_parabolic_stop);
    tcase_add_loop_test(stops, W16_limit_switch, 0, 2);
    tcase_add_test(stops, W45_critical_error);
    tcase_add_test(stops, W45_following_error);
    tcase_add_test(stops, the_smallest_MaxLag);
    tcase_add_test(cells, W26_open_position_loop);
    tcase_add_test(cells, W26_lag);
    tcase_add_test(cells, W49_cells_of_the_configuration);
    tcase_add_test(cells, B_POL_and_B_INK_make_the_position);
    tcase_add_test(cells, spaces);
    suite_add_tcase(suite, way);
    suite_add_tcase(suite, stops);
    suite_add_tcase(suite, cells);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(motion_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
