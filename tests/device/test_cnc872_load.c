/* SPDX-License-Identifier: MIT */
/* test_cnc872_load.c: PLC programs and switches that are loaded into a CNC872 that runs: what is kept, what is refused, whole or
 * not at all. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "fake_rig.h"
#include "record/record.h"
#include "trace/trace.h"

static struct fake_rig rig;

/* COUNT goes up by one in each T; a block waits for READY. */
#define OLD \
    "DATA\nSPARE DW 9\nCOUNT DW 0\nREADY BIT 0\nDATA_END\n" \
    "MODULE_BLOCK_INIT\n LDR READY\n EX0\nMODULE_BLOCK_INIT_END\n" \
    "MODULE_MAIN\n LOD COUNT\n AD CNST.1\n STO COUNT\n FL 0,MPYPI\nMODULE_MAIN_END\n"
/* By ten, in another place; READY is in another place, too. */
#define NEXT \
    "DATA\\nOTHER BIT 0\\nREADY BIT 1\\nCOUNT DW 100\\nDATA_END\\nMODULE_INIT\\n FL 1,OTHER\\nMODULE_INIT_END\\n" \
    "MODULE_MAIN\\n LOD COUNT\\n AD CNST.10\\n STO COUNT\\nMODULE_MAIN_END\\n"

static void begin(void)
{
    fake_rig_begin_as(&rig, &cnc872_device, "plc=" OLD, "1", true);
}

static void end(void)
{
    fake_rig_end(&rig);
}

static void expect_result(const char *method, const char *params, const char *wanted)
{
    fake_rig_expect_result(&rig, method, params, wanted);
}

static void do_turns(uint64_t k)
{
    sim_advance(&rig.sim, k * 1000 + 1);
}

static void load_second(void)
{
    expect_result("cnc.load", "{\"plc\": \"" NEXT "\"}", "\"instructions\":");
}

START_TEST(another_plc_program_begins_as_at_power_up)
{
    do_turns(5);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\", \"MPYPI\"]}", "{\"COUNT\":5,\"MPYPI\":0}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"EXT_PLC\": 1}}");
    load_second();
    expect_result("cnc.get", "{\"cells\": [\"COUNT\", \"OTHER\", \"READY\", \"MPYPI\", \"EXT_PLC\"]}",
                  "{\"t\":5,\"cells\":{\"COUNT\":100,\"OTHER\":1,\"READY\":1,\"MPYPI\":1,\"EXT_PLC\":0}}");
    do_turns(7);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\"]}", "{\"t\":7,\"cells\":{\"COUNT\":120}}");
    fake_rig_expect_refusal(&rig, "cnc.get", "{\"cells\": [\"SPARE\"]}", "SPARE");
}
END_TEST

START_TEST(positions_references_panel_nc_program_and_backup_memory_stay)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G0 X1\\nG1 X2 F1000\"}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"READY\": 1, \"PLC_MEM_BACKUP[3]\": 7, \"HOMING_REQ\": 4}}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true, \"feed\": 50, \"block_by_block\": true}");
    do_turns(200);
    fake_rig_expect_state(&rig, "motors.0.position", "1000");
    load_second();
    do_turns(210);
    fake_rig_expect_state(&rig, "motors.0.position", "1000");
    fake_rig_expect_state(&rig, "cnc.panel.feed", "50");
    fake_rig_expect_state(&rig, "cnc.block.blocks", "2");
    fake_rig_expect_state(&rig, "cnc.block.next", "0");
    expect_result("cnc.get", "{\"cells\": [\"PLC_MEM_BACKUP[3]\", \"HOMING\", \"SF_STOP\", \"SF_BLOCKBYBLOCK\"]}",
                  "{\"PLC_MEM_BACKUP[3]\":7,\"HOMING\":4,\"SF_STOP\":1,\"SF_BLOCKBYBLOCK\":1}");
}
END_TEST

START_TEST(a_wrong_text_changes_nothing)
{
    do_turns(5);
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"MODULE_MAIN\\n TIM 3\\nMODULE_MAIN_END\", \"plc_name\": \"a.plc\"}",
                            "a.plc:2:2: error: ");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"" NEXT "\", \"text\": \"G1 Q1\"}", "nc:1:4: error: ");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": 5}", "plc: expected a text");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"\", \"plc_name\": 5}", "plc_name: expected a text");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"machine\": \"switches: [{cell: OTHER, axis: X, at_least: 1}]\"}",
                            "machine:1:19: error: expected a bit");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"machine\": \"switches: [{cell: READY, axis: 4, at_least: 1}]\"}",
                            "the configuration has no axis 4");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"config\": \"<ChannelConfig/>\"}", "start it with --config");
    fake_rig_expect_refusal(&rig, "cnc.load", "{}", "text: expected an NC program, or plc, a PLC program, or machine");
    do_turns(6);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\"]}", "{\"t\":6,\"cells\":{\"COUNT\":6}}");
}
END_TEST

/* Switches follow the bits of the new program; a program without the bit is refused, unless other switches come with it. */
START_TEST(switches_are_read_with_the_new_program)
{
    fake_rig_do(&rig, "cnc.load", "{\"machine\": \"switches: [{cell: READY, axis: X, at_least: 1000}]\"}");
    do_turns(3);
    expect_result("cnc.get", "{\"cells\": [\"READY\"]}", "{\"READY\":0}");
    load_second();
    do_turns(6);
    expect_result("cnc.get", "{\"cells\": [\"OTHER\", \"READY\"]}", "{\"OTHER\":1,\"READY\":0}");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"DATA\\nNONE BIT 0\\nDATA_END\"}", "found \"READY\"");
    expect_result("cnc.load", "{\"plc\": \"DATA\\nNONE BIT 0\\nDATA_END\", \"text\": \"G0 X1\", \"machine\": "
                              "\"switches: [{cell: NONE, axis: X, at_most: 0}]\"}", "\"blocks\":1");
    do_turns(7);
    expect_result("cnc.get", "{\"cells\": [\"NONE\"]}", "{\"NONE\":1}");
}
END_TEST

START_TEST(nothing_is_loaded_while_something_moves)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X10 F1000\\nG4 P1\"}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"READY\": 1}}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(100);
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"" NEXT "\"}", "an axis moves, or a block is in its motion or delay");
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"machine\": \"switches: []\"}", "stop it and RESET");
    do_turns(700);
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"" NEXT "\"}", "delay");
    fake_rig_do(&rig, "cnc.panel", "{\"reset\": true}");
    do_turns(710);
    fake_rig_do(&rig, "cnc.panel", "{\"mode\": \"manual\", \"jog\": {\"X\": \"+\"}}");
    do_turns(800);
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"plc\": \"" NEXT "\"}", "an axis moves");
    fake_rig_do(&rig, "cnc.panel", "{\"jog\": {\"X\": \"\"}}");
    do_turns(1000);
    load_second();
}
END_TEST

/* Neither STOP nor RESET ends a pass that waits for ever, or one of a program that has halted: another program does. */
START_TEST(a_block_that_waits_for_its_pass_is_over)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X10 F1000\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(10);
    fake_rig_do(&rig, "cnc.panel", "{\"reset\": true}");
    do_turns(20);
    expect_result("cnc.get", "{\"cells\": [\"PO_F\", \"CAPI\"]}", "{\"PO_F\":1,\"CAPI\":1}");
    load_second();
    expect_result("cnc.get", "{\"cells\": [\"PO_F\", \"CAPI\", \"PO_OSXPI\"]}", "{\"PO_F\":0,\"CAPI\":0,\"PO_OSXPI\":0}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    do_turns(700);
    fake_rig_expect_state(&rig, "motors.0.position", "10000");
    fake_rig_do(&rig, "cnc.load", "{\"plc\": \"MODULE_MAIN\\nA: JUM A\\nMODULE_MAIN_END\"}");
    do_turns(710);
    load_second();
    do_turns(720);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\", \"STOP_EMERGENCY_REQ\"]}", "{\"COUNT\":200,\"STOP_EMERGENCY_REQ\":0}");
}
END_TEST

static void on_cell(void *context, const struct watch_event *event)
{
    fprintf(context, "%llu %lld\n", (unsigned long long)event->tick, (long long)event->cell);
}

/* Who waits for a cell, or watches it, means its name. */
START_TEST(watched_cells_follow_their_names)
{
    struct refusal refusal;
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct watcher watcher = {.on_event = on_cell, .context = out};
    struct event_filter filter;
    json_t *json = json_loads("{\"cells\": [\"READY\"]}", 0, NULL), *wanted = json_loads("{\"cell\": {\"COUNT\": 130}}", 0, NULL);
    ck_assert(event_filter_read(&filter, &rig.sim, json, &refusal));
    json_decref(event_watch(&rig.sim, &watcher, &filter, 1, json, &refusal));
    struct condition *condition = condition_read(&rig.sim, wanted, &refusal);
    ck_assert_msg(condition != NULL, "%s", refusal.text);
    do_turns(5);
    load_second();
    fake_rig_do(&rig, "cnc.load", "{\"plc\": \"DATA\\nX DQ 0\\nCOUNT DW 130\\nDATA_END\"}");
    load_second();
    condition_arm(condition);
    ck_assert(condition_run(condition, 1000000));
    ck_assert_uint_eq(sim_now(&rig.sim), 8001);
    fake_rig_do(&rig, "cnc.load", "{\"plc\": \"MODULE_MAIN\\nMODULE_MAIN_END\"}"); /* it has no such cell: 0 */
    do_turns(10);
    fflush(out);
    ck_assert_str_eq(text, "6000 1\n9000 0\n");
    condition_free(condition);
    sim_unwatch(&rig.sim, &watcher);
    json_decref(json);
    json_decref(wanted);
    fclose(out);
    free(text);
}
END_TEST

START_TEST(a_loaded_program_is_in_recordings_and_snapshots_and_outlives_power)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&rig.sim, out);
    do_turns(5);
    fake_rig_do(&rig, "snapshot", "{\"name\": \"first\"}");
    load_second();
    do_turns(6);
    fake_rig_do(&rig, "restore", "{\"name\": \"first\"}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 1000);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\", \"SPARE\"]}", "{\"COUNT\":6,\"SPARE\":9}");
    load_second();
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G0 X1\\nG0 X2\"}");
    fake_rig_do(&rig, "reset", "{}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 2001);
    expect_result("cnc.get", "{\"cells\": [\"COUNT\"]}", "{\"COUNT\":120}");
    fake_rig_expect_state(&rig, "cnc.block.blocks", "2");
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

START_TEST(a_scenario_loads_a_plc_program)
{
    run_story("device: cnc872\nsteps:\n"
              "  - call: cnc.load\n    params:\n      plc: |\n        DATA\n        LAMP BIT 0\n        DATA_END\n"
              "        MODULE_MAIN\n          FL 1,LAMP\n        MODULE_MAIN_END\n"
              "    result: {instructions: 2}\n"
              "  - advance: 2ms\n  - expect: {cell: {LAMP: 1}}\n",
              SCENARIO_PASSED, NULL);
}
END_TEST

/* An author who tries all day. */
START_TEST(NL4_hundreds_of_programs_are_loaded)
{
    for (unsigned k = 0; k < 400; k++) {
        char params[100];
        snprintf(params, sizeof params, "{\"plc\": \"DATA\\nA DW %u\\nDATA_END\"}", k);
        fake_rig_do(&rig, "cnc.load", params);
    }
    expect_result("cnc.get", "{\"cells\": [\"A\"]}", "{\"A\":399}");
}
END_TEST

static Suite *cnc872_load_suite(void)
{
    Suite *suite = suite_create("cnc872_load");
    TCase *tests = tcase_create("cnc872");
    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, another_plc_program_begins_as_at_power_up);
    tcase_add_test(tests, positions_references_panel_nc_program_and_backup_memory_stay);
    tcase_add_test(tests, a_wrong_text_changes_nothing);
    tcase_add_test(tests, switches_are_read_with_the_new_program);
    tcase_add_test(tests, nothing_is_loaded_while_something_moves);
    tcase_add_test(tests, a_block_that_waits_for_its_pass_is_over);
    tcase_add_test(tests, watched_cells_follow_their_names);
    tcase_add_test(tests, a_loaded_program_is_in_recordings_and_snapshots_and_outlives_power);
    tcase_add_test(tests, a_scenario_loads_a_plc_program);
    tcase_add_test(tests, NL4_hundreds_of_programs_are_loaded);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    return rig_run(cnc872_load_suite(), "./test_cnc872_load");
}
