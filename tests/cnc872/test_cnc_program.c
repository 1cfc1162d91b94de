/* SPDX-License-Identifier: MIT */
/* A PLC program in the T's of a CNC872: its passes hold the blocks, its events the starts (NT2, NE4, NB4 of docs/CNC872.md). */
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

START_TEST(W39_start_suspend)
{
    rig_begin_plc(NULL, "G1 X1 F1000",
                  "DATA\nIN BIT 0\nDATA_END\n"
                  "PROC_BEGIN _ON_EVENT\n FL 1,START_SUSPEND\nPROC_END _ON_EVENT\n"
                  "MODULE_MAIN\n LDR IN\n FL1 0,START_SUSPEND\nMODULE_MAIN_END\n");
    set_in(50, "IN", true);
    run_to(60);
    ck_assert(!at(49).po_f && at(50).po_f);
    ck_assert_int_eq(at(50).v, 0);
    ck_assert_int_gt(at(51).v, 0);
}
END_TEST

START_TEST(a_stop_drops_a_start_that_waits)
{
    rig_begin_plc(NULL, "G1 X1 F1000", "PROC_BEGIN _ON_EVENT\n FL 1,START_SUSPEND\nPROC_END _ON_EVENT\n");
    run_to(10);
    ck_assert(bit("START_SUSPEND") && !bit("PO_F"));
    cnc_stop(&cnc);
    run_to(11);
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_STOPPED);
    set_bit("START_SUSPEND", false);
    run_to(20);
    ck_assert(!bit("PO_F"));
}
END_TEST

/* A START that waits has been given for this program and this block: another one comes once a stop has dropped it. */
START_TEST(a_start_that_waits_keeps_its_program)
{
    rig_begin_plc(NULL, "G1 X1 F1000\nX2", "PROC_BEGIN _ON_EVENT\n FL 1,START_SUSPEND\nPROC_END _ON_EVENT\n");
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_STARTING);
    run_to(10);
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_STARTING);
    ck_assert_int_eq(cnc_select(&cnc, 1, true), CNC_STARTING);
    cnc_stop(&cnc);
    run_to(11);
    ck_assert_int_eq(cnc_select(&cnc, 1, true), CNC_OK);
    ck_assert_int_eq(cnc_load(&cnc, NULL), CNC_OK);
}
END_TEST

START_TEST(a_start_that_waits_is_disabled)
{
    rig_begin_plc(NULL, "G1 X1 F1000", "PROC_BEGIN _ON_EVENT\n FL 1,START_SUSPEND\nPROC_END _ON_EVENT\n");
    set_in(10, "START_DISABLE", true);
    set_in(20, "START_SUSPEND", false);
    run_to(30);
    ck_assert(!bit("PO_F"));
    ck_assert_int_eq(last_event(CNC_EVENT_START_REFUSED), CNC_DISABLED);
    ck_assert_uint_eq(count_events(CNC_EVENT_START_REFUSED), 1);
}
END_TEST

/* NF6, W35 as the program of 8.1.10 writes it: from 90 degrees on to 360. */
START_TEST(W35_a_spindle_axis_that_the_program_positions)
{
    rig_begin_plc("<ChannelConfig><Axis Name=\"X\"/><Axis Name=\"4\" Rotary=\"1\" FeedRT=\"1000000\" FeedRef=\"3600\"/>"
                  "</ChannelConfig>",
                  "G0 A4=90",
                  "DATA\nGO BIT 0\nDATA_END\nMODULE_MAIN\n LDR GO\n JL0 NO\n SPI_AX_X\n SPI_AX_4\n FL 0,GO\nNO:\n"
                  "MODULE_MAIN_END\n");
    run_to(2000);
    ck_assert_int_eq(cnc.axis[3].position, 90 * MM);
    set_bit("GO", true);
    run_to(2001);
    ck_assert(bit("POLOHV_4") && !bit("POLOHV_X"));
    run_to(2000 + 4618);
    ck_assert(bit("POLOHV_4"));
    run_to(2000 + 4619);
    ck_assert_int_eq(cnc.axis[3].position, 360 * MM);
    ck_assert(!bit("POLOHV_4"));
    set_bit("GO", true);
    run_to(2000 + 4620);
    ck_assert(!bit("POLOHV_4"));
}
END_TEST

START_TEST(MODULE_INIT_before_the_first_T)
{
    rig_power_plc(NULL, NULL, "MODULE_INIT\n FL 0,MPXPI\nMODULE_INIT_END\n");
    ck_assert(!bit("MPXPI") && !bit("MPX") && bit("MPY"));
}
END_TEST

static const char waits[] = "DATA\nIN BIT 0\nOUT BIT 0\nPASSES DW 0\nDATA_END\n"
                            "MODULE_BLOCK_INIT\n LOD PASSES\n AD CNST.1\n STO PASSES\n EX\n LDR IN\n EX0\nMODULE_BLOCK_INIT_END\n"
                            "MODULE_BLOCK_DONE\n LDR OUT\n EX0\nMODULE_BLOCK_DONE_END\n";

START_TEST(passes_hold_the_block)
{
    rig_begin_plc(NULL, "G1 X1 F1000", waits);
    set_in(50, "IN", true);
    run_to(300);
    ck_assert_int_eq(at(49).v, 0);
    ck_assert_int_gt(at(50).v, 0);
    ck_assert_uint_eq(first_reached(1), 142);
    ck_assert(bit("PO_F"));
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_DONE);
    set_bit("OUT", true);
    run_to(301);
    ck_assert(!bit("PO_F"));
}
END_TEST

START_TEST(a_restart_passes_from_the_beginning)
{
    rig_begin_plc(NULL, "G1 X1 F1000", waits);
    run_to(10);
    ck_assert_int_eq(cell("PASSES", 0), 1);
    cnc_stop(&cnc);
    run_to(20);
    ck_assert(bit("PO_STOP"));
    start_in(30);
    run_to(40);
    ck_assert_int_eq(cell("PASSES", 0), 2);
    set_bit("IN", true);
    run_to(60);
    cnc_stop(&cnc);
    run_to(100);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_gt(at(100).x, 0);
    start_in(101);
    run_to(300);
    ck_assert_int_eq(cell("PASSES", 0), 3);
    ck_assert_int_eq(at(300).x, 1 * MM);
}
END_TEST

START_TEST(a_stop_in_the_closing_pass)
{
    rig_begin_plc(NULL, "M3", waits);
    set_in(5, "IN", true);
    run_to(10);
    cnc_stop(&cnc);
    run_to(20);
    ck_assert(bit("PO_STOP"));
    ck_assert_int_eq(cell("STATUS_RESTART", 0), CNC_DONE);
    set_bit("OUT", true); /* the pass goes on, the block does not */
    run_to(30);
    ck_assert(bit("PO_F") && bit("PO_STOP"));
    start_in(31);
    run_to(31);
    ck_assert(!bit("PO_F") && !bit("BLOCK_RESTART"));
    ck_assert_int_eq(cell("PASSES", 0), 1);
}
END_TEST

START_TEST(text_and_program_outside)
{
    rig_power_plc(NULL, "M3", waits);
    set_bit("EXT_PLC", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    set_in(5, "PLC_PASS_DONE", true);
    run_to(10);
    ck_assert(!bit("PLC_PASS_DONE"));
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_INIT); /* the text is not through */
    set_bit("IN", true);
    run_to(11);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_DONE);
    set_bit("OUT", true);
    run_to(20);
    ck_assert(bit("PO_F"));
    set_bit("PLC_PASS_DONE", true);
    run_to(21);
    ck_assert(!bit("PO_F"));
    ck_assert_int_eq(cell("PASSES", 0), 1);
    rig_power_plc(NULL, "M3", waits); /* the text is through first: it is not passed again */
    set_bit("EXT_PLC", true);
    set_bit("IN", true);
    ck_assert_int_eq(cnc_start(&cnc), CNC_OK);
    run_to(50);
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_INIT);
    ck_assert_int_eq(cell("PASSES", 0), 1);
}
END_TEST

START_TEST(annulment_in_the_closing_pass)
{
    rig_begin_plc(NULL, "M3\nM5", waits);
    set_in(5, "IN", true);
    run_to(10);
    cnc_reset(&cnc);
    run_to(11);
    ck_assert(bit("CAPI") && bit("PO_F"));
    ck_assert_int_eq(cell("PLC_PASS", 0), CNC_DONE); /* it runs on as the annulment's */
    set_bit("OUT", true);
    run_to(12);
    ck_assert(!bit("PO_F") && bit("SF_STOP"));
    ck_assert_uint_eq(cnc.machine.next, 0);
}
END_TEST

START_TEST(reading_beyond_the_queue)
{
    rig_power_plc(NULL, "M3",
                  "DATA\nV DD 7\nDATA_END\nMODULE_MAIN\n LOD BLK[9].T\n STO V\n LOD BLK[10].T\nMODULE_MAIN_END\n");
    run_to(3);
    ck_assert_int_eq(cell("V", 0), 0);
    ck_assert_uint_eq(count_events(CNC_EVENT_BEYOND_QUEUE), 3); /* one a T */
    ck_assert_uint_eq(cnc.beyond_queue, 6);
    rig_power_plc(NULL, "M3", "DATA\nV DD 7\nDATA_END\nMODULE_MAIN\n LOD BLK[1].T\n STO V\nMODULE_MAIN_END\n");
    run_to(3);
    ck_assert_int_eq(cell("V", 0), 0);
    ck_assert_uint_eq(cnc.beyond_queue, 0);
    ck_assert_uint_eq(rig_events, 0);
}
END_TEST

START_TEST(events_of_the_program)
{
    rig_power_plc(NULL, "M3", "MODULE_MAIN\n LOD CNST.5\n ESET\n DIVB CNST.0\nMODULE_MAIN_END\n");
    run_to(1);
    ck_assert_int_eq(last_event(CNC_EVENT_PLC_ERROR), 5);
    ck_assert_int_eq(last_event(CNC_EVENT_PLC_DIVISION), 4);
    rig_begin_plc(NULL, "G1 X1 F1000", "DATA\nIN BIT 0\nDATA_END\nMODULE_MAIN\n LDR IN\n JL0 E\nA: JUM A\nE:\nMODULE_MAIN_END\n");
    set_in(20, "IN", true);
    run_to(100);
    ck_assert_int_eq(last_event(CNC_EVENT_PLC_FAULT), 7);
    ck_assert_uint_eq(count_events(CNC_EVENT_PLC_FAULT), 1);
    ck_assert(bit("PO_STOP"));
}
END_TEST

static Suite *program_suite(void)
{
    Suite *suite = suite_create("cnc_program");
    TCase *all = tcase_create("all");
    tcase_add_test(all, W39_start_suspend);
    tcase_add_test(all, a_stop_drops_a_start_that_waits);
    tcase_add_test(all, a_start_that_waits_keeps_its_program);
    tcase_add_test(all, a_start_that_waits_is_disabled);
    tcase_add_test(all, W35_a_spindle_axis_that_the_program_positions);
    tcase_add_test(all, MODULE_INIT_before_the_first_T);
    tcase_add_test(all, passes_hold_the_block);
    tcase_add_test(all, a_restart_passes_from_the_beginning);
    tcase_add_test(all, a_stop_in_the_closing_pass);
    tcase_add_test(all, text_and_program_outside);
    tcase_add_test(all, annulment_in_the_closing_pass);
    tcase_add_test(all, reading_beyond_the_queue);
    tcase_add_test(all, events_of_the_program);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(program_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
