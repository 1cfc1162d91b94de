/* SPDX-License-Identifier: MIT */
/* What single clauses of docs/CNC872.md demand beside the worked examples: borders of ranges, other axes than X, second times. */
#include <stdio.h>
#include <string.h>

#include "cnc872/frame.h"
#include "cnc_rig.h"

static void start_in(uint64_t turn)
{
    run_to(turn - 1);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
}

static void stand_at(unsigned axis, int64_t position)
{
    cnc.axis[axis].position = cnc.axis[axis].actual = position;
}

/* ---- Enabling, limits, positions ---------------------------------------------------------------------------------------- */

START_TEST(NE1_axes_not_in_the_block_do_not_matter)
{
    rig_begin("G1 X1 F1000");
    set_bit("MPYPI", false);
    set_bit("KHZ1", true);
    run_to(200);
    ck_assert_uint_eq(first_end(1), 95);
    rig_begin("G1 Y1 F1000");
    set_bit("KHX0", true);
    run_to(200);
    ck_assert_uint_eq(first_end(1), 95);
}
END_TEST

START_TEST(NM9_limit_switches_of_every_axis)
{
    static const char *const names[] = {"KHX0", "KHX1", "KHY0", "KHY1", "KHZ0", "KHZ1"};
    for (unsigned i = 0; i < 6; i++) {
        static const char *const permissions[] = {"MPX", "MPY", "MPZ"};
        static const char *const programs[] = {"G1 X1 F1000", "G1 Y1 F1000", "G1 Z1 F1000"};
        static const char *const back[] = {"G1 X-1 F1000", "G1 Y-1 F1000", "G1 Z-1 F1000"};
        rig_begin(back[i / 2]); /* the switch of the other direction holds it, too */
        set_bit(names[i], true);
        run_to(100);
        ck_assert_int_eq(at(100).x + at(100).y + at(100).z, 0);
        rig_begin(programs[i / 2]);
        set_bit(names[i], true);
        run_to(100);
        for (unsigned axis = 0; axis < 3; axis++)
            ck_assert_int_eq(bit(permissions[axis]), axis != i / 2);
        ck_assert_int_eq(at(100).x + at(100).y + at(100).z, 0);
        ck_assert(bit("SF_LS") && bit("PO_F"));
        set_bit(names[i], false);
        run_to(300);
        ck_assert_int_eq(at(300).x + at(300).y + at(300).z, MM);
    }
}
END_TEST

START_TEST(NB6_switches_of_axes_that_are_not_there)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\"/></ChannelConfig>", "G1 X1 F1000");
    set_bit("KHY0", true);
    set_bit("KH161", true);
    set_bit("ZPZ0", true);
    set_cell("SLS_REFER", 0, 0xFFFF);
    set_cell("HOMING", 0, 0xFFFF);
    run_to(96);
    ck_assert(!bit("SF_LS") && !bit("SF_SLS") && bit("MPX"));
    ck_assert_int_eq(at(96).x, MM);
    set_bit("KHX1", true);
    run_to(97);
    ck_assert(bit("SF_LS") && !bit("MPX"));
}
END_TEST

START_TEST(NH4_software_limits_of_another_axis)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Y\" SlsMinus=\"0\" SlsPlus=\"5\"/></ChannelConfig>",
                   "G1 Y10 F1000");
    set_cell("HOMING", 0, 2);
    set_cell("SLS_REFER", 0, 2);
    run_to(600);
    ck_assert(bit("SF_SLS") && !bit("MPY") && bit("MPX"));
    ck_assert_int_ge(at(600).y, 5 * MM);
    ck_assert_int_lt(at(600).y, 5 * MM + MM / 10);
    cnc_reset(&cnc);
    run_to(610);
    stand_at(1, 0); /* at the limit: - is forbidden, + is not */
    set_bit("AUTMAN_REQ", true);
    cnc.panel.jog_minus = 2;
    run_to(700);
    ck_assert_int_eq(at(700).y, 0);
    cnc.panel.jog_minus = 0;
    cnc.panel.jog_plus = 2;
    run_to(710);
    ck_assert_int_gt(at(710).y, 0);
}
END_TEST

/* NH4: in POS5; and only while the block moves the axis towards the limit. */
START_TEST(NH4_software_limits_count_in_POS5)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" Offset2=\"1\" SlsPlus=\"5\"/><Axis Name=\"Y\" SlsMinus=\"0\"/>"
                   "</ChannelConfig>",
                   "G23 G1 X3 F1000\nX6 Y0.1");
    set_cell("HOMING", 0, 3);
    set_cell("SLS_REFER", 0, 3);
    run_to(600);
    ck_assert_int_ge(at(600).x, 4 * MM);
    ck_assert_int_lt(at(600).x, 4 * MM + MM / 10);
}
END_TEST

/* NS2: rounded down, also below 0; seven axes: only the first six have these cells. */
START_TEST(NS2_eighths_of_a_micrometre_below_0)
{
    rig_power("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"7\"/></ChannelConfig>", NULL);
    stand_at(0, -1);
    stand_at(6, 100 * MM);
    run_to(1);
    ck_assert_int_eq(cell("B_POL", 0) + cell("B_INK", 0), -1);
    ck_assert_int_eq(cell("B_POL_EX", 6) + cell("B_INK_EX", 6), 100 * MM);
    stand_at(0, -8192);
    run_to(2);
    ck_assert_int_eq(cell("B_POL", 0) + cell("B_INK", 0), -1);
    stand_at(0, 0);
    run_to(3);
    ck_assert_int_eq(cell("B_POL", 0) + cell("B_INK", 0), 0);
}
END_TEST

START_TEST(NM6_a_way_of_one_unit)
{
    rig_begin("G1 X1 Y1 Z-1 F1000");
    stand_at(1, MM - 1);
    stand_at(2, -MM + 1);
    run_to(300);
    ck_assert_int_eq(at(300).y, MM);
    ck_assert_int_eq(at(300).z, -MM);
    ck_assert_int_eq(at(300).x, MM);
}
END_TEST

/* Parabolic ramps spread one unit over 50 T's: the axis is under way until it has been moved. */
START_TEST(NB5_INPOS_until_the_last_unit_is_moved)
{
    rig_power("<ChannelConfig AccelerationType=\"1\"/>", "G1 X0 F1000");
    set_cell("REFPOINT_DIST", 0, -1);
    set_cell("HOMING_REQ", 0, 1);
    start_in(2);
    run_to(2);
    while (at(cnc.turn).x < 0) {
        run_to(cnc.turn + 1);
        ck_assert_int_eq(bit("INPOS"), at(cnc.turn).x == 0 && at(cnc.turn).v == 0);
    }
    ck_assert_uint_eq(cnc.turn, 52);
    run_to(53);
    ck_assert(bit("INPOS"));
}
END_TEST

START_TEST(NJ4_switches_go_by_the_actual_position)
{
    static const struct cnc_switch switches[] = {{.place = CNC_BIT_KRx, .axis = 0, .has_at_least = true, .at_least = MM / 2}};
    rig_power("<ChannelConfig><Axis Name=\"X\" Lag=\"50\" MaxDifference=\"1000\"/></ChannelConfig>", "G1 X1 F1000");
    cnc.switches = switches;
    cnc.switch_count = 1;
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    for (bool was_there = false; cnc.turn < 400; was_there = cnc.axis[0].actual >= MM / 2) {
        run_to(cnc.turn + 1);
        ck_assert_int_eq(bit("KRX"), was_there);
    }
    ck_assert(bit("KRX"));
}
END_TEST

START_TEST(NB6_switches_of_the_panel_are_shown_one_by_one)
{
    static const char *const names[] = {"SF_CONDSTOPMODE", "SF_BLOCKBYBLOCK", "SF_INDICATIONMODE", "SF_SIMULATIONMODE",
                                        "SF_HIGHSPEEDMODE"};
    rig_power(NULL, NULL);
    bool *const switches[] = {&cnc.panel.m01, &cnc.panel.block_by_block, &cnc.panel.indication, &cnc.panel.simulation,
                              &cnc.panel.high_speed};
    for (unsigned i = 0; i < 5; i++) {
        *switches[i] = true;
        run_to(cnc.turn + 1);
        for (unsigned k = 0; k < 5; k++)
            ck_assert_int_eq(bit(names[k]), k == i);
        *switches[i] = false;
    }
    ck_assert(!bit("SF_RUN") && !bit("SF_STOP") && !bit("SF_BACKWARD"));
}
END_TEST

/* NS5: a critical error is reported once. */
START_TEST(NS5_the_event_of_a_critical_error)
{
    rig_power(NULL, NULL);
    set_cell("WORD.BZH09", 0, 0x0707);
    cnc_set_critical(&cnc, 7);
    cnc_set_critical(&cnc, 7);
    ck_assert_uint_eq(count_events(CNC_EVENT_CRITICAL), 1);
    cnc_set_critical(&cnc, 8);
    ck_assert_uint_eq(count_events(CNC_EVENT_CRITICAL), 2);
    ck_assert_int_eq(last_event(CNC_EVENT_CRITICAL), 8);
    cnc_set_critical(&cnc, 0);
    ck_assert_uint_eq(count_events(CNC_EVENT_CRITICAL), 2);
}
END_TEST

/* ---- Restarts ----------------------------------------------------------------------------------------------------------- */

/* NM6, NH1: an axis gets its position while INIT has not been passed. */
START_TEST(NM6_an_axis_that_stands_at_its_target_meanwhile)
{
    for (unsigned both = 0; both < 2; both++) {
        rig_begin(both ? "G1 X10 Y1 F1000" : "G1 X10 F1000");
        run_to(1);
        ck_assert(bit("PO_OSXPI") && !bit("PO_POL"));
        cnc_stop(&cnc);
        run_to(5);
        set_cell("REFPOINT_DIST", 0, 10 * MM);
        set_cell("HOMING_REQ", 0, 1);
        start_in(7);
        run_to(8);
        ck_assert(!bit("PO_OSXPI") && !bit("PO_OSX"));
        ck_assert_int_eq(bit("PO_POL"), !both);
        ck_assert_int_eq(bit("PO_OSYPI"), both);
        run_to(300);
        ck_assert(bit("SF_STOP") && !bit("PO_F") && bit("PO_POL"));
        ck_assert_int_eq(at(300).x, 10 * MM);
        ck_assert_int_eq(at(300).y, both ? MM : 0);
    }
}
END_TEST

/* NB7: what of the closing pass is left has to be passed. */
START_TEST(NB7_a_restart_in_a_closing_pass_that_waits)
{
    rig_begin_plc(NULL, "M8\nM9", "DATA\nOUT BIT 0\nDATA_END\nMODULE_BLOCK_DONE\n LDR OUT\n EX0\nMODULE_BLOCK_DONE_END\n");
    run_to(10);
    cnc_stop(&cnc);
    run_to(20);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_eq(cell("STATUS_RESTART", 0), CNC_DONE);
    start_in(21);
    run_to(30);
    ck_assert(bit("PO_F") && bit("M08PI") && !bit("PO_STOP"));
    set_bit("OUT", true);
    run_to(31);
    ck_assert_uint_eq(cnc.machine.block, 1);
}
END_TEST

START_TEST(NQ2_a_choice_counts_once)
{
    rig_power(NULL, "M3\nM8\nM5");
    ck_assert_int_eq(cnc_select(&cnc, 1, false), CNC_OK);
    start_in(1);
    run_to(20);
    ck_assert(bit("SF_STOP") && !bit("M08PI"));
    start_in(21);
    run_to(23);
    ck_assert_uint_eq(cnc.machine.block, 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_SelBlock, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_TchlOff, 0), 0);
    ck_assert(bit("M08PI"));
}
END_TEST

START_TEST(NQ2_Cont_by_where_the_chosen_block_begins)
{
    rig_power(NULL, "G1 X1 F1000\nG1 X2 Y1\nG1 X3");
    ck_assert_int_eq(cnc_select(&cnc, 2, true), CNC_OK);
    stand_at(0, 2 * MM);
    stand_at(1, 1 * MM);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 0);
    stand_at(1, 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 1);
    stand_at(1, 1 * MM);
    stand_at(0, 1 * MM); /* where the block before it begins */
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 1);
}
END_TEST

/* ---- Feed, gears, functions, manual moves ------------------------------------------------------------------------------- */

START_TEST(NF4_the_slowest_spindle_there_is)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\"/><Gear No=\"1\" MaxSpeed=\"0.001\"/></ChannelConfig>",
                   "M3 S0.001\nG95 G1 X10 F1000000");
    run_to(100);
    ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 1);
    ck_assert_int_eq(top_speed(), 1092266);
}
END_TEST

START_TEST(NF1_the_smallest_feed_with_the_greatest_overrides)
{
    rig_begin("G1 X1 F0.000001");
    set_cell("WORD.BZH09", 0, 65535);
    set_cell("FEED_OVR_MULTIPLIER", 0, 65535);
    set_bit("FEED_OVR", true);
    run_to(10);
    ck_assert_int_eq(at(10).v, 4); /* 0.0043 mm/min */
}
END_TEST

START_TEST(NG2_H_is_cut)
{
    rig_begin("H9.999999\nH100");
    run_to(1);
    ck_assert_int_eq(cell("PB05", 0), 0x09);
    run_to(3);
    ck_assert_int_eq(cell("PB05", 0), 0x00);
}
END_TEST

/* A reference and central annulment are starts, too, of something that is neither threading nor rapid (8.2.3, 8.2.4). */
START_TEST(NB8_threading_and_rapid_end_with_the_next_start)
{
    for (unsigned by_reference = 0; by_reference < 2; by_reference++) {
        rig_begin("S1000 M3 G33 X1 F1\nG0 X2");
        cnc.panel.spindle = 50;
        run_to(50);
        ck_assert(bit("G33PI"));
        ck_assert_int_eq(cell("REQ_SPEED_PM", 0), 999908);
        if (by_reference) {
            run_to(20000);
            ck_assert(!bit("PO_F") && bit("G00PI")); /* of the block that was the last one */
            set_cell("HOMING_START_REQ", 0, 1);
            run_to(20001);
            ck_assert(bit("REFPI"));
        } else {
            cnc_reset(&cnc);
            run_to(100);
            ck_assert(bit("CAPI"));
            ck_assert_int_eq(cell("REQ_SPEED_PM", 0), 499893); /* the pot counts again */
        }
        ck_assert(!bit("G33PI") && !bit("G00PI"));
    }
}
END_TEST

/* CNT_NEXT_BLOCKS is set at the begin of each pass of MODULE_BLOCK_INIT (8.3.2): central annulment has gone back to the begin. */
START_TEST(NQ1_next_blocks_in_the_pass_of_a_central_annulment)
{
    rig_begin("G1 X1 F1000\nX2\nX3 M0\nX4");
    run_to(2000);
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 1);
    cnc_reset(&cnc);
    run_to(2001);
    ck_assert(bit("CAPI"));
    ck_assert_int_eq(cell("CNT_NEXT_BLOCKS", 0), 4);
}
END_TEST

/* NE4: a stop drops a start only if one waits. */
START_TEST(NE4_a_stop_without_a_start)
{
    rig_power(NULL, "M3");
    set_bit("START_SUSPEND", true);
    cnc_stop(&cnc);
    run_to(5);
    ck_assert_uint_eq(rig_events, 0);
    start_in(6);
    run_to(7);
    ck_assert(bit("PO_F"));
}
END_TEST

/* A PLC program answers the event of a START with a stop: nothing moves. STOP acts on what is there, the start is not yet. */
START_TEST(NE4_a_stop_by_the_event_of_a_start_drops_it)
{
    static const char *const stops[] = {"STOP_REQ", "STOP_EMERGENCY_REQ", "STOPPI"};
    for (unsigned i = 0; i < 3; i++) {
        char plc[100];
        snprintf(plc, sizeof plc, "PROC_BEGIN _ON_EVENT\n FL 1,%s\nPROC_END _ON_EVENT\n", stops[i]);
        rig_begin_plc(NULL, "G1 X10 F1000", plc);
        run_to(100);
        ck_assert(!bit("PO_F") && at(100).x == 0 && bit("SF_STOP"));
        ck_assert_uint_eq(count_events(CNC_EVENT_START_REFUSED), 1);
    }
    rig_begin("G1 X10 F1000");
    run_to(100);
    cnc_stop(&cnc);
    start_in(200);
    set_bit("STOP_REQ", true);
    run_to(300);
    ck_assert(bit("PO_STOP") && !bit("STOP_REQ")); /* it is as it was */
    ck_assert_int_eq(at(300).x, at(199).x);
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_STOPPED);
    cnc_stop(&cnc); /* the panel knows the order: this STOP came before the START */
    start_in(301);
    run_to(400);
    ck_assert_int_gt(at(400).x, at(300).x);
}
END_TEST

START_TEST(NF5_a_gear_leaves_the_functions_of_other_groups)
{
    rig_begin("M7\nM41\nM44");
    run_to(4);
    ck_assert(bit("M07PI") && bit("M41PI"));
    run_to(20);
    ck_assert(bit("M07PI") && bit("M44PI") && !bit("M41PI"));
}
END_TEST

START_TEST(NQ1_fields_of_other_values)
{
    rig_begin("G23 G1 X3 F1000\nG24 X4 M100\nX5");
    run_to(1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_ContinuousMode, 0), 1);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_ContinuousMode, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_RevFeed, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_ConstCutSpeed, 0), 0);
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_M, 14), 0x100);
    ck_assert_double_eq(cnc_queue_real(&cnc, 0, CNC_QUEUE_AxNC, 0), 3);
    ck_assert_double_eq(cnc_queue_real(&cnc, 1, CNC_QUEUE_AxNC, 0), 4);
    ck_assert_double_eq(cnc_queue_real(&cnc, 2, CNC_QUEUE_AxNC, 0), 5);
}
END_TEST

START_TEST(NA4_after_an_emergency_stop_an_axis_moves_again)
{
    rig_power(NULL, NULL);
    set_bit("AUTMAN_REQ", true);
    cnc.panel.jog_plus = 1;
    run_to(50);
    set_bit("STOP_EMERGENCY_REQ", true);
    run_to(200);
    const int64_t x = at(200).x;
    ck_assert_int_eq(at(199).x, x);
    cnc.panel.jog_plus = 0;
    run_to(201);
    cnc.panel.jog_plus = 1;
    run_to(203);
    ck_assert_int_eq(at(203).x - x, 32768 + 65536);
}
END_TEST

START_TEST(NE3_the_slowest_manual_move_is_a_motion)
{
    rig_power(NULL, NULL);
    set_bit("AUTMAN_REQ", true);
    set_bit("REQ_EXT_FEED_AUTMAN", true);
    set_cell("EXT_FEED_AUTMAN", 0, 1);
    set_cell("FEED_OVR_MULTIPLIER", 0, 1);
    cnc.panel.jog_minus = 2;
    run_to(10);
    ck_assert_int_eq(at(10).y, -10); /* 1.09 u/T, rounded down */
    ck_assert(bit("PO_OSYPI") && bit("SM_POYPI") && !bit("INPOS"));
}
END_TEST

/* No axis goes faster than its FeedRT, whatever the other feeds are (8.1.19, NM6): 65 u/T is 0.06 mm/min. */
START_TEST(NM6_FeedRT_limits_references_and_spindle_axes)
{
    rig_power("<ChannelConfig><Axis Name=\"X\" FeedRT=\"0.06\"/>"
              "<Axis Name=\"4\" Rotary=\"1\" FeedRT=\"0.06\"/></ChannelConfig>", NULL);
    stand_at(3, MM);
    cnc_position_spindle(&cnc, 3);
    set_cell("HOMING_START_REQ", 0, 1);
    run_to(101);
    ck_assert_int_eq(at(101).x, -100 * 65);
    ck_assert_int_eq(cnc.axis[3].position, MM + 101 * 65);
}
END_TEST

static Suite *clauses_suite(void)
{
    Suite *suite = suite_create("cnc_clauses");
    TCase *clauses = tcase_create("clauses");
    tcase_add_test(clauses, NE1_axes_not_in_the_block_do_not_matter);
    tcase_add_test(clauses, NM9_limit_switches_of_every_axis);
    tcase_add_test(clauses, NB6_switches_of_axes_that_are_not_there);
    tcase_add_test(clauses, NH4_software_limits_of_another_axis);
    tcase_add_test(clauses, NS2_eighths_of_a_micrometre_below_0);
    tcase_add_test(clauses, NM6_a_way_of_one_unit);
    tcase_add_test(clauses, NB5_INPOS_until_the_last_unit_is_moved);
    tcase_add_test(clauses, NJ4_switches_go_by_the_actual_position);
    tcase_add_test(clauses, NB6_switches_of_the_panel_are_shown_one_by_one);
    tcase_add_test(clauses, NS5_the_event_of_a_critical_error);
    tcase_add_test(clauses, NM6_an_axis_that_stands_at_its_target_meanwhile);
    tcase_add_test(clauses, NB7_a_restart_in_a_closing_pass_that_waits);
    tcase_add_test(clauses, NQ2_a_choice_counts_once);
    tcase_add_test(clauses, NQ2_Cont_by_where_the_chosen_block_begins);
    tcase_add_test(clauses, NF4_the_slowest_spindle_there_is);
    tcase_add_test(clauses, NH4_software_limits_count_in_POS5);
    tcase_add_test(clauses, NF1_the_smallest_feed_with_the_greatest_overrides);
    tcase_add_test(clauses, NG2_H_is_cut);
    tcase_add_test(clauses, NB8_threading_and_rapid_end_with_the_next_start);
    tcase_add_test(clauses, NQ1_next_blocks_in_the_pass_of_a_central_annulment);
    tcase_add_test(clauses, NE4_a_stop_without_a_start);
    tcase_add_test(clauses, NE4_a_stop_by_the_event_of_a_start_drops_it);
    tcase_add_test(clauses, NF5_a_gear_leaves_the_functions_of_other_groups);
    tcase_add_test(clauses, NQ1_fields_of_other_values);
    tcase_add_test(clauses, NA4_after_an_emergency_stop_an_axis_moves_again);
    tcase_add_test(clauses, NE3_the_slowest_manual_move_is_a_motion);
    tcase_add_test(clauses, NM6_FeedRT_limits_references_and_spindle_axes);
    suite_add_tcase(suite, clauses);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(clauses_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
