/* SPDX-License-Identifier: MIT */
/* References of axes (NH1 to NH3): the examples W20 to W23, W51 of docs/CNC872.md. */
#include <stdlib.h>
#include <string.h>

#include "cnc_rig.h"

static const char null_minus_5[] = "<ChannelConfig><Axis Name=\"X\" MachineNullPoint=\"-5\"/><Axis Name=\"Y\"/></ChannelConfig>";

/* Switches of the machine: each is 1 in its range of the true position, mm. */
static struct {
    int64_t start; /* true position at power-up, u */
    int64_t zpr[2], kr[2], krr[2];
} machine;

static int64_t true_position(void)
{
    return machine.start + cnc.axis[0].actual;
}

static bool is_in(const int64_t range[2])
{
    return true_position() >= range[0] * MM && true_position() <= range[1] * MM;
}

static void drive_switches(uint64_t turn)
{
    (void)turn;
    set_bit("ZPRX", is_in(machine.zpr));
    set_bit("KRX", is_in(machine.kr));
    set_bit("KRRX", is_in(machine.krr));
}

static void begin_reference(const char *xml, int64_t start)
{
    rig_power(xml, "G1 X10 F1000");
    machine.start = start * MM;
    rig_script = drive_switches;
    set_cell("HOMING_START_REQ", 0, 1);
}

static void set_ranges(int64_t zpr0, int64_t zpr1, int64_t kr0, int64_t kr1, int64_t krr0, int64_t krr1)
{
    machine.zpr[0] = zpr0;
    machine.zpr[1] = zpr1;
    machine.kr[0] = kr0;
    machine.kr[1] = kr1;
    machine.krr[0] = krr0;
    machine.krr[1] = krr1;
}

/* Run until the state of X is this one. Returns the T. */
static uint64_t run_to_state(enum cnc_reference_state state)
{
    while (cnc.axis[0].reference.state != state) {
        ck_assert_uint_lt(cnc.turn, 3000);
        run_to(cnc.turn + 1);
    }
    return cnc.turn;
}

/* POS5 of X in nm, rounded towards 0. */
static int64_t pos5_nm(void)
{
    return cnc_position(&cnc, 0, 5) * 1000 / CNC_U_PER_UM;
}

START_TEST(w20_reference)
{
    begin_reference(null_minus_5, 20);
    set_ranges(-99, 3, -99, 0, -999, -900);
    run_to(1);
    ck_assert(bit("REFPI") && bit("PO_F") && !bit("AUTPI"));
    ck_assert_int_eq(at(1).x, 0);
    run_to(2);
    ck_assert_int_eq(at(2).x, -32768);
    ck_assert(bit("PO_OSXPI") && bit("SM_POXPI"));
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_STOP), 987);
    run_to(995);
    const int64_t before = cnc.axis[0].actual;
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 1);
    run_to(996);
    ck_assert_int_eq(cnc_position(&cnc, 0, 5), -329154560);
    ck_assert_int_eq(machine.start + before, -1747449);
    ck_assert_int_eq(cell("HOMING", 0), 1);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert(bit("REFPI") && bit("PO_F") && !bit("PO_OSXPI"));
    run_to(997); /* W51 */
    ck_assert(bit("REFPI") && !bit("PO_F"));
    ck_assert_uint_eq(count_events(CNC_EVENT_REFERENCE_DONE), 1);
}
END_TEST

START_TEST(w21_reversing_switch)
{
    begin_reference(null_minus_5, -5);
    set_ranges(-4, 3, -2, 0, -99, -10);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_TO_BACK), 185);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_BACK), 251);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_TO_SEARCH), 1140);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_SEARCH), 1149);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_STOP), 1160);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_NONE), 1169);
    ck_assert_int_eq(pos5_nm(), -5022500);
}
END_TEST

START_TEST(w22_begins_on_the_switch)
{
    begin_reference(null_minus_5, -1);
    set_ranges(-4, 3, -2, 0, -99, -10);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_BACK), 2);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_TO_SEARCH), 207);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_SEARCH), 216);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_STOP), 227);
    ck_assert_uint_eq(run_to_state(CNC_REFERENCE_NONE), 236);
    ck_assert_int_eq(pos5_nm(), -5022500);
}
END_TEST

START_TEST(nh2_reference_in_plus)
{
    begin_reference("<ChannelConfig><Axis Name=\"X\" RefDir=\"+\" MachineNullPoint=\"7\"/></ChannelConfig>", 0);
    set_ranges(99, 99, 5, 99, 999, 999);
    run_to(100);
    ck_assert_int_gt(at(100).x, 0);
    ck_assert(!bit("SM_POXPI"));
    const uint64_t seen = run_to_state(CNC_REFERENCE_STOP);
    const int64_t from = cnc.axis[0].reference.seen_at;
    run_to_state(CNC_REFERENCE_NONE);
    ck_assert_int_ge(at(seen - 1).x, 5 * MM); /* seen by the position at the end of the T before */
    ck_assert_int_lt(at(seen - 2).x, 5 * MM);
    ck_assert_int_eq(from, at(seen - 1).x);
    ck_assert_int_gt(cnc_position(&cnc, 0, 5), 7 * MM);
    ck_assert_int_lt(cnc_position(&cnc, 0, 5), 9 * MM);
    ck_assert_int_eq(cell("HOMING", 0), 1);
}
END_TEST

START_TEST(w23_position_given_by_the_plc)
{
    rig_power("<ChannelConfig><Axis Name=\"Y\" MachineNullPoint=\"100\" Offset1=\"1\"/></ChannelConfig>", NULL);
    set_cell("HOMING_REQ", 0, 2);
    set_cell("REFPOINT_DIST", 1, 5 * MM / 2);
    run_to(1);
    ck_assert_int_eq(cell("POSITION_POS5_EX", 1), 6717440000);
    ck_assert_int_eq(cell("POSITION_POS3_EX", 1), 6717440000 - MM); /* all spaces follow */
    ck_assert_int_eq(cell("B_POL", 1), 820000 - 8000);
    ck_assert_int_eq(cell("B_INK", 1), 0);
    ck_assert_int_eq(cell("HOMING", 0), 2);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 0);
    ck_assert(!bit("REFPI") && !bit("PO_F") && bit("INPOS")); /* NB8 */
}
END_TEST

START_TEST(nh1_a_position_waits_for_rest)
{
    rig_begin("G1 X10 F1000");
    run_to(100);
    set_cell("HOMING_REQ", 0, 1);
    run_to(200);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 1);
    set_bit("STOP_REQ", true);
    run_to(300);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 0);
    ck_assert_int_eq(cnc_position(&cnc, 0, 5), 0);
    cnc_start(&cnc);
    run_to(1100);
    ck_assert_int_eq(at(1100).x, 10 * MM); /* from the new position */
    set_cell("HOMING_REQ", 0, 1);
    set_cell("REFPOINT_DIST", 0, 200001 * MM);
    run_to(1101);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 0); /* refused: too far */
    ck_assert_int_eq(at(1101).x, 10 * MM);
    ck_assert_uint_eq(count_events(CNC_EVENT_REFERENCE_FAILED), 1);
    set_cell("HOMING_REQ", 0, 1);
    set_cell("REFPOINT_DIST", 0, -200001 * MM);
    run_to(1102);
    set_cell("HOMING_REQ", 0, 8); /* not in the configuration */
    run_to(1103);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 0);
    ck_assert_uint_eq(count_events(CNC_EVENT_REFERENCE_FAILED), 3);
    set_cell("REFPOINT_DIST", 0, -200000 * MM);
    set_cell("HOMING_REQ", 0, 1);
    run_to(1104);
    ck_assert_int_eq(at(1104).x, -200000 * MM);
}
END_TEST

/* An inner block of a section is in its INIT pass while the path moves. */
START_TEST(nh1_a_position_waits_for_the_end_of_a_section)
{
    rig_begin("G23 G1 X10 F1000\nX20\nX30");
    set_bit("EXT_PLC", true);
    set_bit("PLC_PASS_DONE", true);
    run_to(1000);
    ck_assert_uint_eq(at(1000).phase, CNC_DONE);
    set_cell("HOMING_REQ", 0, 1);
    run_to(1001);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 1);
    ck_assert_int_gt(at(1001).x, at(1000).x);
}
END_TEST

START_TEST(nh1_a_position_waits_for_a_manual_move)
{
    rig_power(NULL, NULL);
    cnc.panel.manual = true;
    cnc.panel.jog_plus = 1;
    run_to(100);
    set_cell("HOMING_REQ", 0, 1);
    set_cell("HOMING_START_REQ", 0, 1); /* as a reference does */
    cnc.panel.manual = false;
    run_to(150);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 1);
    ck_assert(!bit("REFPI"));
    run_to(168);
    ck_assert_int_eq(cell("HOMING_REQ", 0), 0);
    ck_assert(bit("REFPI"));
    ck_assert_int_eq(at(168).x, 0);
}
END_TEST

START_TEST(w51_stop_in_a_reference)
{
    begin_reference(null_minus_5, 20);
    set_ranges(-99, 3, -99, 0, -999, -900);
    run_to(99);
    set_bit("STOP_REQ", true);
    run_to(100);
    ck_assert_int_eq(at(98).x - at(99).x, 2184533);
    ck_assert_int_eq(at(99).x - at(100).x, 2151765);
    run_to(165);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 1);
    run_to(166);
    ck_assert_int_eq(at(166).x, at(165).x);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert(bit("PO_F") && !bit("PO_STOP"));
    run_to(167);
    ck_assert(!bit("PO_F") && !bit("PO_STOP"));
    ck_assert_int_eq(cell("HOMING", 0), 0);
    ck_assert_uint_eq(count_events(CNC_EVENT_REFERENCE_FAILED), 1);
}
END_TEST

START_TEST(nh2_ends_of_a_reference)
{
    static const struct {
        const char *bit;
        bool value;
        uint64_t rest;
    } ends[] = {{"STOP_EMERGENCY_REQ", true, 116}, {"KHX1", true, 116}};
    for (unsigned i = 0; i < 2; i++) {
        begin_reference(null_minus_5, 20);
        set_ranges(-99, 3, -99, 0, -999, -900);
        set_cell("HOMING", 0, 1);
        run_to(99);
        set_bit(ends[i].bit, ends[i].value);
        run_to(300);
        ck_assert_int_eq(at(300).x, at(ends[i].rest).x);
        ck_assert_int_ne(at(ends[i].rest - 1).x, at(ends[i].rest - 2).x);
        ck_assert_int_eq(cell("HOMING", 0), 1); /* as it was */
        ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
        ck_assert(!bit("PO_F"));
    }
}
END_TEST

START_TEST(nh2_enable_holds_a_reference)
{
    begin_reference(null_minus_5, 20);
    set_ranges(-99, 3, -99, 0, -999, -900);
    run_to(99);
    set_bit("MPXPI", false);
    run_to(200);
    ck_assert_int_eq(at(200).x, at(116).x);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 1);
    set_bit("MPXPI", true);
    run_to_state(CNC_REFERENCE_NONE);
    ck_assert_int_eq(pos5_nm(), -5022500);
}
END_TEST

START_TEST(nh2_several_axes_at_once)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 3);
    run_to(100);
    set_bit("KRX", true);
    run_to(500);
    ck_assert_int_eq(cell("HOMING", 0), 1);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 2);
    ck_assert(bit("PO_F") && !bit("PO_OSXPI") && bit("PO_OSYPI"));
    ck_assert_int_eq(cnc_start(&cnc), CNC_NO_PROGRAM);
    set_bit("KRY", true);
    run_to(1000);
    ck_assert_int_eq(cell("HOMING", 0), 3);
    ck_assert(!bit("PO_F"));
    ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK), 1);
    ck_assert_uint_eq(count_events(CNC_EVENT_BLOCK_END), 1);
}
END_TEST

START_TEST(nh2_a_stop_ends_the_references_of_all_axes)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 7);
    run_to(100);
    set_bit("STOP_REQ", true);
    run_to(300);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert(!bit("PO_F") && !bit("PO_OSXPI") && !bit("PO_OSYPI") && !bit("PO_OSZPI"));
    ck_assert_int_eq(at(300).y, at(200).y);
    ck_assert_int_eq(at(300).z, at(200).z);
}
END_TEST

/* Y searches, reverses, leaves its switch, and searches at FeedRef although ZPRY is 0. */
START_TEST(nh2_another_axis_reverses)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 2);
    set_bit("KRRY", true); /* it is on already: no edge */
    run_to(200);
    ck_assert_int_eq(at(199).y - at(200).y, 2184533); /* Feed */
    set_bit("KRRY", false);
    run_to(201);
    set_bit("KRRX", true); /* of another axis */
    set_bit("KRX", true);
    run_to(202);
    ck_assert_int_eq(cnc.axis[1].reference.state, CNC_REFERENCE_SEARCH);
    set_bit("KRRY", true);
    run_to(203);
    ck_assert_int_eq(cnc.axis[1].reference.state, CNC_REFERENCE_TO_BACK);
    run_to(500);
    ck_assert_int_eq(at(500).y - at(499).y, 2184533); /* back at Feed */
    ck_assert(!bit("SM_POYPI"));
    set_bit("KRRY", false); /* not looked at in BACK */
    run_to(501);
    set_bit("KRRY", true);
    run_to(502);
    set_bit("ZPRY", true);
    run_to(600);
    ck_assert_int_eq(at(600).y - at(599).y, 327680); /* FeedRef */
    set_bit("ZPRY", false);
    set_bit("KRY", true);
    run_to(650);
    ck_assert_int_eq(at(650).y - at(649).y, 327680);
    set_bit("KRY", false);
    run_to(800);
    ck_assert_int_eq(at(799).y - at(800).y, 327680);
    ck_assert(bit("SM_POYPI"));
    set_bit("KRY", true);
    run_to(900);
    ck_assert_int_eq(cell("HOMING", 0), 2);
}
END_TEST

START_TEST(nh2_bits_of_a_reference_after_a_block)
{
    rig_begin("G1 X1 F1000");
    run_to(150);
    ck_assert(bit("AUTPI") && bit("SF_BLOCKFINISHED"));
    set_cell("HOMING_START_REQ", 0, 2);
    run_to(200);
    ck_assert(!bit("AUTPI") && bit("REFPI") && !bit("SF_BLOCKFINISHED") && bit("SF_BLOCKINPROGR") && bit("SF_RUN"));
    cnc_reset(&cnc);
    run_to(400);
    ck_assert(bit("CAPI") && !bit("REFPI"));
    set_cell("HOMING_START_REQ", 0, 2);
    run_to(401);
    ck_assert(!bit("CAPI") && bit("REFPI"));
}
END_TEST

/* A new position changes no following error. */
START_TEST(nh1_following_error_stays)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" MachineNullPoint=\"50\" Lag=\"1000\"/></ChannelConfig>", "G1 X10 F1000");
    run_to(300);
    set_bit("STOP_REQ", true);
    run_to(399);
    const int64_t error = cnc.axis[0].position - cnc.axis[0].actual;
    set_cell("HOMING_REQ", 0, 1);
    run_to(400);
    ck_assert_int_eq(cnc_position(&cnc, 0, 5), 50 * MM);
    ck_assert_int_eq(cnc.axis[0].position - cnc.axis[0].actual, error - error / 1000);
    ck_assert_int_gt(error, MM);
}
END_TEST

START_TEST(nh2_waits_for_the_end_of_a_block)
{
    rig_begin("G1 X1 F1000");
    run_to(10);
    cnc_home(&cnc, 1);
    run_to(95);
    ck_assert(!bit("REFPI") && !bit("PO_F") && bit("HOMING_SINGLE"));
    run_to(200);
    ck_assert(bit("REFPI") && bit("PO_F"));
    ck_assert_int_lt(at(200).y, 0);
}
END_TEST

START_TEST(ne4_start_disable_drops_references)
{
    rig_power(NULL, NULL);
    set_bit("START_DISABLE", true);
    set_cell("HOMING_START_REQ", 0, 1);
    run_to(1);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert(!bit("PO_F"));
    ck_assert_int_eq(cnc_home(&cnc, 0), CNC_DISABLED);
    ck_assert_uint_eq(count_events(CNC_EVENT_REFERENCE_FAILED), 2);
    set_bit("START_DISABLE", false);
    set_cell("HOMING_START_REQ", 0, 8); /* not in the configuration */
    run_to(2);
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert(!bit("PO_F"));
}
END_TEST

START_TEST(nh3_key_home)
{
    rig_power("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"Y\" RefMethod=\"1\"/>"
              "<Axis Name=\"Z\" RefMethod=\"2\"/></ChannelConfig>",
              "G0 X1");
    ck_assert_int_eq(cnc_home(&cnc, 3), CNC_NO_AXIS);
    ck_assert_int_eq(cnc_home(&cnc, 16), CNC_NO_AXIS);
    ck_assert_int_eq(cnc_home(&cnc, 1), CNC_OK);
    ck_assert(bit("HOMING_PLC") && !bit("HOMING_GROUP") && !bit("HOMING_SINGLE"));
    ck_assert_int_eq(cnc_home(&cnc, 2), CNC_OK);
    ck_assert(bit("HOMING_GROUP"));
    run_to(10);
    ck_assert(!bit("REFPI"));
    ck_assert_int_eq(cnc_home(&cnc, 0), CNC_OK);
    ck_assert(bit("HOMING_SINGLE"));
    run_to(100);
    ck_assert(bit("HOMING_SINGLE") && bit("REFPI"));
    ck_assert_str_eq(cnc_result_text(cnc_start(&cnc)), "a reference is under way: PO_F is 1 until it has ended");
    set_bit("KRX", true);
    run_to(500);
    ck_assert(!bit("HOMING_SINGLE"));
    ck_assert_int_eq(cell("HOMING", 0), 1);
}
END_TEST

START_TEST(nb8_central_annulment_ends_a_reference)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 1);
    run_to(100);
    cnc_reset(&cnc);
    run_to(300);
    ck_assert(bit("CAPI") && !bit("REFPI") && !bit("PO_F"));
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert_int_eq(at(300).x, at(200).x);
    set_cell("HOMING_START_REQ", 0, 1);
    set_bit("EXT_PLC", true); /* it waits for the pass */
    run_to(310);
    ck_assert(bit("REFPI") && bit("PO_F"));
    cnc_reset(&cnc);
    run_to(320);
    set_bit("PLC_PASS_DONE", true);
    run_to(321);
    set_bit("PLC_PASS_DONE", true);
    run_to(330);
    ck_assert(!bit("PO_F") && bit("CAPI"));
    ck_assert_int_eq(cell("HOMING_START_REQ", 0), 0);
    ck_assert_int_eq(cnc.axis[0].reference.state, CNC_REFERENCE_NONE);
}
END_TEST

START_TEST(nb8_central_annulment_in_a_critical_error)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 1);
    run_to(100);
    cnc_set_critical(&cnc, 1);
    cnc_reset(&cnc);
    run_to(110);
    ck_assert(bit("CAPI") && !bit("PO_F"));
    ck_assert_int_eq(cell("BZH13", 0), 0);
    ck_assert_int_eq(cell("HOMING", 0), 0);
}
END_TEST

START_TEST(ns5_a_critical_error_halts_a_reference)
{
    rig_power(NULL, NULL);
    set_cell("HOMING_START_REQ", 0, 1);
    run_to(100);
    cnc_set_critical(&cnc, 1);
    run_to(200);
    ck_assert_int_eq(at(200).x, at(100).x);
    cnc_set_critical(&cnc, 0);
    run_to(201);
    ck_assert_int_eq(at(200).x - at(201).x, 32768); /* from rest */
    run_to(300);
    set_bit("KRX", true);
    run_to(301);
    cnc_set_critical(&cnc, 1);
    run_to(310);
    ck_assert_int_eq(cell("HOMING", 0), 0); /* nothing is known while there is an error */
    cnc_set_critical(&cnc, 0);
    run_to(311);
    ck_assert_int_eq(cell("HOMING", 0), 1);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("cnc_reference");
    TCase *all = tcase_create("reference");
    tcase_add_test(all, w20_reference);
    tcase_add_test(all, w21_reversing_switch);
    tcase_add_test(all, w22_begins_on_the_switch);
    tcase_add_test(all, nh2_reference_in_plus);
    tcase_add_test(all, w23_position_given_by_the_plc);
    tcase_add_test(all, nh1_a_position_waits_for_the_end_of_a_section);
    tcase_add_test(all, nh1_a_position_waits_for_a_manual_move);
    tcase_add_test(all, nb8_central_annulment_in_a_critical_error);
    tcase_add_test(all, nh1_a_position_waits_for_rest);
    tcase_add_test(all, w51_stop_in_a_reference);
    tcase_add_test(all, nh2_ends_of_a_reference);
    tcase_add_test(all, nh2_enable_holds_a_reference);
    tcase_add_test(all, nh2_several_axes_at_once);
    tcase_add_test(all, nh2_a_stop_ends_the_references_of_all_axes);
    tcase_add_test(all, nh2_another_axis_reverses);
    tcase_add_test(all, nh2_bits_of_a_reference_after_a_block);
    tcase_add_test(all, nh1_following_error_stays);
    tcase_add_test(all, nh2_waits_for_the_end_of_a_block);
    tcase_add_test(all, ne4_start_disable_drops_references);
    tcase_add_test(all, nh3_key_home);
    tcase_add_test(all, nb8_central_annulment_ends_a_reference);
    tcase_add_test(all, ns5_a_critical_error_halts_a_reference);
    suite_add_tcase(suite, all);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
