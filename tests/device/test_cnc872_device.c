/* SPDX-License-Identifier: MIT */
/* test_cnc872_device.c: the CNC872 through the seam: methods, conditions, recordings, snapshots, scenarios. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "fake_rig.h"
#include "record/record.h"
#include "trace/trace.h"

static struct fake_rig rig;

static void begin(void)
{
    fake_rig_begin_as(&rig, &cnc872_device, NULL, "1", true);
}

static void end(void)
{
    fake_rig_end(&rig);
}

static void expect_result(const char *method, const char *params, const char *wanted)
{
    fake_rig_expect_result(&rig, method, params, wanted);
}

/* Advance to the end of T number k. */
static void do_turns(uint64_t k)
{
    sim_advance(&rig.sim, k * 1000 + 1);
}

/* ---- Cells and panel ------------------------------------------------------------------------------------------------ */

START_TEST(NL1_W2_a_block_is_loaded_started_and_followed_by_its_cells)
{
    expect_result("cnc.load", "{\"text\": \"G1 X10 F1000\"}", "\"blocks\":1");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(1);
    expect_result("cnc.get", "{\"cells\": [\"PO_F\", \"po_osxpi\"]}", "{\"t\":1,\"cells\":{\"PO_F\":1,\"po_osxpi\":1}}");
    do_turns(2);
    expect_result("cnc.get", "{\"cells\": [\"B_INK_EX[0]\"]}", "32768");
    do_turns(634);
    expect_result("cnc.get", "{\"cells\": [\"B_INK_EX[0]\", \"PO_POL\"]}", "{\"B_INK_EX[0]\":655360000,\"PO_POL\":1}");
    fake_rig_expect_state(&rig, "motors.0.position", "10000");
    do_turns(635);
    expect_result("cnc.get", "{\"cells\": [\"PO_F\"]}", "{\"PO_F\":0}");
}
END_TEST

START_TEST(NL5_bad_access_is_refused_and_nothing_is_set)
{
    fake_rig_expect_refusal(&rig, "cnc.get", "{\"cells\": [\"PO_G\"]}", "`PO_G'");
    fake_rig_expect_refusal(&rig, "cnc.get", "{\"cells\": \"PO_F\"}", "expected a list");
    fake_rig_expect_refusal(&rig, "cnc.get", "{\"cells\": [1]}", "expected names");
    fake_rig_expect_refusal(&rig, "cnc.get", "{\"cells\": [\"CNST.1\"]}", "not a constant");
    fake_rig_expect_refusal(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 1, \"PO_F\": 1}}", "PO_F may only be read");
    fake_rig_expect_refusal(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 1, \"BLK[0].M3\": 1}}", "may only be read");
    fake_rig_expect_refusal(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 256}}", "from 0 to 255");
    fake_rig_expect_refusal(&rig, "cnc.set", "{\"cells\": {\"MPXPI\": 2}}", "from 0 to 1");
    fake_rig_expect_refusal(&rig, "cnc.set", "{\"cells\": {\"rAxGParabAccel\": \"1\"}}", "expected a number");
    expect_result("cnc.get", "{\"cells\": [\"BZH09\"]}", "{\"BZH09\":0}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"WORD.BZH09\": 1500, \"rAxGParabAccel\": 2.5, \"FEED_OVR\": true}}");
    expect_result("cnc.get", "{\"cells\": [\"BZH09\", \"BZH10\", \"rAxGParabAccel\", \"FEED_OVR\"]}",
                  "{\"BZH09\":220,\"BZH10\":5,\"rAxGParabAccel\":2.5,\"FEED_OVR\":1}");
}
END_TEST

START_TEST(NL1_the_panel_refuses_as_a_whole_with_the_reason)
{
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"start\": true, \"feed\": 50}", "no NC program is loaded");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"feed\": 50, \"jog\": {\"4\": \"+\"}}", "no axis `4'");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"feed\": 201}", "from 0 to 200");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"fed\": 20}", "unknown parameter `fed'");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"mode\": \"auto\"}", "\"aut\" or \"manual\"");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"start\": false}", "start: expected true");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"keys\": {\"P3\": 1}}", "`P3' is unknown");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"home\": \"4\"}", "configured axis");
    expect_result("cnc.state", "{}", "\"feed\":100");
    fake_rig_do(&rig, "cnc.panel", "{\"feed\": 50, \"mode\": \"manual\", \"jog\": {\"X\": \"+\"}, \"rapid\": true}");
    do_turns(500);
    expect_result("cnc.state", "{}", "\"state\":\"manual\"");
    fake_rig_do(&rig, "cnc.panel", "{\"jog\": {\"X\": \"\"}}");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"text\": \"G1 X\"}", "nc:1:");
    fake_rig_expect_refusal(&rig, "cnc.load", "{}", "text: expected an NC program");
}
END_TEST

/* A window shows a state when it differs from the last one: that of a cnc at rest has no time in it but that of the line. */
START_TEST(the_state_of_a_cnc_changes_as_its_panel_does_and_not_by_itself)
{
    json_t *before = fake_rig_command(&rig, "state", "{}");
    do_turns(100);
    json_t *after = fake_rig_command(&rig, "state", "{}");
    ck_assert(json_equal(json_object_get(before, "cnc"), json_object_get(after, "cnc")));
    json_decref(before);
    json_decref(after);
    expect_result("cnc.state", "{}", "\"t\":100");
    fake_rig_expect_state(&rig, "cnc.panel.jog", "{}");
    fake_rig_do(&rig, "cnc.panel", "{\"jog\": {\"X\": \"+\", \"Z\": \"-\"}}");
    fake_rig_expect_state(&rig, "cnc.panel.jog", "{\"X\":\"+\",\"Z\":\"-\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"jog\": {\"X\": \"\"}}");
    fake_rig_expect_state(&rig, "cnc.panel.jog", "{\"Z\":\"-\"}");
}
END_TEST

START_TEST(NL1_a_refused_start_selects_no_block)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X1 F1000\\nG1 X2\\nG1 X3\"}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"START_DISABLE\": 1}}");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"select\": 2, \"start\": true}", "START_DISABLE");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"select\": 2, \"home\": \"X\"}", "START_DISABLE");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"START_DISABLE\": 0}}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(1);
    expect_result("cnc.state", "{}", "\"block\":0,\"line\":1");
}
END_TEST

START_TEST(NL2_conditions_name_cells)
{
    struct refusal refusal;
    json_t *json = json_loads("{\"cell\": {\"PO_POL\": 1, \"B_INK_EX[0]\": {\">=\": 655360000}}}", 0, NULL);
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X10 F1000\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    struct condition *condition = condition_read(&rig.sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s", refusal.text);
    condition_arm(condition);
    ck_assert(condition_run(condition, 10000000));
    ck_assert_uint_eq(sim_now(&rig.sim), 634001); /* W2 */
    char *text = condition_wanted_text(condition);
    ck_assert_msg(strstr(text, "cell PO_POL == 1 and cell B_INK_EX[0] >= 655360000"), "%s", text);
    free(text);
    condition_free(condition);
    json_decref(json);
    json = json_loads("{\"cell\": {\"PO_G\": 1}}", 0, NULL);
    ck_assert_ptr_null(condition_read(&rig.sim, json, &refusal));
    ck_assert_msg(strstr(refusal.text, "`PO_G'"), "%s", refusal.text);
    json_decref(json);
    json = json_loads("{\"cell\": {\"rAxGParabAccel\": 1}}", 0, NULL);
    ck_assert_ptr_null(condition_read(&rig.sim, json, &refusal));
    json_decref(json);
}
END_TEST

/* ---- What is kept --------------------------------------------------------------------------------------------------- */

START_TEST(recording_of_a_cnc_replays)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&rig.sim, out);
    ck_assert_ptr_nonnull(record);
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X1 Y-0.5 F1000\\nG0 X0\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(60);
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"STOP_REQ\": 1}}");
    do_turns(100);
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true, \"feed\": 70}");
    sim_advance(&rig.sim, 1000000);
    fake_rig_expect_state(&rig, "motors.1.position", "-500");
    ck_assert_int_eq(record_end(record), 0);
    fclose(out);
    FILE *in = fmemopen(text, length, "r");
    struct replay *replay = replay_open("test.record", in);
    ck_assert_int_eq(replay_run(replay, NULL, NULL), REPLAY_SAME);
    replay_free(replay);
    fclose(in);
    free(text);
}
END_TEST

START_TEST(snapshot_of_a_cnc_goes_on_as_before)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X10 F1000\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(100);
    fake_rig_do(&rig, "snapshot", "{\"name\": \"half\"}");
    do_turns(300);
    fake_rig_do(&rig, "cnc.panel", "{\"reset\": true}");
    do_turns(400);
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G0 Y5\"}");
    fake_rig_do(&rig, "restore", "{\"name\": \"half\"}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 534000);
    expect_result("cnc.get", "{\"cells\": [\"PO_POL\", \"B_INK_EX[0]\"]}", "{\"PO_POL\":1,\"B_INK_EX[0]\":655360000}");
}
END_TEST

START_TEST(NU1_scenario_of_a_cnc)
{
    run_story("device: cnc872\nsteps:\n"
              "  - call: cnc.load\n    params: {text: G1 X1 F1000}\n"
              "  - call: cnc.panel\n    params: {start: true}\n"
              "  - wait: {cell: {PO_POL: 1}}\n    within: 1s\n"
              "  - expect: {motor: 1, position: 1000}\n"
              "  - call: cnc.get\n    params: {cells: [B_INK]}\n    result: {cells: {B_INK: 8000}}\n",
              SCENARIO_PASSED, NULL);
    run_story("device: cnc872\nsteps:\n  - expect: {cell: {PO_F: 1}}\n", SCENARIO_FAILED, "cell PO_F == 1");
    run_story("device: cnc872\nsteps:\n  - bytes: '04'\n", SCENARIO_FAILED, "has no bus");
    run_story("device: rkm04\nsteps:\n  - expect: {cell: {PO_F: 1}}\n", SCENARIO_FAILED, "the device rkm04 has no cells");
}
END_TEST

#define LOAD_AND_START "device: cnc872\nsteps:\n  - call: cnc.load\n    params: {text: G1 X10 F1000}\n" \
                       "  - call: cnc.panel\n    params: {start: true}\n"

/* W8: STOP_REQ acts in T 200, at rest in T 216. */
START_TEST(NL1_W8_a_scenario_exchanges_cells_cycle_by_cycle)
{
    run_story(LOAD_AND_START
              "  - call: cnc.exchange\n    params: {slots: 199, get: [PO_F]}\n    result: {t: 199, cells: {PO_F: 1}}\n"
              "  - call: cnc.exchange\n    params: {set: {STOP_REQ: 1}, get: [STOP_REQ]}\n"
              "    result: {t: 200, cells: {STOP_REQ: 0}}\n"
              "  - call: cnc.exchange\n    params: {slots: 15, get: [PO_STOP]}\n    result: {cells: {PO_STOP: 0}}\n"
              "  - call: cnc.exchange\n    params: {get: [PO_STOP]}\n    result: {t: 216, cells: {PO_STOP: 1}}\n"
              "  - call: cnc.exchange\n    params: {slots: 0, get: [B_INK_EX]}\n"
              "    result: {t: 216, cells: {B_INK_EX: 207170098}}\n"
              "  - expect: {cell: {PO_STOP: 1}}\n",
              SCENARIO_PASSED, NULL);
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {get: [PO_F]}\n    result: {cells: {PO_F: 0}}\n",
              SCENARIO_FAILED, "expected cells {\"PO_F\":0} in the result, seen cells {\"PO_F\":1} in the result");
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {set: {PO_F: 1}}\n", SCENARIO_FAILED, "PO_F may only be read");
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {get: [PO_G]}\n", SCENARIO_FAILED, "`PO_G'");
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {slots: 3600001}\n", SCENARIO_FAILED, "slots");
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {T: 1}\n", SCENARIO_FAILED, "T");
    run_story(LOAD_AND_START "  - power: off\n  - call: cnc.exchange\n", SCENARIO_FAILED, "no power");
    run_story(LOAD_AND_START "stimuli:\n  - at: 5ms\n    call: cnc.exchange\n", SCENARIO_FAILED, "takes no time");
}
END_TEST

/* What the exchange must hold always, and what comes meanwhile, as with any other time. */
START_TEST(NL1_an_exchange_of_a_scenario_is_time_like_other_time)
{
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {slots: 700}\nalways:\n  - cell: {PO_POL: 0}\n",
              SCENARIO_FAILED, "always cell PO_POL == 0");
    run_story(LOAD_AND_START "  - call: cnc.exchange\n    params: {slots: 300, get: [PO_STOP]}\n"
                             "    result: {t: 300, cells: {PO_STOP: 1}}\n"
                             "stimuli:\n  - at: 100ms\n    call: cnc.set\n    params: {cells: {STOP_REQ: 1}}\n",
              SCENARIO_PASSED, NULL);
}
END_TEST

/* ---- A PLC program of its own --------------------------------------------------------------------------------------- */

START_TEST(NU3_the_cells_of_a_plc_program_are_cells_like_others)
{
    static const char plc[] = "plc=DATA\nCOUNT DW 0\nREADY BIT 0\nDATA_END\n"
                              "MODULE_MAIN\n LOD WORD.COUNT\n AD CNST.1\n STO WORD.COUNT\n"
                              " LDR READY\n WR MPXPI\nMODULE_MAIN_END\n";
    struct device_config config = {.node = 1};
    char error[DEVICE_ERROR_SIZE];
    fake_rig_end(&rig);
    fake_rig_begin_as(&rig, &cnc872_device, plc, "1", true);
    do_turns(7);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\", \"MPXPI\"]}", "{\"COUNT\":7,\"MPXPI\":0}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"READY\": 1}}");
    do_turns(8);
    expect_result("cnc.get", "{\"cells\": [\"MPXPI\"]}", "{\"MPXPI\":1}");
    json_t *text = json_string("MODULE_MAIN\n TIM 3\nMODULE_MAIN_END\n");
    ck_assert(!cnc872_device.read_setting(&config, "plc", text, error));
    ck_assert_msg(strstr(error, "plc:2:"), "%s", error);
    json_decref(text);
}
END_TEST

START_TEST(NL3_mechanisms_of_a_plc_program_are_found)
{
    static const char plc[] = "plc=DATA\nREADY BIT 0\nLIMIT EQU 5\nDATA_END\nMODULE_MAIN\n  Mech_Begin CLAMP\n EX\n"
                              "MECH_END CLAMP\nHERE: MECH_BEGIN DOOR\n EX\nMECH_END DOOR\nMODULE_MAIN_END\n";
    fake_rig_end(&rig);
    fake_rig_begin_as(&rig, &cnc872_device, plc, "1", true);
    expect_result("cnc.cells", "{\"section\": \"mechanism\"}",
                  "{\"cells\":[{\"name\":\"CLAMP\",\"type\":\"BIT\",\"access\":\"rw\",\"section\":\"mechanism\"},"
                  "{\"name\":\"DOOR\",\"type\":\"BIT\",\"access\":\"rw\",\"section\":\"mechanism\"}],\"more\":0}");
    expect_result("cnc.cells", "{\"search\": \"\", \"section\": \"program\"}",
                  "{\"cells\":[{\"name\":\"READY\",\"type\":\"BIT\",\"access\":\"rw\",\"section\":\"program\"}],\"more\":0}");
    fake_rig_expect_refusal(&rig, "cnc.cells", "{\"section\": 8}", "section: expected its name");
}
END_TEST

START_TEST(NL1_a_real_that_is_no_number_is_null)
{
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"QWRD.rAxGParabAccel\": 9221120237041090560}}"); /* NaN */
    expect_result("cnc.get", "{\"cells\": [\"rAxGParabAccel\", \"PO_F\"]}", "{\"rAxGParabAccel\":null,\"PO_F\":0}");
}
END_TEST

START_TEST(NO3_the_backup_memory_outlives_power)
{
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"PLC_MEM_BACKUP[9999]\": 7, \"REQ_BACKUP_MEM\": 1}}");
    do_turns(1);
    expect_result("cnc.get", "{\"cells\": [\"REQ_BACKUP_MEM\"]}", "{\"REQ_BACKUP_MEM\":0}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"PLC_MEM_BACKUP[0]\": 1}}");
    fake_rig_do(&rig, "reset", "{}"); /* no regular end */
    expect_result("cnc.get", "{\"cells\": [\"PLC_MEM_BACKUP[9999]\", \"PLC_MEM_BACKUP[0]\"]}",
                  "{\"PLC_MEM_BACKUP[9999]\":7,\"PLC_MEM_BACKUP[0]\":0}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"PLC_MEM_BACKUP[0]\": 2}}");
    sim_store(&rig.sim); /* a regular end */
    fake_rig_do(&rig, "reset", "{}");
    expect_result("cnc.get", "{\"cells\": [\"PLC_MEM_BACKUP[9999]\", \"PLC_MEM_BACKUP[0]\"]}",
                  "{\"PLC_MEM_BACKUP[9999]\":7,\"PLC_MEM_BACKUP[0]\":2}");
}
END_TEST

START_TEST(NL2_the_cnc_tells_what_happens)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"\\nG1 X1 F1000\"}");
    fake_rig_seen(&rig);
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(200);
    const char *seen = fake_rig_seen(&rig);
    ck_assert_msg(strncmp(seen, "1000 unit 1 motor 0 note the block of line 2 begins\n2000 unit 1 motor 1 motion 1\n", 78) == 0,
                  "%s", seen);
    ck_assert_ptr_nonnull(strstr(seen, " note the block of line 2 has ended\n"));
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"home\": \"Y\", \"start\": true, \"rtm\": 300}", "rtm");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"START_DISABLE\": 1}}");
    fake_rig_expect_refusal(&rig, "cnc.panel", "{\"start\": true}", "START_DISABLE is 1");
    do_turns(201);
    ck_assert_str_eq(fake_rig_seen(&rig), "200001 unit 1 motor 0 note start refused: START_DISABLE is 1\n");
}
END_TEST

/* The clock of the cnc goes on while nothing moves. */
START_TEST(NL2_conditions_see_cells_that_change_while_nothing_happens)
{
    struct refusal refusal;
    json_t *json = json_loads("{\"cell\": {\"SYST_TIME_INFO.TIME_SEC\": 5}}", 0, NULL);
    do_turns(10);
    struct condition *condition = condition_read(&rig.sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s", refusal.text);
    condition_arm(condition);
    ck_assert(condition_run(condition, 60000000));
    ck_assert_uint_eq(sim_now(&rig.sim), 5000001);
    condition_free(condition);
    json_decref(json);
}
END_TEST

START_TEST(NL3_cells_are_found_by_a_part_of_their_name)
{
    expect_result("cnc.cells", "{\"search\": \"po_pol\"}",
                  "{\"cells\":[{\"name\":\"PO_POL\",\"type\":\"BIT\",\"access\":\"r\",\"section\":\"8.1.15\"}],\"more\":0}");
    /* Of axes those that the configuration has. */
    expect_result("cnc.cells", "{\"search\": \"PLC_MEM\"}", "\"name\":\"PLC_MEM_BACKUP[0]\"");
    expect_result("cnc.cells", "{\"search\": \"difcit\", \"limit\": 2}", "\"name\":\"DIFCIT_X[1]\"");
    expect_result("cnc.cells", "{\"search\": \"difcit\", \"limit\": 2}", "\"more\":1}");
    expect_result("cnc.cells", "{\"search\": \"VAZBA_\", \"limit\": 2}", "\"name\":\"VAZBA_X\"");
    expect_result("cnc.cells", "{\"search\": \"TOC_ROW\"}", "\"name\":\"DISPTOC1.TOC_ROW\",\"type\":\"BYTE\",\"access\":\"rw\"");
    expect_result("cnc.cells", "{\"search\": \"BLK[0].AxNC0\"}", "\"access\":\"r\"");
    fake_rig_expect_refusal(&rig, "cnc.cells", "{\"search\": 1}", "search: expected a part of a name");
    fake_rig_expect_refusal(&rig, "cnc.cells", "{\"limit\": 0}", "limit: expected a whole number from 1 to 1000");
    /* Each name is one that cnc.get takes. */
    size_t at;
    json_t *cell, *found = fake_rig_command(&rig, "cnc.cells", "{\"limit\": 1000}");
    ck_assert_int_eq(json_integer_value(json_object_get(found, "more")), 0);
    ck_assert_uint_gt(json_array_size(json_object_get(found, "cells")), 300);
    json_array_foreach(json_object_get(found, "cells"), at, cell) {
        char params[100];
        snprintf(params, sizeof params, "{\"cells\": [\"%s\"]}", json_string_value(json_object_get(cell, "name")));
        json_decref(fake_rig_command(&rig, "cnc.get", params));
    }
    json_decref(found);
}
END_TEST

/* The names of the kinds of faults, as {"kinds": [{"kind": NAME, ...}]} has them. */
static void expect_kinds(const char *wanted)
{
    char names[200] = "";
    size_t at;
    json_t *kind, *result = fake_rig_command(&rig, "fault.kinds", "{}");
    json_array_foreach(json_object_get(result, "kinds"), at, kind) {
        strncat(names, json_string_value(json_object_get(kind, "kind")), sizeof names - strlen(names) - 1u);
        strncat(names, " ", sizeof names - strlen(names) - 1u);
    }
    ck_assert_str_eq(names, wanted);
    json_decref(result);
}

START_TEST(NU1_a_cnc_has_neither_bus_nor_inputs_nor_steps)
{
    expect_result("device", "{}", "\"bus\":false,\"plant\":false,\"cells\":true");
    expect_kinds("flash power ");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"drop\"}", "drop: the device cnc872 has no bus");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"cable\"}", "cable: the device cnc872 has no bus");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": 1, \"level\": 1}",
                            "input: the device cnc872 has no inputs");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"flash\"}");
    fake_rig_expect_refusal(&rig, "plant.set", "{\"plant\": {\"motors\": {\"1\": {\"turn\": 400}}}}",
                            "the axes of a cnc872 make no steps that a plant could follow");
    fake_rig_do(&rig, "plant.set", "{\"plant\": null}");
    fake_rig_end(&rig);
    fake_rig_begin(&rig, "1", true);
    expect_result("device", "{}", "\"bus\":true,\"plant\":true,\"cells\":false");
}
END_TEST

static Suite *cnc872_device_suite(void)
{
    Suite *suite = suite_create("cnc872_device");
    TCase *tests = tcase_create("cnc872");
    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, NL1_W2_a_block_is_loaded_started_and_followed_by_its_cells);
    tcase_add_test(tests, NL5_bad_access_is_refused_and_nothing_is_set);
    tcase_add_test(tests, NL1_the_panel_refuses_as_a_whole_with_the_reason);
    tcase_add_test(tests, the_state_of_a_cnc_changes_as_its_panel_does_and_not_by_itself);
    tcase_add_test(tests, NL1_a_refused_start_selects_no_block);
    tcase_add_test(tests, NL2_conditions_name_cells);
    tcase_add_test(tests, recording_of_a_cnc_replays);
    tcase_add_test(tests, snapshot_of_a_cnc_goes_on_as_before);
    tcase_add_test(tests, NU1_scenario_of_a_cnc);
    tcase_add_test(tests, NL1_W8_a_scenario_exchanges_cells_cycle_by_cycle);
    tcase_add_test(tests, NL1_an_exchange_of_a_scenario_is_time_like_other_time);
    tcase_add_test(tests, NU3_the_cells_of_a_plc_program_are_cells_like_others);
    tcase_add_test(tests, NL2_conditions_see_cells_that_change_while_nothing_happens);
    tcase_add_test(tests, NL2_the_cnc_tells_what_happens);
    tcase_add_test(tests, NL1_a_real_that_is_no_number_is_null);
    tcase_add_test(tests, NO3_the_backup_memory_outlives_power);
    tcase_add_test(tests, NL3_mechanisms_of_a_plc_program_are_found);
    tcase_add_test(tests, NL3_cells_are_found_by_a_part_of_their_name);
    tcase_add_test(tests, NU1_a_cnc_has_neither_bus_nor_inputs_nor_steps);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    return rig_run(cnc872_device_suite(), "./test_cnc872_device");
}
