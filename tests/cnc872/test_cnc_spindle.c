/* SPDX-License-Identifier: MIT */
/* The spindle, its gears, threading, spindle axes (NF2 to NF6): the examples W24, W27, W28, W35, W42, W46 of docs/CNC872.md. */
#include <stdlib.h>

#include "cnc872/frame.h"
#include "cnc_rig.h"

static const char gears[] = "<ChannelConfig><Gear No=\"1\" MaxSpeed=\"500\"/><Gear No=\"2\" MaxSpeed=\"1000\"/>"
                            "<Gear No=\"3\" MaxSpeed=\"2000\"/>"
                            "<Gear No=\"4\" MinSpeed=\"100\" MaxSpeed=\"4000\"/></ChannelConfig>";

static void begin_in_gear(const char *nc, unsigned gear)
{
    rig_begin_with(gears, nc);
    set_cell("SPINDLE_GEAR_ACT_1", 0, gear);
}

static void check_speed(int64_t voltage, int64_t pm, int64_t pt)
{
    ck_assert_int_eq(cell("VYSOVERS", 0), voltage);
    ck_assert_int_eq(cell("REQ_SPEED_PM", 0), pm);
    ck_assert_int_eq(cell("REQ_SPEED_PT", 0), pt);
}

static int64_t programmed_voltage(void)
{
    return cell("PB11", 0) + cell("PB11", 1) * 256;
}

START_TEST(w24_overrides_of_the_feed)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" FeedRT=\"1200\"/></ChannelConfig>", "G1 X10 F1000");
    set_bit("FEED_OVR", true);
    set_cell("BZH09", 0, 1500 & 0xFF);
    set_cell("BZH09", 1, 1500 >> 8);
    run_to(300);
    ck_assert_int_eq(top_speed(), 1310720);
    rig_begin("G1 X10 F1000");
    cnc.panel.feed = 80;
    set_cell("FEED_OVR_MULTIPLIER", 0, 500);
    run_to(300);
    ck_assert_int_eq(top_speed(), 436906);
    rig_begin("G1 X10 F2000");
    set_bit("LIMIT_FEED_REQ", true);
    set_cell("LIMIT_FEED", 0, 17 * 65536);
    run_to(300);
    ck_assert_int_eq(top_speed(), 1114112);
    rig_begin("M48 G1 X10 F1000");
    cnc.panel.feed = 50;
    run_to(300);
    ck_assert_int_eq(top_speed(), 1092266);
    rig_begin("M48\nM49 G1 X10 F1000"); /* active again */
    cnc.panel.feed = 50;
    run_to(300);
    ck_assert_int_eq(top_speed(), 546133);
}
END_TEST

START_TEST(w27_speed_of_the_spindle)
{
    begin_in_gear("S1000 M3", 3);
    run_to(2);
    check_speed(0x3FFF, 999969, 5999);
    ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 999969);
    ck_assert_int_eq(cell("AVG_SPEED_PM", 0), 999969);
    ck_assert_int_eq(cell("ACT_SPEED_PT", 0), 5999);
    cnc.panel.spindle = 80;
    run_to(3);
    check_speed(0x3332, 799951, 4799);
    ck_assert_int_eq(programmed_voltage(), 0x3FFF);
    cnc.panel.spindle = 100;
    set_cell("SPEED_OVR_MULTIPLIER", 0, 900);
    run_to(4);
    check_speed(0x3999, 899990, 5399);
    set_cell("SPEED_OVR_MULTIPLIER", 0, 1000);
    set_bit("SPEED_OVR", true);
    set_cell("SPEED_OVR_EXT", 0, 800);
    cnc.panel.spindle = 50; /* set aside */
    run_to(5);
    check_speed(0x3332, 799951, 4799);
    begin_in_gear("S500 M3", 1);
    cnc.panel.spindle = 120;
    run_to(2);
    check_speed(0x7FFF, 500000, 3000);
}
END_TEST

START_TEST(nf3_actual_speed)
{
    begin_in_gear("S1000\nM4\nM5", 3);
    run_to(2);
    ck_assert_int_eq(cell("REQ_SPEED_PM", 0), 999969);
    static const char *const standing[] = {"ACT_SPEED_PM", "ACT_SPEED_PT", "AVG_SPEED_PM", "AVG_SPEED_PT",
                                           "ACT_SPEED2_PM", "ACT_SPEED2_PT", "AVG_SPEED2_PM", "AVG_SPEED2_PT"};
    for (unsigned i = 0; i < 8; i++)
        ck_assert_int_eq(cell(standing[i], 0), 0); /* neither M3 nor M4 */
    run_to(3);
    ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 999969);
    set_cell("SIM_SPEED_PT", 0, 600);
    run_to(4);
    ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 100000);
    ck_assert_int_eq(cell("AVG_SPEED_PT", 0), 600);
    run_to(6);
    ck_assert_int_eq(cell("ACT_SPEED_PT", 0), 0);
    static const int64_t others[] = {0, 9, 33};
    for (unsigned i = 0; i < 3; i++) { /* not in the configuration: 0-4000 */
        begin_in_gear("S1000", 3);
        set_cell("SPINDLE_GEAR_ACT_1", 0, others[i]);
        run_to(2);
        check_speed(0x1FFF, 999908, 5999);
        ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK_REFUSED), 0);
    }
}
END_TEST

START_TEST(w28_constant_cutting_speed)
{
    static const struct {
        int64_t x, voltage;
    } places[] = {{50, 0x145F}, {10, 0x65DB}, {5, 0x7FFF}, {0, 0x7FFF}, {-50, 0x145F}};
    for (unsigned i = 0; i < sizeof places / sizeof *places; i++) {
        begin_in_gear("G96 S100 L2000 M3", 3);
        cnc.axis[0].position = cnc.axis[0].actual = places[i].x * MM;
        run_to(2);
        ck_assert_int_eq(cell("VYSOVERS", 0), places[i].voltage);
        ck_assert_int_eq(programmed_voltage(), 0);
    }
    begin_in_gear("G96 S100 L500", 3); /* the limit counts at X = 0, too */
    run_to(1);
    ck_assert_int_eq(cell("VYSOVERS", 0), 0x1FFF);
    begin_in_gear("G96 S100", 3); /* none programmed */
    run_to(1);
    ck_assert_int_eq(cell("VYSOVERS", 0), 0x7FFF);
    begin_in_gear("G96", 3);
    run_to(1);
    ck_assert_int_eq(cell("VYSOVERS", 0), 0);
}
END_TEST

START_TEST(w28_feed_a_revolution)
{
    begin_in_gear("S1000 M3\nG95 G1 X10 F0.2", 3);
    run_to(500);
    ck_assert_int_eq(top_speed(), 218446);
}
END_TEST

START_TEST(w42_programmed_speed_is_that_of_g97)
{
    begin_in_gear("S1000 M3\nG96 S100\nG97", 3);
    cnc.axis[0].position = cnc.axis[0].actual = 50 * MM;
    run_to(4);
    ck_assert_int_eq(programmed_voltage(), 0x3FFF);
    ck_assert_int_eq(cell("VYSOVERS", 0), 0x145F);
    run_to(8);
    ck_assert_int_eq(cell("VYSOVERS", 0), 0x3FFF); /* G97 again */
}
END_TEST

START_TEST(w46_threading)
{
    begin_in_gear("S1000 M3\nG33 X10 F0.5\nG1 X11 F100", 3);
    cnc.panel.spindle = 80;
    cnc.panel.feed = 50;
    run_to(2);
    check_speed(0x3332, 799951, 4799);
    run_to(900);
    ck_assert(bit("G33PI"));
    check_speed(0x3FFF, 999969, 5999);
    ck_assert_int_eq(top_speed(), 546116);
    run_to(1300);
    ck_assert(!bit("G33PI"));
    check_speed(0x3332, 799951, 4799);
}
END_TEST

START_TEST(nf4_threading_waits_for_the_spindle)
{
    begin_in_gear("S1000\nG33 X10 F0.5", 3);
    run_to(200);
    ck_assert_int_eq(at(200).x, 0);
    set_cell("SIM_SPEED_PT", 0, 6000);
    run_to(300);
    ck_assert_int_eq(at(300).x, 0); /* M3 and M4 are off */
    begin_in_gear("S1000 M3\nG33 X10 F0.5", 3);
    set_cell("SIM_SPEED_PT", 0, 6000);
    run_to(500);
    ck_assert_int_eq(top_speed(), 546133);
}
END_TEST

START_TEST(nf5_gears)
{
    rig_begin_with(gears, "M43 S1500\nM40 S500\nM40 S1000\nM40 S4000\nM41 S100");
    run_to(1);
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 3);
    ck_assert(bit("M43PI") && bit("ZMM3PI"));
    static const int64_t chosen[] = {1, 2, 4, 1};
    for (unsigned i = 0; i < 4; i++) {
        run_to(3 + 2 * i);
        ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), chosen[i]);
        ck_assert_int_eq(bit("M41PI"), chosen[i] == 1);
        ck_assert_int_eq(bit("M42PI"), chosen[i] == 2);
        ck_assert_int_eq(bit("M44PI"), chosen[i] == 4);
        ck_assert(!bit("M43PI") && bit("ZMM3PI"));
    }
}
END_TEST

/* M40 stays in force: from then on the gear follows S (8.2.9), and the change bit follows the gear. */
START_TEST(nf5_the_automatic_gear_follows_S)
{
    static const struct {
        int64_t gear;
        bool change;
    } wanted[] = {{1, true}, {3, true}, {3, false}, {3, false}, {2, true}, {4, true}, {4, false}};
    rig_begin_with(gears, "M40 S500\nS1500\nS1200\nG96 S100 L400\nG97 S600\nM44 S2500\nS600");
    for (unsigned i = 0; i < 7; i++) {
        run_to(1 + 2 * i);
        ck_assert(bit("PO_F"));
        ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), wanted[i].gear);
        ck_assert_int_eq(bit("M41PI") + 2 * bit("M42PI") + 3 * bit("M43PI") + 4 * bit("M44PI"), wanted[i].gear);
        ck_assert_int_eq(bit("ZMM3PI"), wanted[i].change);
    }
    rig_begin_with(gears, "M40 S500\nS4001\nM8"); /* no gear reaches it */
    run_to(20);
    ck_assert_int_eq(last_event(CNC_EVENT_BLOCK_REFUSED), 2);
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 1);
    rig_begin_with(gears, "M40 S500\nS1500"); /* the PLC program writes the gear; the bits ask for it */
    set_bit("REQ_EXT_SPINDLE_GEAR", true);
    set_bit("REQ_MAN_SPINDLE_GEAR", true);
    run_to(3);
    ck_assert(bit("M43PI") && bit("ZMM3PI"));
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 1);
}
END_TEST

START_TEST(nf5_blocks_that_are_not_refused)
{
    rig_begin_with(gears, "M43 S1500\nM41 G96 S100 L400\nM8"); /* the limits are of G97 */
    run_to(3);
    ck_assert(bit("PO_F") && bit("M41PI"));
    run_to(5);
    ck_assert(bit("PO_F") && bit("M08PI"));
    rig_begin_with(gears, "M43 S1500\nM8\nS1600"); /* neither S nor a gear */
    run_to(2);
    set_cell("SPINDLE_GEAR_ACT_1", 0, 1);
    run_to(3);
    ck_assert(bit("PO_F") && bit("M08PI"));
    set_bit("REQ_EXT_SPINDLE_GEAR", true); /* the PLC program writes the gear */
    set_bit("REQ_MAN_SPINDLE_GEAR", true);
    run_to(5);
    ck_assert(bit("PO_F"));
    rig_power(gears, "M41 S1500"); /* its technology is off */
    cnc_select(&cnc, 0, false);
    cnc_start(&cnc);
    run_to(1);
    ck_assert(bit("PO_F"));
}
END_TEST

/* A function that the configuration has added to group 3 is no gear: only S is looked at. */
START_TEST(nf5_other_functions_of_the_group_of_gears)
{
    rig_begin_with("<ChannelConfig><Gear No=\"1\" MaxSpeed=\"500\"/><MFunctions><MFunc No=\"39\" GroupNo=\"3\"/>"
                   "<MFunc No=\"45\" GroupNo=\"3\"/></MFunctions></ChannelConfig>",
                   "M41 S500\nM39\nM45\nM39 S501\nM8");
    run_to(6);
    ck_assert(bit("PO_F") && bit("ZMM3PI") && bit("M41PI")); /* the block of M45 */
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 1);
    run_to(20);
    ck_assert_int_eq(last_event(CNC_EVENT_BLOCK_REFUSED), 4);
    set_cell("SPINDLE_GEAR_ACT_1", 0, 2); /* which has no limits */
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(30);
    ck_assert(bit("M08PI"));
}
END_TEST

/* F a revolution, S and the overrides at their greatest: FeedRT is the limit, nothing overflows. */
START_TEST(nm7_the_greatest_feed)
{
    rig_begin("M3 G95 G1 X100 F1000000");
    set_cell("SIM_SPEED_PT", 0, 12000000);
    set_cell("BZH09", 0, 255);
    set_cell("BZH10", 0, 255);
    set_bit("FEED_OVR", true);
    set_cell("FEED_OVR_MULTIPLIER", 0, 65535);
    run_to(1500);
    ck_assert_int_eq(cell("ACT_SPEED_PM", 0), 2000000000);
    ck_assert_int_eq(top_speed(), 13107200);
    ck_assert_int_eq(at(1500).x, 100 * MM);
}
END_TEST

START_TEST(nf5_the_automatic_gear_beyond_all_gears)
{
    rig_begin_with("<ChannelConfig><Gear No=\"2\" MaxSpeed=\"1000\"/></ChannelConfig>", "M40 S100\nM40 S2000");
    run_to(1);
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 2);
    run_to(3);
    ck_assert(bit("SF_STOP") && !bit("PO_F")); /* no gear reaches it */
}
END_TEST

START_TEST(nf5_gears_of_the_plc)
{
    rig_begin_with(gears, "M43 S1500");
    set_bit("REQ_EXT_SPINDLE_GEAR", true);
    run_to(1);
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 3); /* one of the two is not enough */
    rig_begin_with(gears, "M43 S1500");
    set_bit("REQ_EXT_SPINDLE_GEAR", true);
    set_bit("REQ_MAN_SPINDLE_GEAR", true);
    run_to(1);
    ck_assert_int_eq(cell("SPINDLE_GEAR_ACT_1", 0), 1);
    ck_assert(bit("M43PI")); /* what is asked for */
}
END_TEST

START_TEST(nf5_speed_outside_of_the_gear)
{
    rig_begin_with(gears, "M41\nS501 M3 G1 X1 F1000\nM8");
    run_to(3);
    ck_assert(bit("SF_STOP") && !bit("PO_F") && !bit("M03PI"));
    ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK_REFUSED), 1);
    ck_assert_int_eq(last_event(CNC_EVENT_BLOCK_REFUSED), 2);
    run_to(100);
    ck_assert_int_eq(at(100).x, 0);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK); /* refused again, until there is another gear */
    run_to(101);
    ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK_REFUSED), 2);
    ck_assert(bit("SF_STOP") && !bit("PO_F"));
    set_cell("SPINDLE_GEAR_ACT_1", 0, 2);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(102);
    ck_assert(bit("PO_F") && bit("M03PI") && !bit("SF_STOP"));
    rig_begin_with(gears, "M44 S99"); /* below */
    run_to(1);
    ck_assert(bit("SF_STOP") && !bit("PO_F"));
    rig_begin_with(gears, "M41 G96 S900 L5000"); /* not with G96 */
    run_to(1);
    ck_assert(bit("PO_F"));
}
END_TEST

/* A rotary axis 4 at 90 degrees. */
static void power_rotary(void)
{
    rig_power("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"4\" Rotary=\"1\" FeedRef=\"3600\"/></ChannelConfig>",
              "G1 X1 A4=100 F1000");
    cnc.axis[3].position = cnc.axis[3].actual = INT64_C(90000) * CNC_U_PER_UM;
}

START_TEST(w35_spindle_axis)
{
    power_rotary();
    cnc_position_spindle(&cnc, 3);
    ck_assert(bit("POLOHV_4")); /* at once: the PLC program may wait for it in the same call */
    run_to(1);
    ck_assert(bit("POLOHV_4") && bit("PO_OS4PI") && !bit("INPOS"));
    ck_assert_int_eq(cnc.axis[3].position, INT64_C(90000) * CNC_U_PER_UM + 32768);
    run_to(4618);
    ck_assert(bit("POLOHV_4"));
    run_to(4619);
    ck_assert(!bit("POLOHV_4") && !bit("PO_OS4PI") && bit("INPOS"));
    ck_assert_int_eq(cnc.axis[3].position, INT64_C(360000) * CNC_U_PER_UM);
    cnc_position_spindle(&cnc, 3); /* it is there */
    ck_assert(!bit("POLOHV_4"));
    run_to(4620);
    ck_assert(!bit("POLOHV_4"));
    cnc.axis[3].position = cnc.axis[3].actual = INT64_C(-1000) * CNC_U_PER_UM;
    cnc_position_spindle(&cnc, 3);
    run_to(8000);
    ck_assert_int_eq(cnc.axis[3].position, 0);
    cnc_position_spindle(&cnc, 0); /* not a rotary axis */
    cnc.axis[0].position = cnc.axis[0].actual = MM;
    cnc_position_spindle(&cnc, 5); /* not configured */
    run_to(8001);
    ck_assert(!bit("POLOHV_X") && !bit("PO_OSXPI") && !bit("POLOHV_6"));
    ck_assert_int_eq(cnc.axis[0].position, MM);
}
END_TEST

START_TEST(nf6_holds_of_a_spindle_axis)
{
    power_rotary();
    cnc_position_spindle(&cnc, 3);
    run_to(1000);
    set_bit("MP4PI", false);
    run_to(1200);
    const int64_t held = cnc.axis[3].position;
    run_to(1300);
    ck_assert_int_eq(cnc.axis[3].position, held);
    ck_assert(bit("POLOHV_4"));
    set_bit("MP4PI", true);
    set_bit("KH40", true);
    run_to(1400);
    ck_assert_int_eq(cnc.axis[3].position, held);
    set_bit("KH40", false);
    run_to(6000);
    ck_assert_int_eq(cnc.axis[3].position, INT64_C(360000) * CNC_U_PER_UM);
}
END_TEST

START_TEST(nf6_waits_for_other_motions_of_its_axis)
{
    power_rotary();
    cnc_start(&cnc);
    run_to(20);
    cnc_position_spindle(&cnc, 3);
    ck_assert(bit("POLOHV_4"));
    while (bit("PO_F"))
        run_to(cnc.turn + 1);
    ck_assert_int_ge(cnc.axis[3].position, 100 * MM); /* the block has got to its target */
    run_to(cnc.turn + 50000);
    ck_assert(!bit("POLOHV_4"));
    ck_assert_int_eq(cnc.axis[3].position, INT64_C(360000) * CNC_U_PER_UM);
}
END_TEST

START_TEST(nf6_while_other_axes_move)
{
    power_rotary();
    rig_load_nc("G1 X10 F1000");
    cnc_start(&cnc);
    run_to(20);
    cnc_position_spindle(&cnc, 3);
    const int64_t x = cnc.axis[0].position;
    run_to(30);
    ck_assert_int_gt(cnc.axis[0].position, x);
    ck_assert_int_gt(cnc.axis[3].position, INT64_C(90000) * CNC_U_PER_UM);
    ck_assert(bit("POLOHV_4") && bit("PO_OS4PI") && bit("PO_OSXPI"));
}
END_TEST

START_TEST(nf6_a_block_waits_for_a_spindle_axis)
{
    power_rotary();
    cnc_position_spindle(&cnc, 3);
    cnc_start(&cnc);
    run_to(4619);
    ck_assert(!bit("POLOHV_4") && bit("PO_F"));
    ck_assert_int_eq(at(4619).x, 0);
    ck_assert_int_eq(cnc.axis[3].position, INT64_C(360000) * CNC_U_PER_UM);
    run_to(4620);
    ck_assert_int_gt(at(4620).x, 0);
    while (bit("PO_F"))
        run_to(cnc.turn + 1);
    ck_assert_int_eq(cnc.axis[3].position, 100 * MM);
}
END_TEST

/* SPI_AX_4 in the INIT pass of a reference of the same axis: the reference begins once the axis is at its whole turn. */
START_TEST(nf6_a_reference_waits_for_a_spindle_axis)
{
    power_rotary();
    set_bit("EXT_PLC", true);
    set_cell("HOMING_START_REQ", 0, 8);
    run_to(10);
    cnc_position_spindle(&cnc, 3);
    run_to(20);
    set_bit("PLC_PASS_DONE", true);
    int64_t before = cnc.axis[3].position;
    while (bit("POLOHV_4")) {
        run_to(cnc.turn + 1);
        const int64_t by = cnc.axis[3].position - before;
        before = cnc.axis[3].position;
        ck_assert(by >= 0 && by <= cnc_speed_of(config.axis[3].feed_reference));
    }
    ck_assert_int_eq(before, INT64_C(360000) * CNC_U_PER_UM);
    run_to(cnc.turn + 10);
    ck_assert_int_lt(cnc.axis[3].position, before); /* the reference, in - */
    set_bit("KR4", true);
    run_to(cnc.turn + 200);
    ck_assert_int_eq(cell("HOMING", 0), 8);
}
END_TEST

START_TEST(nf6_central_annulment_ends_it)
{
    power_rotary();
    cnc_position_spindle(&cnc, 3);
    run_to(1000);
    cnc_reset(&cnc);
    run_to(1200);
    ck_assert(bit("CAPI") && !bit("POLOHV_4") && !bit("PO_OS4PI") && bit("INPOS"));
    ck_assert_int_lt(cnc.axis[3].position, INT64_C(360000) * CNC_U_PER_UM);
    set_bit("MP4PI", false); /* held for ever */
    cnc_position_spindle(&cnc, 3);
    run_to(1300);
    cnc_reset(&cnc);
    run_to(1310);
    ck_assert(!bit("POLOHV_4") && bit("SF_STOP"));
    set_bit("MP4PI", true);
    cnc.panel.manual = true; /* it waits for a manual move */
    cnc.panel.jog_plus = 8;
    run_to(1400);
    cnc_position_spindle(&cnc, 3);
    run_to(1410);
    ck_assert(bit("POLOHV_4"));
    cnc_reset(&cnc);
    run_to(1411);
    ck_assert(!bit("POLOHV_4"));
    run_to(1600);
    ck_assert(bit("SF_STOP") && bit("INPOS")); /* the key has not been let go */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_spindle");
    TCase *all = tcase_create("spindle");
    tcase_add_test(all, w24_overrides_of_the_feed);
    tcase_add_test(all, w27_speed_of_the_spindle);
    tcase_add_test(all, nf3_actual_speed);
    tcase_add_test(all, w28_constant_cutting_speed);
    tcase_add_test(all, w28_feed_a_revolution);
    tcase_add_test(all, w42_programmed_speed_is_that_of_g97);
    tcase_add_test(all, w46_threading);
    tcase_add_test(all, nf4_threading_waits_for_the_spindle);
    tcase_add_test(all, nf5_gears);
    tcase_add_test(all, nf5_the_automatic_gear_follows_S);
    tcase_add_test(all, nf5_blocks_that_are_not_refused);
    tcase_add_test(all, nf5_other_functions_of_the_group_of_gears);
    tcase_add_test(all, nm7_the_greatest_feed);
    tcase_add_test(all, nf5_the_automatic_gear_beyond_all_gears);
    tcase_add_test(all, nf5_gears_of_the_plc);
    tcase_add_test(all, nf5_speed_outside_of_the_gear);
    tcase_add_test(all, w35_spindle_axis);
    tcase_add_test(all, nf6_holds_of_a_spindle_axis);
    tcase_add_test(all, nf6_waits_for_other_motions_of_its_axis);
    tcase_add_test(all, nf6_while_other_axes_move);
    tcase_add_test(all, nf6_a_block_waits_for_a_spindle_axis);
    tcase_add_test(all, nf6_a_reference_waits_for_a_spindle_axis);
    tcase_add_test(all, nf6_central_annulment_ends_it);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
