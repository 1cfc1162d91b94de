/* SPDX-License-Identifier: MIT */
/* test_fake_files.c: traces, recordings and scenarios of a second kind of device. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "fake_device.h"
#include "fake_rig.h"
#include "record/record.h"
#include "scenario/scenario.h"
#include "trace/trace.h"

#define SECOND UINT64_C(1000000)

static struct fake_rig rig;

/* ---- Traces --------------------------------------------------------------------------------------------------------- */

/* The trace of a motion of two steps and an output. To be freed. */
static char *trace(enum trace_format format)
{
    char *text;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    fake_rig_begin(&rig, "1", false);
    struct trace_file *file = trace_file_begin_on(&rig.sim, out, format);
    ck_assert_ptr_nonnull(file);
    fake_rig_expect_answer(&rig, 1, "MOVE 2", "OK");
    sim_advance(&rig.sim, 30000);
    fake_rig_do(&rig, "di.set", "{\"mask\": 2}");
    fake_rig_expect_answer(&rig, 1, "OUT 1", "OK");
    ck_assert_int_eq(trace_file_end(file), 0);
    fclose(out);
    fake_rig_end(&rig);
    return text;
}

static void expect_text(char *text, const char *expected)
{
    ck_assert_str_eq(text, expected);
    free(text);
}

static void expect_part(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "%s\nis not in\n%s", part, text);
}

START_TEST(csv_has_the_names_of_the_device)
{
    expect_text(trace(TRACE_CSV),
                "t_us,source,event,value\n"
                "0.000,m1,dir,1\n"
                "0.000,m1,motion,begin\n"
                "0.000,m1,led,on\n"
                "10000.000,m1,step,1\n"
                "20000.000,m1,step,2\n"
                "20000.000,m1,motion,end\n"
                "20000.000,m1,led,off\n"
                "30000.000,unit,di,2\n"
                "30000.000,unit,do,1\n");
}
END_TEST

START_TEST(vcd_has_the_signals_of_the_device)
{
    char *text = trace(TRACE_VCD);
    expect_part(text, "$timescale 1 ns $end\n$scope module fake $end\n"
                "$var wire 1 ! power $end\n"
                "$var wire 1 \" di01 $end\n"
                "$var wire 1 # di02 $end\n");
    expect_part(text, "$var wire 1 5 di20 $end\n"
                "$var wire 1 6 do01 $end\n"
                "$scope module m1 $end\n"
                "$var wire 1 7 m1_step $end\n"
                "$var wire 1 8 m1_dir $end\n"
                "$var wire 1 9 m1_led $end\n"
                "$var wire 1 : m1_moving $end\n"
                "$var real 64 ; m1_command $end\n"
                "$var real 64 < m1_speed $end\n"
                "$var real 64 = m1_position $end\n"
                "$upscope $end\n"
                "$upscope $end\n");
    expect_part(text, "#10000000\n17\nr1 =\nr100 <\n#10002000\n07\n#20000000\n17\nr2 =\n0:\nr0 <\n09\n#20002000\n07\n"
                "#30000000\n1#\n16\n");
    free(text);
}
END_TEST

START_TEST(jsonl_has_the_names_of_the_device)
{
    char *text = trace(TRACE_JSONL);
    expect_part(text, "\"motors\":[{\"motor\":1,\"position\":0,\"direction\":1,\"motion\":0,\"command\":0,"
                      "\"led\":\"off\",\"fault\":\"none\"}]");
    expect_part(text, "\"bytes\":\"814D4F564520320D\",\"message\":\"4D4F56452032\",\"dropped\":null");
    expect_part(text, "{\"t_us\":20000.000,\"kind\":\"step\",\"unit\":\"1\",\"motor\":1,\"value\":2}\n");
    expect_part(text, "{\"t_us\":30000.000,\"kind\":\"outputs\",\"unit\":\"1\",\"value\":1}\n");
    free(text);
}
END_TEST

/* A step every 111.25 us: its ticks last 0.25 us. Pulses are as long as the device says, above 5000 steps/s 1 us. */
START_TEST(traces_are_as_fine_as_the_ticks_of_the_device)
{
    static const enum trace_format formats[] = {TRACE_CSV, TRACE_VCD, TRACE_JSONL};
    static const char *const parts[] = {
        "1.000,m1,motion,begin\n1.000,m1,led,on\n112.250,m1,step,1\n223.500,m1,step,2\n223.500,m1,motion,end\n",
        "#112250\n17\nr1 =\n#113250\n07\n#223500\n17\nr2 =\n0:\n09\n#224500\n07\n",
        "{\"t_us\":112.250,\"kind\":\"step\",\"unit\":\"1\",\"motor\":1,\"value\":1}\n",
    };
    for (size_t i = 0; i < 3; i++) {
        char *text;
        size_t length;
        FILE *out = open_memstream(&text, &length);
        fake_rig_begin(&rig, "1", false);
        fake_rig_expect_answer(&rig, 1, "RATE 8988", "OK"); /* 445 ticks */
        struct trace_file *file = trace_file_begin_on(&rig.sim, out, formats[i]);
        fake_rig_expect_answer(&rig, 1, "MOVE 2", "OK");
        sim_advance(&rig.sim, 300);
        ck_assert_int_eq(trace_file_end(file), 0);
        fclose(out);
        fake_rig_end(&rig);
        expect_part(text, parts[i]);
        free(text);
    }
}
END_TEST

static void expect_words(const char *bytes, size_t length, bool is_answer, const char *expected)
{
    char text[80];
    struct wire_text out = {.text = text, .room = sizeof text};
    wire_words_message(&out, fake_device.words, (const uint8_t *)bytes, length, is_answer);
    ck_assert_str_eq(wire_text_end(&out), expected);
}

START_TEST(wire_log_has_the_words_of_the_device)
{
    expect_words("MOVE 2", 6, false, "request MOVE 2");
    expect_words("OK", 2, true, "OK");
    char *text = trace(TRACE_JSONL);
    expect_part(text, "\"dropped\":null,\"refused\":null");
    free(text);
    fake_rig_begin(&rig, "1", false);
    fake_rig_do(&rig, "di.set", "{\"mask\": 1}");
    size_t length;
    FILE *out = open_memstream(&text, &length);
    struct trace_file *file = trace_file_begin_on(&rig.sim, out, TRACE_JSONL);
    fake_rig_expect_answer(&rig, 1, "MOVE 2", "E3");
    ck_assert_int_eq(trace_file_end(file), 0);
    fclose(out);
    fake_rig_end(&rig);
    expect_part(text, "\"refused\":\"the limit switch is on\"");
    free(text);
}
END_TEST

/* ---- Recordings ------------------------------------------------------------------------------------------------------- */

/* The recording of a session with everything in it. To be freed. */
static char *record(size_t *length)
{
    char *text;
    FILE *out = open_memstream(&text, length);
    fake_rig_begin(&rig, "5,100", true);
    struct record *record = record_begin(&rig.sim, out);
    ck_assert_ptr_nonnull(record);
    fake_rig_ask(&rig, 5, "MOVE 20");
    sim_advance(&rig.sim, 30000);
    fake_rig_ask(&rig, 5, "RATE 300");
    sim_advance(&rig.sim, 60000);
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"flip\", \"mask\": 1, \"count\": 1, \"skip\": 3}");
    fake_rig_ask(&rig, 100, "SAVE");
    sim_advance(&rig.sim, 90000);
    fake_rig_do(&rig, "fake.rate", "{\"unit\": \"5\", \"rate\": 250}");
    fake_rig_do(&rig, "di.set", "{\"unit\": \"5\", \"mask\": 1}");
    fake_rig_do(&rig, "snapshot", "{\"name\": \"a\"}");
    fake_rig_do(&rig, "reset", "{\"unit\": \"100\"}");
    fake_rig_ask(&rig, 100, "MOVE -9");
    sim_advance(&rig.sim, 200000);
    fake_rig_do(&rig, "restore", "{\"name\": \"a\"}");
    sim_advance(&rig.sim, 400000);
    ck_assert_int_eq(record_end(record), 0);
    fclose(out);
    fake_rig_end(&rig);
    return text;
}

static enum replay_end replay(const char *text, size_t length, char said[300])
{
    FILE *in = fmemopen((char *)(uintptr_t)text, length, "r");
    struct replay *replay = replay_open("x", in);
    ck_assert_ptr_nonnull(replay);
    enum replay_end end = replay_run(replay, NULL, NULL);
    snprintf(said, 300, "%s", replay_text(replay));
    replay_free(replay);
    fclose(in);
    return end;
}

START_TEST(recording_names_the_device_and_replays)
{
    size_t length;
    char said[300], *text = record(&length);
    ck_assert_msg(strstr(text, "\"device\":\"fake\"") != NULL, "%.300s", text);
    ck_assert_msg(strstr(text, "\"nodes\":[5,100]") != NULL, "%.300s", text);
    ck_assert_msg(replay(text, length, said) == REPLAY_SAME, "%s", said);
    free(text);
}
END_TEST

START_TEST(changed_recording_differs)
{
    size_t length;
    char said[300], *text = record(&length), *place = strstr(text, "4d4f56452032300d"); /* MOVE 20 */
    ck_assert_msg(place != NULL, "%s", text);
    memcpy(place + 10, "31", 2);
    ck_assert_int_eq(replay(text, length, said), REPLAY_DIFFERENT);
    free(text);
}
END_TEST

START_TEST(recording_of_an_unknown_device_is_refused)
{
    size_t length;
    char said[300], *text = record(&length), *place = strstr(text, "\"fake\"");
    ck_assert_ptr_nonnull(place);
    memcpy(place, "\"fuke\"", 6);
    ck_assert_int_eq(replay(text, length, said), REPLAY_WRONG);
    ck_assert_msg(strstr(said, "expected \"device\"") != NULL, "%s", said);
    free(text);
}
END_TEST

/* ---- Scenarios -------------------------------------------------------------------------------------------------------- */

static const char story[] =
    "name: The axis stops at its limit switch\n"
    "device: fake\n"
    "units: 100\n"
    "baud: 0\n"
    "allow_faults: true\n"
    "plant: {switches: [{input: 1, motor: 1, at_least: 7}]}\n"
    "steps:\n"
    "  - message: '\"MOVE 50\"'\n"
    "    answer: '\"OK\"'\n"
    "  - wait: {motor: 1, state: idle}\n"
    "    within: 1s\n"
    "  - expect: {motor: 1, position: 7, fault: limit}\n"
    "  - message: '\"MOVE 1\"'\n"
    "    answer: '\"E3\"'\n"
    "  - bytes: 'E4 \"POS?\" 0D'\n"
    "    answer: '\"7\"'\n"
    "  - pulses: {motor: 1, count: 7}\n";

/* Errors of reading, or what was expected and seen; to be freed. */
static enum scenario_end run(const char *text, char **said)
{
    static const struct scenario_files files = {0};
    struct scenario_result result = {0};
    size_t length;
    FILE *errors = open_memstream(said, &length);
    struct scenario *scenario = scenario_read("test.yaml", text, strlen(text), &files, errors);
    enum scenario_end end = SCENARIO_FAILED;
    if (scenario) {
        end = scenario_run(scenario, NULL, NULL, NULL, &result);
        fprintf(errors, "line %zu: expected %s, seen %s", result.line, result.expected, result.seen);
    }
    fclose(errors);
    scenario_result_free(&result);
    scenario_free(scenario);
    return end;
}

START_TEST(scenario_runs_the_device_that_it_names)
{
    char *said;
    ck_assert_msg(run(story, &said) == SCENARIO_PASSED, "%s", said);
    free(said);
}
END_TEST

START_TEST(scenario_sets_the_options_of_the_device)
{
    char *said;
    ck_assert_msg(run("device: fake\nrate: 20\nbaud: 0\nsteps:\n  - message: '\"MOVE 4\"'\n    answer: '\"OK\"'\n"
                      "  - {stays: {motor: 1, position: {\"<\": 4}}, for: 199ms}\n"
                      "  - {wait: {motor: 1, position: 4}, within: 2ms}\n",
                      &said) == SCENARIO_PASSED,
                  "%s", said);
    free(said);
}
END_TEST

START_TEST(scenario_is_held_to_the_numbers_of_the_device)
{
    static const char *const wrong[][2] = {
        {"device: fuke\nsteps: [{advance: 1s}]\n", "test.yaml:1:9: error: "},
        {"device: fuke\nsteps: [{advance: 1s}]\n", "did you mean `fake'?"},
        {"device: fake\nrate: 0\nsteps: [{advance: 1s}]\n", "test.yaml:2:7: error: rate: `0' is wrong: expected steps/s from 1"},
        {"device: fake\nrote: 20\nsteps: [{advance: 1s}]\n", "found \"rote\"; did you mean `rate'?"},
        {"device: fake\nstart_file: none.txt\nsteps: [{advance: 1s}]\n", "test.yaml:2:13: error: cannot read"},
        {"rate: 20\nsteps: [{advance: 1s}]\n", "test.yaml:1:1: error: expected name, "},
        {"device: fake\nunits: 101\nsteps: [{advance: 1s}]\n", "test.yaml:2:8: error: "},
        {"device: fake\nsteps: [{expect: {motor: 2, position: 1}}]\n", "test.yaml:2:"},
        {"device: fake\nsteps: [{expect: {motor: 1, state: dwell}}]\n", "idle, moving"},
        {"device: fake\nsteps: [{di: {\"21\": 1}}]\n", "test.yaml:2:"},
        {"device: fake\nsteps: [{pulses: {motor: 2, count: 1}}]\n", "test.yaml:2:"},
        {"device: fake\nreadings: {planning: 20ms}\nsteps: [{advance: 1s}]\n", "test.yaml:2:"},
        {"device: fake\nframing: plain\nsteps: [{advance: 1s}]\n", "test.yaml:2:"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char *said;
        enum scenario_end end = run(wrong[i][0], &said);
        ck_assert_msg(end == SCENARIO_FAILED && strstr(said, wrong[i][1]) != NULL, "%ssays\n%s", wrong[i][0], said);
        free(said);
    }
}
END_TEST

static Suite *fake_files_suite(void)
{
    Suite *suite = suite_create("fake_files");
    TCase *files = tcase_create("files");
    tcase_add_test(files, csv_has_the_names_of_the_device);
    tcase_add_test(files, vcd_has_the_signals_of_the_device);
    tcase_add_test(files, jsonl_has_the_names_of_the_device);
    tcase_add_test(files, wire_log_has_the_words_of_the_device);
    tcase_add_test(files, traces_are_as_fine_as_the_ticks_of_the_device);
    tcase_add_test(files, recording_names_the_device_and_replays);
    tcase_add_test(files, changed_recording_differs);
    tcase_add_test(files, recording_of_an_unknown_device_is_refused);
    tcase_add_test(files, scenario_runs_the_device_that_it_names);
    tcase_add_test(files, scenario_sets_the_options_of_the_device);
    tcase_add_test(files, scenario_is_held_to_the_numbers_of_the_device);
    suite_add_tcase(suite, files);
    return suite;
}

int main(void)
{
    return rig_run(fake_files_suite(), "./test_fake_files");
}
