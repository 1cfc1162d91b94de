/* SPDX-License-Identifier: MIT */
/* Starts, stops, restarts and central annulments of a CNC872: worked examples of docs/CNC872.md (W...). */
#include "cnc_rig.h"

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
    ck_assert(bit("CAPI") && bit("SF_STOP") && !bit("PO_POL")); /* the target has not been reached */
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

/* NQ1, NA5: nothing has been moved yet by the block that is started again, and the axis stands elsewhere. */
START_TEST(a_restart_from_elsewhere_after_a_stop_in_the_first_pass)
{
    rig_begin("G1 X10 F1000");
    run_to(1);
    cnc_stop(&cnc);
    run_to(10);
    ck_assert(bit("PO_STOP"));
    set_cell("HOMING_REQ", 0, 1);
    set_cell("REFPOINT_DIST", 0, 4 * MM);
    run_to(11);
    ck_assert_int_eq(cnc.axis[0].position, 4 * MM);
    start_in(12);
    run_to(14);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Cont, 0), 1);
    run_to(1000);
    ck_assert(bit("SF_STOP"));
    ck_assert_int_eq(at(1000).x, 10 * MM);
    ck_assert_int_eq(at(13).x, 4 * MM + 32768);
}
END_TEST

/* PO_OSxPI stays 1 in a stop inside the block, and INIT of the restart can test it, whatever has moved the axis meanwhile. */
START_TEST(NE3_a_manual_move_in_a_stop_leaves_the_request_of_the_block)
{
    rig_begin_plc(NULL, "G1 X10 F1000",
                  "DATA\nSEEN BIT 0\nDATA_END\nMODULE_BLOCK_INIT\n LDR PO_OSXPI\n WR SEEN\nMODULE_BLOCK_INIT_END\n");
    run_to(100);
    cnc_stop(&cnc);
    run_to(200);
    ck_assert(bit("PO_STOP") && bit("PO_OSXPI") && bit("PO_OSX"));
    set_bit("AUTMAN_REQ", true);
    cnc.panel.jog_minus = 1 | 2;
    run_to(250);
    ck_assert(bit("PO_OSXPI") && bit("PO_OSX") && bit("PO_OSYPI") && !bit("PO_OSY"));
    cnc.panel.jog_minus = 0;
    run_to(400);
    ck_assert(bit("PO_OSXPI") && bit("PO_OSX") && !bit("PO_OSYPI"));
    set_bit("AUTMAN_REQ", false);
    set_bit("SEEN", false);
    run_to(401);
    start_in(402);
    run_to(404);
    ck_assert(bit("SEEN"));
    run_to(2000);
    ck_assert(!bit("PO_OSXPI") && !bit("PO_OSX") && bit("SF_STOP"));
    ck_assert_int_eq(at(2000).x, 10 * MM);
}
END_TEST

START_TEST(an_empty_program)
{
    rig_power(NULL, "; nothing");
    ck_assert_int_eq(cnc_start(&cnc), CNC_NO_PROGRAM);
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_NO_PROGRAM);
    run_to(5);
    ck_assert(!bit("PO_F"));
}
END_TEST

/* A port may have no place for events, and there may be no port. */
START_TEST(nobody_hears_events)
{
    static const struct cnc_port deaf = {NULL, NULL};
    for (unsigned i = 0; i < 2; i++) {
        rig_power(NULL, "G1 X1 F1000");
        cnc_begin(&cnc, &(struct cnc_setup){.config = &config, .program = &program, .port = i == 0 ? &deaf : NULL});
        ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
        ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
        run_to(200);
        ck_assert_int_eq(at(200).x, 1 * MM);
        ck_assert_uint_eq(rig_events, 0);
    }
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

START_TEST(a_reset_drops_a_start)
{
    rig_begin("G1 X1 F1000");
    cnc_reset(&cnc);
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_STOPPED);
    run_to(20);
    ck_assert(bit("CAPI") && !bit("PO_F"));
    ck_assert_int_eq(at(20).x, 0);
    ck_assert_str_eq(cnc_result_text(CNC_UNDER_WAY), "a block is under way");
}
END_TEST

START_TEST(an_axis_that_is_moved_before_the_motion)
{
    rig_begin_with("<ChannelConfig><Axis Name=\"X\" MachineNullPoint=\"1\"/></ChannelConfig>",
                   _i == 0 ? "G1 X1 F1000" : "G1 X1.5 F1000");
    run_to(1);
    ck_assert(bit("PO_OSXPI"));
    set_cell("HOMING_REQ", 0, 1);
    run_to(300);
    if (_i == 0) {
        ck_assert_uint_eq(first_reached(1), 2);
        ck_assert_uint_eq(first_end(1), 3);
        ck_assert_int_eq(at(300).x, 1 * MM);
    } else {
        ck_assert_int_eq(at(2).x, 1 * MM + 32768);
        ck_assert_int_eq(at(300).x, 3 * MM / 2);
    }
    ck_assert(!bit("PO_OSXPI"));
    ck_assert_int_eq(cnc_queue_number(&cnc, 1, CNC_QUEUE_Cont, 0), 0);
}
END_TEST

/* Move X by hand while a stop stands. */
static void move_by_hand(bool plus, uint64_t turns)
{
    const char *const key = plus ? "EXM_X0" : "EXM_X1";
    set_bit("AUTMAN_REQ", true);
    set_bit("REQ_EXT_CONT_AUTMAN", true);
    set_bit(key, true);
    run_to(cnc.turn + turns);
    set_bit(key, false);
    run_to(cnc.turn + 300);
    set_bit("AUTMAN_REQ", false);
    run_to(cnc.turn + 2);
}

START_TEST(NA5_a_restart_from_elsewhere)
{
    static const char *const nc[] = {"G1 X10 F1000", "G23 G1 X3 F1000\nX6 Y0.1\nX9 Y0.2", "G4 P1 X10 F1000 G1"};
    rig_begin(nc[_i]);
    run_to(_i == 1 ? 300 : 100);
    cnc_stop(&cnc);
    run_to(400);
    ck_assert(bit("PO_STOP") && bit("INPOS_STOP") && !bit("SF_STOPPOSCHANGED"));
    const int64_t x = cnc.axis[0].position;
    move_by_hand(_i == 1, 100);
    ck_assert_int_ne(cnc.axis[0].position, x);
    ck_assert(!bit("INPOS_STOP") && bit("SF_STOPPOSCHANGED"));
    const uint64_t turn = cnc.turn;
    start_in(turn + 1);
    run_to(turn + 2);
    ck_assert_int_eq(cnc_queue_number(&cnc, 0, CNC_QUEUE_Cont, 0), 1);
    run_to(turn + 4000);
    ck_assert_int_eq(cnc.axis[0].position, _i == 1 ? 9 * MM : 10 * MM);
    ck_assert_int_eq(cnc.axis[1].position, _i == 1 ? MM / 5 : 0);
    for (uint64_t t = turn + 2; t <= cnc.turn; t++) /* no jump */
        ck_assert_int_le(at(t).x > at(t - 1).x ? at(t).x - at(t - 1).x : at(t - 1).x - at(t).x, 1092267);
}
END_TEST

START_TEST(a_restart_from_elsewhere_after_a_stop_in_the_pass_of_a_restart)
{
    rig_begin("G1 X10 F1000");
    run_to(100);
    cnc_stop(&cnc);
    run_to(200);
    set_bit("EXT_PLC", true);
    start_in(201);
    run_to(205);
    cnc_stop(&cnc); /* INIT waits for the program outside */
    run_to(210);
    ck_assert(bit("PO_STOP"));
    move_by_hand(true, 100);
    set_bit("EXT_PLC", false);
    const uint64_t turn = cnc.turn;
    start_in(turn + 1);
    run_to(turn + 1000);
    ck_assert_int_eq(cnc.axis[0].position, 10 * MM);
    ck_assert_int_eq(at(turn + 1).x, at(turn).x);
    ck_assert_int_eq(at(turn + 2).x - at(turn + 1).x, 32768);
}
END_TEST

static Suite *start_suite(void)
{
    Suite *suite = suite_create("cnc_start");
    TCase *starts = tcase_create("starts");
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
    tcase_add_test(starts, a_restart_from_elsewhere_after_a_stop_in_the_first_pass);
    tcase_add_test(starts, NE3_a_manual_move_in_a_stop_leaves_the_request_of_the_block);
    tcase_add_test(starts, an_empty_program);
    tcase_add_test(starts, nobody_hears_events);
    tcase_add_test(starts, a_program_is_not_changed_under_way);
    tcase_add_test(starts, a_reset_drops_a_start);
    tcase_add_loop_test(starts, an_axis_that_is_moved_before_the_motion, 0, 2);
    tcase_add_loop_test(starts, NA5_a_restart_from_elsewhere, 0, 3);
    tcase_add_test(starts, a_restart_from_elsewhere_after_a_stop_in_the_pass_of_a_restart);
    suite_add_tcase(suite, starts);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(start_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
