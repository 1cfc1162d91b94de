/* SPDX-License-Identifier: MIT */
/* Manual moves, limit and slow-down switches (NA1 to NA5, NH4, NM11): the examples W17 to W19, W34, W43 of docs/CNC872.md. */
#include <stdlib.h>

#include "cnc_rig.h"

static int64_t step_of_x(uint64_t turn)
{
    return at(turn).x - at(turn - 1).x;
}

/* The way of X between two T's, rounded. */
static int64_t nm_between(uint64_t from, uint64_t to)
{
    return ((at(to).x - at(from).x) * 1000 + CNC_U_PER_UM / 2) / CNC_U_PER_UM;
}

/* The first T from `from` on in which X stands. */
static uint64_t x_rests(uint64_t from)
{
    while (step_of_x(from) != 0)
        from++;
    return from;
}

static void power_manual(const char *xml)
{
    rig_power(xml, NULL);
    set_bit("AUTMAN_REQ", true);
    set_bit("REQ_EXT_CONT_AUTMAN", true);
}

static void drive_w17(uint64_t turn)
{
    (void)turn;
    set_bit("ZPX0", cnc.axis[0].actual >= 5 * MM);
    set_bit("KHX0", cnc.axis[0].actual >= 6 * MM);
}

START_TEST(na2_an_endless_move_ends_before_positions_have_no_place)
{
    static const struct {
        const char *key;
        int way;
    } moves[] = {{"EXM_X0", 1}, {"EXM_X1", -1}};
    for (size_t i = 0; i < sizeof moves / sizeof moves[0]; i++) {
        power_manual(NULL);
        cnc.axis[0].position = moves[i].way * (INT64_MAX / 2 - 40 * MM);
        set_bit(moves[i].key, true);
        run_to(60000);
        const int64_t end = cnc.axis[0].position;
        ck_assert_int_gt(moves[i].way * end, INT64_MAX / 2 - 40 * MM);
        ck_assert_int_le(moves[i].way * end, INT64_MAX / 2 + MM);
        set_bit(moves[i].key, false);
        set_bit(moves[1 - i].key, true);
        run_to(61000); /* and it comes back */
        ck_assert_int_lt(moves[i].way * cnc.axis[0].position, moves[i].way * end);
    }
}
END_TEST

START_TEST(w17_limit_switches)
{
    rig_begin("G1 X10 F1000");
    rig_script = drive_w17;
    run_to(318);
    ck_assert(!bit("ZPX0"));
    run_to(319);
    ck_assert(bit("ZPX0"));
    run_to(490);
    ck_assert(!bit("KHX0"));
    run_to(550);
    ck_assert_uint_eq(first_speed(100, 327680), 342);
    ck_assert_int_eq(at(342).x, 344992222); /* 5264.164 um */
    ck_assert_uint_eq(first_rest(480), 493);
    ck_assert_int_eq(at(493).x, 393751006);
    ck_assert(bit("SF_LS") && bit("INPOS") && bit("PO_F") && !bit("PO_STOP") && !bit("PO_POL"));
    run_to(599);
    set_bit("STOP_REQ", true);
    run_to(600);
    ck_assert(bit("PO_STOP") && !bit("STOP_REQ"));
    run_to(699);
    ck_assert(!bit("SF_STOPPOSCHANGED") && bit("INPOS_STOP"));
    set_bit("AUTMAN_REQ", true);
    set_bit("REQ_EXT_CONT_AUTMAN", true);
    set_bit("EXM_X0", true);
    run_to(799);
    ck_assert_int_eq(at(799).x, at(699).x); /* towards the switch: nothing */
    ck_assert(bit("ACK_AUTMAN") && bit("SF_MANUALMODE"));
    set_bit("EXM_X0", false);
    set_bit("EXM_X1", true);
    run_to(819);
    ck_assert_int_eq(at(819).x - at(799).x, -5079040); /* away from it */
    ck_assert(bit("SF_STOPPOSCHANGED") && !bit("INPOS_STOP") && bit("SM_POXPI") && bit("PO_OSXPI"));
}
END_TEST

static void drive_w18(uint64_t turn)
{
    set_bit("EXM_X0", turn >= 10 && turn <= 509);
}

START_TEST(w18_manual_move_by_the_plc)
{
    power_manual(NULL);
    set_bit("REQ_EXT_FEED_AUTMAN", true);
    set_cell("EXT_FEED_AUTMAN", 0, 600);
    rig_script = drive_w18;
    run_to(9);
    ck_assert(bit("ACK_AUTMAN") && !bit("PO_OSXPI") && !bit("AUTMAN_CONT_NC"));
    run_to(100);
    ck_assert(bit("PO_OSXPI") && !bit("INPOS") && bit("SF_RUN"));
    run_to(600);
    ck_assert_int_eq(step_of_x(10), 32768);
    ck_assert_int_lt(step_of_x(28), 655360);
    ck_assert_int_eq(step_of_x(29), 655360);
    ck_assert_int_eq(step_of_x(510), 622592);
    ck_assert_uint_eq(x_rests(511), 529);
    ck_assert_int_eq(at(600).x, 5 * MM);
    ck_assert(!bit("PO_OSXPI") && bit("INPOS") && !bit("PO_F"));
}
END_TEST

START_TEST(w19_ends_of_a_manual_move)
{
    static const struct {
        const char *bit;
        bool value;
        uint64_t rest;
        int64_t way; /* nm */
    } ends[] = {{"EXM_X0", false, 167, 1094500}, {"MPXPI", false, 117, 261333}, {"STOP_REQ", true, 167, 1094500},
                {"EN_AUTMAN", false, 167, 1094500}, {"AUTMAN_REQ", false, 167, 1094500}, {"KHX0", true, 117, 261333},
                {"STOP_EMERGENCY_REQ", true, 117, 261333}, {"REQ_EXT_SELECT_AUTMAN", true, 167, 1094500}};
    for (unsigned i = 0; i < sizeof ends / sizeof *ends; i++) {
        power_manual(NULL);
        set_bit("EXM_X0", true);
        run_to(100);
        set_bit(ends[i].bit, ends[i].value);
        run_to(101);
        ck_assert(bit("ACK_AUTMAN"));
        run_to(300);
        ck_assert_msg(x_rests(103) == ends[i].rest, "%s: %u", ends[i].bit, (unsigned)x_rests(103));
        ck_assert_int_eq(nm_between(100, 300), ends[i].way);
        ck_assert(!bit("PO_STOP") && !bit("PO_OSXPI"));
        ck_assert(bit("ACK_AUTMAN") == (i != 3 && i != 4));
    }
}
END_TEST

START_TEST(w43_other_bits_enable_manual_moves)
{
    static const char xml[] = "<ChannelConfig ManualEnable=\"MAN\"/>";
    for (unsigned i = 0; i < 2; i++) {
        power_manual(xml);
        set_bit("EXM_X0", true);
        run_to(100);
        set_bit(i == 0 ? "MPXMAN" : "MPXPI", false);
        run_to(300);
        ck_assert_int_eq(step_of_x(300), i == 0 ? 0 : 2184533);
        ck_assert_int_eq(bit("MPX"), i == 1);
        if (i == 0) {
            ck_assert_uint_eq(x_rests(103), 117);
            ck_assert_int_eq(nm_between(100, 300), 261333);
        }
    }
}
END_TEST

START_TEST(na4_after_a_stop_the_request_has_to_be_0)
{
    power_manual(NULL);
    set_bit("EXM_X0", true);
    run_to(50);
    set_bit("STOP_REQ", true);
    run_to(300);
    ck_assert_int_eq(step_of_x(300), 0);
    set_bit("EXM_X0", false);
    run_to(301);
    set_bit("EXM_X0", true);
    run_to(302);
    ck_assert_int_eq(step_of_x(302), 32768);
}
END_TEST

START_TEST(na2_keys_of_the_panel)
{
    rig_power(NULL, NULL);
    cnc.panel.manual = true;
    cnc.panel.jog_minus = 2;
    run_to(100);
    ck_assert_int_lt(at(100).y, 0);
    ck_assert(bit("AUTMAN_CONT_NC") && !bit("AUTMAN_CONT_TOC") && !bit("AUTMAN_CONT_SELECT") && !bit("AUTMAN_CONT_G00"));
    ck_assert(bit("PO_OSYPI") && !bit("PO_OSXPI") && bit("SM_POYPI"));
    cnc.panel.hand = cnc.panel.rapid = true;
    run_to(500);
    ck_assert(bit("AUTMAN_CONT_TOC") && !bit("AUTMAN_CONT_NC") && bit("AUTMAN_CONT_G00"));
    ck_assert_int_eq(at(499).y - at(500).y, 13107200); /* FeedRT */
    cnc.panel.jog_plus = 2; /* both: stop */
    run_to(1200);
    ck_assert_int_eq(at(1199).y - at(1200).y, 0);
    set_bit("REQ_EXT_SELECT_AUTMAN", true);
    cnc.panel.jog_minus = 0;
    run_to(1300);
    ck_assert(bit("AUTMAN_CONT_SELECT"));
    ck_assert_int_eq(at(1200).y, at(1300).y); /* axes are chosen, nothing moves */
    set_bit("REQ_EXT_SELECT_AUTMAN", false);
    cnc.panel.manual = false;
    run_to(1301);
    ck_assert(!bit("ACK_AUTMAN") && !bit("AUTMAN_CONT_TOC") && !bit("AUTMAN_CONT_G00"));
}
END_TEST

/* Speed of X after 500 T of a manual move. */
static int64_t manual_speed(void)
{
    set_bit("EXM_X0", true);
    run_to(cnc.turn + 1000);
    const int64_t speed = step_of_x(cnc.turn);
    set_bit("EXM_X0", false);
    run_to(cnc.turn + 1000);
    return speed;
}

START_TEST(na3_speed)
{
    power_manual(NULL);
    ck_assert_int_eq(manual_speed(), 2184533); /* Feed */
    cnc.panel.feed = 50;
    ck_assert_int_eq(manual_speed(), 1092266);
    set_cell("FEED_OVR_MULTIPLIER", 0, 500);
    ck_assert_int_eq(manual_speed(), 546133);
    cnc.panel.feed = 100;
    set_cell("FEED_OVR_MULTIPLIER", 0, 1000);
    set_bit("LIMIT_FEED_REQ", true);
    set_cell("LIMIT_FEED", 0, 17 * 65536);
    ck_assert_int_eq(manual_speed(), 1114112);
    set_bit("LIMIT_FEED_G00_REQ", true); /* of rapid moves only */
    ck_assert_int_eq(manual_speed(), 1114112);
    set_bit("LIMIT_FEED_REQ", false);
    set_bit("LIMIT_FEED_G00_REQ", false);
    set_bit("REQ_EXT_FEED_AUTMAN", true);
    set_cell("EXT_FEED_AUTMAN", 0, 600);
    ck_assert_int_eq(manual_speed(), 655360);
    set_cell("EXT_FEED_AUTMAN", 0, 60000); /* never above FeedRT */
    ck_assert_int_eq(manual_speed(), 13107200);
    set_cell("EXT_FEED_AUTMAN", 0, 0);
    ck_assert_int_eq(manual_speed(), 0);
    set_bit("REQ_EXT_G00_AUTMAN", true); /* without a value: FeedRT */
    ck_assert_int_eq(manual_speed(), 13107200);
    set_cell("EXT_FEED_G00_AUTMAN", 0, 3000);
    ck_assert_int_eq(manual_speed(), 3276800);
    set_bit("LIMIT_FEED_G00_REQ", true);
    set_cell("LIMIT_FEED_G00", 0, 2000000);
    ck_assert_int_eq(manual_speed(), 2000000);
    set_bit("ZPX1", true); /* the direction is not looked at */
    ck_assert_int_eq(manual_speed(), 327680);
}
END_TEST

START_TEST(na1_not_while_a_block_is_under_way)
{
    rig_begin("G1 X1 F1000");
    set_bit("AUTMAN_REQ", true);
    set_bit("REQ_EXT_CONT_AUTMAN", true);
    set_bit("EXM_Y0", true);
    run_to(2);
    ck_assert(!bit("ACK_AUTMAN")); /* START came first */
    run_to(50);
    ck_assert(!bit("ACK_AUTMAN"));
    ck_assert_int_eq(at(50).y, 0);
    run_to(200);
    ck_assert(bit("ACK_AUTMAN"));
    ck_assert_int_gt(at(200).y, 0);
    ck_assert_int_eq(cnc_start(&cnc), CNC_MANUAL);
}
END_TEST

START_TEST(na5_a_restart_goes_straight_to_the_target)
{
    rig_begin("G1 X10 F1000");
    run_to(99);
    set_bit("STOP_REQ", true);
    run_to(200);
    const int64_t stopped = at(200).x;
    cnc.panel.manual = true;
    cnc.panel.jog_plus = 2;
    cnc.panel.jog_minus = 1;
    run_to(300);
    cnc.panel.jog_plus = cnc.panel.jog_minus = 0;
    run_to(500);
    ck_assert(bit("SF_STOPPOSCHANGED") && bit("ACK_AUTMAN"));
    ck_assert_int_lt(at(500).x, stopped);
    ck_assert_int_gt(at(500).y, 0);
    cnc.panel.manual = false;
    run_to(501);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(510);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Cont, 0), 1);
    run_to(2000);
    ck_assert_int_eq(at(2000).x, 10 * MM);
    ck_assert_int_eq(at(2000).y, at(500).y); /* Y is not in the block */
    ck_assert(!bit("PO_F") && !bit("SF_STOPPOSCHANGED"));
}
END_TEST

START_TEST(w34_software_limit)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" SlsPlus=\"5\"/></ChannelConfig>", "G1 X10 F1000");
    set_cell("HOMING", 0, 1);
    set_cell("SLS_REFER", 0, 1);
    run_to(690);
    ck_assert_int_eq(at(690).x, 332605928); /* 5075.164 um */
    ck_assert(bit("SF_SLS") && bit("PO_F") && !bit("SF_LS") && !bit("MPX"));
}
END_TEST

START_TEST(w34_a_manual_move_leaves_a_software_limit)
{
    power_manual("<ChannelConfig><Axis Name=\"X\" SlsMinus=\"-1\"/></ChannelConfig>");
    set_cell("HOMING", 0, 1);
    set_cell("SLS_REFER", 0, 1);
    set_bit("EXM_X1", true);
    run_to(500);
    const int64_t stopped = at(500).x;
    ck_assert_int_lt(stopped, -MM);
    ck_assert_int_eq(step_of_x(500), 0);
    set_bit("EXM_X1", false);
    set_bit("EXM_X0", true);
    run_to(600);
    ck_assert_int_gt(at(600).x, -MM);
    set_cell("SLS_REFER", 0, 0); /* without it there is no limit */
    set_bit("EXM_X0", false);
    set_bit("EXM_X1", true);
    run_to(1200);
    ck_assert_int_lt(at(1200).x, 2 * stopped);
}
END_TEST

START_TEST(ns5_a_critical_error_stops_at_once)
{
    power_manual(NULL);
    set_bit("EXM_X0", true);
    run_to(100);
    cnc_set_critical(&cnc, 3);
    run_to(110);
    ck_assert_int_eq(at(110).x, at(100).x);
    ck_assert(!bit("PO_OSXPI") && bit("INPOS"));
    cnc_set_critical(&cnc, 0);
    run_to(111);
    ck_assert_int_eq(step_of_x(111), 32768);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_manual");
    TCase *all = tcase_create("manual");
    tcase_add_test(all, w17_limit_switches);
    tcase_add_test(all, w18_manual_move_by_the_plc);
    tcase_add_test(all, w19_ends_of_a_manual_move);
    tcase_add_test(all, w43_other_bits_enable_manual_moves);
    tcase_add_test(all, na4_after_a_stop_the_request_has_to_be_0);
    tcase_add_test(all, na2_keys_of_the_panel);
    tcase_add_test(all, na3_speed);
    tcase_add_test(all, na1_not_while_a_block_is_under_way);
    tcase_add_test(all, na5_a_restart_goes_straight_to_the_target);
    tcase_add_test(all, na2_an_endless_move_ends_before_positions_have_no_place);
    tcase_add_test(all, w34_software_limit);
    tcase_add_test(all, w34_a_manual_move_leaves_a_software_limit);
    tcase_add_test(all, ns5_a_critical_error_stops_at_once);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
