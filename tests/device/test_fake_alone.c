/* SPDX-License-Identifier: MIT */
/* test_fake_alone.c: a kind of device without a bus, with names of inputs and outputs. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "fake_device.h"
#include "fake_rig.h"
#include "record/record.h"
#include "trace/trace.h"

static struct fake_rig rig;

static void begin(void)
{
    fake_rig_begin_as(&rig, &fake_alone_device, NULL, "1", true);
}

static void end(void)
{
    fake_rig_end(&rig);
}

/* ---- Without a bus -------------------------------------------------------------------------------------------------- */

START_TEST(device_without_a_bus_moves_and_is_seen)
{
    fake_rig_do(&rig, "alone.obey", "{\"text\": \"MOVE 2\"}");
    sim_advance(&rig.sim, 1000000);
    ck_assert_str_eq(fake_rig_seen(&rig), "0 unit 1 motor 1 motion 1\n10000 unit 1 motor 1 step 1\n"
                                          "10000 unit 1 motor 0 outputs 2\n20000 unit 1 motor 1 step 2\n"
                                          "20000 unit 1 motor 0 outputs 6\n"
                                          "20000 unit 1 motor 1 motion 0\n");
    fake_rig_expect_state(&rig, "motors.0.position", "2");
}
END_TEST

/* Bytes go nowhere, and are on no wire in which anything answers. */
START_TEST(bytes_reach_no_device_without_a_bus)
{
    fake_rig_ask(&rig, 1, "POS?");
    sim_advance(&rig.sim, 1000000);
    ck_assert_str_eq(fake_rig_seen(&rig), "");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"wrong_fcs\"}", "the device alone has no bus");
}
END_TEST

START_TEST(recording_of_a_device_without_a_bus_replays)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&rig.sim, out);
    ck_assert_ptr_nonnull(record);
    fake_rig_do(&rig, "alone.obey", "{\"text\": \"MOVE 20\"}");
    sim_advance(&rig.sim, 50000);
    fake_rig_do(&rig, "di.set", "{\"di\": {\"lmt+\": 1}}");
    sim_advance(&rig.sim, 1000000);
    ck_assert_int_eq(record_end(record), 0);
    fclose(out);
    FILE *in = fmemopen(text, length, "r");
    struct replay *replay = replay_open("test.record", in);
    ck_assert_int_eq(replay_run(replay, NULL, NULL), REPLAY_SAME);
    ck_assert_uint_gt(replay_counts(replay).steps, 3);
    replay_free(replay);
    fclose(in);
    free(text);
}
END_TEST

START_TEST(scenario_of_a_device_without_a_bus)
{
    run_story("device: alone\nallow_faults: true\nplant: {switches: [{input: near, motor: 1, at_least: 3}]}\nsteps:\n"
              "  - call: alone.obey\n    params: {text: MOVE 5}\n"
              "  - wait: {di: {near: 1}}\n    within: 1s\n"
              "  - expect: {motor: 1, position: 3}\n"
              "  - di: {\"lmt+\": 1}\n"
              "  - wait: {motor: 1, state: idle}\n    within: 1ms\n",
              SCENARIO_PASSED, NULL);
    run_story("device: alone\nsteps:\n  - expect: {di: {near: 1}}\n", SCENARIO_FAILED, "expected DI near == 1, seen DI near 0");
    run_story("device: alone\nsteps:\n  - message: '04'\n", SCENARIO_FAILED, "the device alone has no bus: expected no message");
    run_story("device: alone\nsteps:\n  - bytes: '04'\n", SCENARIO_FAILED, "the device alone has no bus: expected no bytes");
    run_story("device: alone\nsteps:\n  - set: F1\n", SCENARIO_FAILED, "has no programs");
    run_story("device: pmc-2hs\nsteps:\n  - set: F1\n", SCENARIO_FAILED,
              "the device pmc-2hs has no programs that a message sets");
}
END_TEST

/* ---- Names ---------------------------------------------------------------------------------------------------------- */

START_TEST(inputs_have_names_beside_their_numbers)
{
    fake_rig_do(&rig, "di.set", "{\"di\": {\"near\": 1}}");
    fake_rig_expect_state(&rig, "di", "2");
    fake_rig_do(&rig, "di.set", "{\"di\": {\"02\": 0, \"DI3\": 1}}");
    fake_rig_expect_state(&rig, "di", "4");
    fake_rig_expect_refusal(&rig, "di.set", "{\"di\": {\"naer\": 1}}", 
                            "unknown input `naer': expected 1 to 3 or lmt+, near, DI3");
    fake_rig_expect_refusal(&rig, "di.set", "{\"di\": {\"near\": 1, \"2\": 1}}", "input 2 is named twice");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": \"near\", \"level\": 1, \"duration\": \"20ms\"}");
    fake_rig_expect_state(&rig, "di", "6");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": \"far\", \"level\": 1}",
                            "expected 1 to 3 or lmt+");
    json_t *units = fake_rig_command(&rig, "units", "{}");
    char *text = json_dumps(units, JSON_COMPACT);
    ck_assert_msg(strstr(text, "\"inputs\":[\"lmt+\",\"near\",\"DI3\"],"
                               "\"outputs\":[\"lamp\",\"a1\",\"b1\",\"a2\",\"b2\"]") != NULL, "%s", text);
    free(text);
    json_decref(units);
}
END_TEST

START_TEST(conditions_have_the_names)
{
    static const char *const wrong[][2] = {
        {"{\"di\": {\"far\": 1}}", "di: expected 1 to 3 or lmt+, near, DI3, found \"far\""},
        {"{\"do\": {\"far\": 1}}", "do: expected 1 to 5 or lamp, a1, b1, a2, b2, found \"far\""},
    };
    struct refusal refusal;
    fake_rig_do(&rig, "alone.obey", "{\"text\": \"OUT 1\"}");
    json_t *json = json_loads("{\"do\": {\"lamp\": 1}, \"di\": {\"3\": 0}}", 0, NULL);
    struct condition *condition = condition_read(&rig.sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s", refusal.text);
    condition_arm(condition);
    ck_assert(condition_holds(condition));
    char *text = condition_wanted_text(condition);
    ck_assert_msg(strstr(text, "DO lamp == 1") && strstr(text, "DI DI3 == 0"), "%s", text);
    free(text);
    condition_free(condition);
    json_decref(json);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        json = json_loads(wrong[i][0], 0, NULL);
        ck_assert_ptr_null(condition_read(&rig.sim, json, &refusal));
        ck_assert_str_eq(refusal.text, wrong[i][1]);
        json_decref(json);
    }
}
END_TEST

/* A plant's file may have names or numbers. */
START_TEST(switch_of_a_plant_drives_a_named_input)
{
    fake_rig_do(&rig, "plant.set",
                "{\"plant\": \"switches: [{input: near, motor: 1, at_least: 0}, {input: 3, motor: 1, at_most: 9}]\"}");
    fake_rig_expect_state(&rig, "di", "6");
    fake_rig_expect_refusal(&rig, "plant.set", "{\"plant\": \"switches: [{input: far, motor: 1, at_least: 0}]\"}",
                            "expected an input 1 to 3 or lmt+, near, DI3");
}
END_TEST

START_TEST(vcd_has_the_names)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct trace_file *file = trace_file_begin_on(&rig.sim, out, TRACE_VCD);
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(trace_file_end(file), 0);
    fclose(out);
    ck_assert_msg(strstr(text, "$var wire 1 \" lmt+ $end\n"
                               "$var wire 1 # near $end\n$var wire 1 $ DI3 $end\n"
                               "$var wire 1 % lamp $end\n$var wire 1 & a1 $end\n"),
                  "%s", text);
    free(text);
}
END_TEST

/* What a trace of this format has of a value that is -7 at its begin, 2 after 1 s, and then gone with the power. */
static char *traced(enum trace_format format)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fake_rig_do(&rig, "alone.level", "{\"level\": -7}");
    struct trace_file *file = trace_file_begin_on(&rig.sim, out, format);
    ck_assert_ptr_nonnull(file);
    sim_advance(&rig.sim, sim_now(&rig.sim) + 1000000);
    fake_rig_do(&rig, "alone.level", "{\"level\": 2}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 10);
    fake_rig_do(&rig, "power", "{\"on\": false}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 10);
    ck_assert_int_eq(trace_file_end(file), 0);
    fclose(out);
    return text;
}

START_TEST(traces_have_the_values)
{
    static const struct {
        enum trace_format format;
        const char *parts[4];
    } rows[] = {
        {TRACE_CSV, {"value\n0.000,unit,level,-7\n", "\n1000000.000,unit,level,2\n", "power,off\n", ""}},
        {TRACE_JSONL,
         {",\"values\":{\"level\":-7},\"motors\"",
          "{\"t_us\":1000000.000,\"kind\":\"value\",\"unit\":\"1\",\"name\":\"level\",\"value\":2}\n",
          "", ""}},
        {TRACE_VCD, {"$var real 64 * level $end\n", "\nr-7 *\n", "#1000000000\nr2 *\n", "#1000010000\n0!\n"}},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        end();
        begin();
        char *text = traced(rows[i].format);
        for (size_t part = 0; part < 4; part++)
            ck_assert_msg(strstr(text, rows[i].parts[part]), "%s is not in %s", rows[i].parts[part], text);
        if (rows[i].format == TRACE_VCD)
            ck_assert_ptr_nonnull(strstr(strstr(text, "#1000010000"), "\nr0 *\n"));
        free(text);
    }
}
END_TEST

/* ---- A motor that is moved by its coils ------------------------------------------------------------------------------- */

/* Where the motor is after 17 half steps forward with these leads; what was reported of it. */
static void expect_turned(const char *coils, const char *forward, const char *back, const char *reported)
{
    char params[160];
    snprintf(params, sizeof params, "{\"plant\": {\"motors\": {\"1\": {%s}}}}", coils);
    fake_rig_do(&rig, "plant.set", params);
    fake_rig_do(&rig, "alone.obey", "{\"text\": \"MOVE 17\"}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 1000000);
    fake_rig_expect_state(&rig, "motors.0.position", "17");
    fake_rig_expect_state(&rig, "motors.0.true_position", forward);
    fake_rig_do(&rig, "alone.obey", "{\"text\": \"MOVE -17\"}");
    sim_advance(&rig.sim, sim_now(&rig.sim) + 1000000);
    fake_rig_expect_state(&rig, "motors.0.true_position", back);
    json_t *plant = fake_rig_command(&rig, "plant.get", "{}");
    char *text = json_dumps(plant, JSON_COMPACT);
    ck_assert_msg(strstr(text, reported) != NULL, "%s", text);
    free(text);
    json_decref(plant);
}

START_TEST(motor_follows_the_field_of_its_coils)
{
    expect_turned("", "17", "0", "\"lost\":0,");
    expect_turned("\"coils\": [1, 2, 3, 4], \"offset\": 100", "117", "100", "\"lost\":0,");
}
END_TEST

START_TEST(motor_with_swapped_leads_turns_back)
{
    expect_turned("\"coils\": [3, 2, 1, 4]", "-17", "0", "\"lost\":0,");
    expect_turned("\"coils\": [1, 4, 3, 2]", "-17", "0", "\"lost\":0,");
    expect_turned("\"coils\": [3, 4, 1, 2]", "17", "0", "\"lost\":0,"); /* both: forward again */
}
END_TEST

/* It goes to and fro within a turn of the field, and where the field points away from it it stands. */
START_TEST(motor_with_a_missing_lead_does_not_turn)
{
    char *text;
    expect_turned("\"coils\": [1, 2, 3, 0]", "4", "0", "\"hold\":");
    expect_turned("\"coils\": [0, 0, 0, 0]", "0", "0", "\"lost\":0,");
    expect_turned("\"missing_lead\": true", "0", "0", "\"hold\":\"missing_lead\"");
    text = strdup(fake_rig_seen(&rig));
    ck_assert_msg(strstr(text, "unit 1 motor 1 plant 5\n") != NULL, "%s", text); /* PLANT_FIELD */
    free(text);
}
END_TEST

START_TEST(wiring_of_coils_is_checked)
{
    static const char *const wrong[][2] = {
        {"[1, 2, 3]", "expected the leads of the device at lead 1 to 4 of the motor"},
        {"[1, 2, 3, 5]", "a lead of the device, or 0 for none"},
        {"[1, 2, 3, 1]", "expected each lead once"},
        {"1", "expected the leads of the device"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char params[160];
        snprintf(params, sizeof params, "{\"plant\": {\"motors\": {\"1\": {\"coils\": %s}}}}", wrong[i][0]);
        fake_rig_expect_refusal(&rig, "plant.set", params, wrong[i][1]);
    }
    end();
    fake_rig_begin(&rig, "1", false);
    fake_rig_expect_refusal(&rig, "plant.set", "{\"plant\": {\"motors\": {\"1\": {\"coils\": [1, 2, 3, 4]}}}}",
                            "found \"coils\"");
}
END_TEST

static Suite *fake_alone_suite(void)
{
    Suite *suite = suite_create("fake_alone");
    TCase *all = tcase_create("all");
    tcase_add_checked_fixture(all, begin, end);
    tcase_add_test(all, device_without_a_bus_moves_and_is_seen);
    tcase_add_test(all, bytes_reach_no_device_without_a_bus);
    tcase_add_test(all, recording_of_a_device_without_a_bus_replays);
    tcase_add_test(all, scenario_of_a_device_without_a_bus);
    tcase_add_test(all, inputs_have_names_beside_their_numbers);
    tcase_add_test(all, conditions_have_the_names);
    tcase_add_test(all, switch_of_a_plant_drives_a_named_input);
    tcase_add_test(all, vcd_has_the_names);
    tcase_add_test(all, traces_have_the_values);
    tcase_add_test(all, motor_follows_the_field_of_its_coils);
    tcase_add_test(all, motor_with_swapped_leads_turns_back);
    tcase_add_test(all, motor_with_a_missing_lead_does_not_turn);
    tcase_add_test(all, wiring_of_coils_is_checked);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(fake_alone_suite(), "./test_fake_alone");
}
