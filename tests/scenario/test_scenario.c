/* SPDX-License-Identifier: MIT */
/* test_scenario.c: scenarios: what their steps do, how they fail, and what is no scenario. One case alone:
 * CK_RUN_CASE=CASE ./test_scenario */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "scenario/scenario.h"
#include "scenario/scenario_bytes.h"

static struct scenario_result result;
static char *said; /* errors of reading */

/* The one file there is, apart from the scenario. */
static const char *file_path, *file_text;

static char *read_file(void *context, const char *path, size_t *length, const char **why)
{
    (void)context;
    if (file_path == NULL || strcmp(path, file_path) != 0) {
        *why = "it is not there";
        return NULL;
    }
    *length = strlen(file_text);
    return strdup(file_text);
}

static void setup(void)
{
    file_path = NULL;
}

static void teardown(void)
{
    scenario_result_free(&result);
    free(said);
    said = NULL;
}

/* Read with what was reported in `said`. */
static struct scenario *read_bytes(const char *text, size_t length)
{
    static const struct scenario_files files = {.read = read_file};
    size_t said_length;
    FILE *errors;
    free(said);
    errors = open_memstream(&said, &said_length);
    ck_assert_ptr_nonnull(errors);
    struct scenario *scenario = scenario_read("folder/test.yaml", text, length, &files, errors);
    if (scenario == NULL) {
        fclose(errors);
        return NULL;
    }
    fflush(errors);
    ck_assert_str_eq(said, "");
    fclose(errors);
    return scenario;
}

static enum scenario_end run(const char *text)
{
    struct scenario *scenario = read_bytes(text, strlen(text));
    ck_assert_msg(scenario != NULL, "%s", said);
    scenario_result_free(&result);
    enum scenario_end end = scenario_run(scenario, NULL, NULL, NULL, &result);
    scenario_free(scenario);
    return end;
}

static void expect_pass(const char *text)
{
    enum scenario_end end = run(text);
    ck_assert_msg(end == SCENARIO_PASSED, "line %zu: expected %s; seen %s; at %llu", result.line, result.expected, result.seen,
                  (unsigned long long)result.tick);
}

static void expect_pass_at(const char *text, uint64_t tick)
{
    expect_pass(text);
    ck_assert_uint_eq(result.tick, tick);
}

static void expect_fail(const char *text, size_t line, const char *expected, const char *seen)
{
    ck_assert_int_eq(run(text), SCENARIO_FAILED);
    ck_assert_str_eq(result.expected, expected);
    ck_assert_str_eq(result.seen, seen);
    ck_assert_uint_eq(result.line, line);
}

static void expect_error(const char *text, const char *error)
{
    struct scenario *scenario = read_bytes(text, strlen(text));
    scenario_free(scenario);
    ck_assert_msg(scenario == NULL, "taken: %s", text);
    ck_assert_msg(strstr(said, error) != NULL, "%s\nwas refused with: %s", text, said);
    ck_assert_msg(strncmp(said, "folder/test.yaml:", 17) == 0, "%s", said);
}

#define QUIET "baud: 0\nsteps:\n"

/* ---- Steps ---------------------------------------------------------------------------------------------------------- */

START_TEST(a_program_runs_to_its_end)
{
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 100); /* F R */
    expect_pass_at(QUIET "  - set: 'F100 R'\n  - wait: {motor: 1, position: 100}\n", end + 1);
    expect_pass(QUIET "  - {set: 'B100 R', motor: 3}\n"
                      "  - wait: {motor: 3, state: idle}\n"
                      "  - expect: {motor: 3, position: -100}\n"
                      "  - pulses: {motor: 3, back: 100, forward: 0}\n"
                      "  - pulses: {motor: 1, count: 0}\n");
}
END_TEST

START_TEST(U7_bytes_take_their_time_unless_baud_is_0)
{
    /* 7E 01 00 02 "1W" FCS FCS 7E: 9 bytes; the answer, one character later: 10, as a unit says 02 "1" 00 00 */
    expect_pass_at("steps:\n  - {set: 'W1'}\n", (10 * 3125 + 521 * 6 + 10 * 3125 + 5) / 6);
    expect_pass_at(QUIET "  - {set: 'W1'}\n", 0);
}
END_TEST

START_TEST(a_program_may_be_in_a_file_beside_the_scenario)
{
    file_path = "folder/there.rks";
    file_text = "F7 R\n";
    expect_pass(QUIET "  - program: there.rks\n  - wait: {motor: 1, position: 7}\n");
    expect_error(QUIET "  - program: elsewhere.rks\n", "3:14: error: cannot read folder/elsewhere.rks: it is not there");
}
END_TEST

START_TEST(answers_are_compared_byte_by_byte)
{
    expect_pass(QUIET "  - {message: '04 \"1\"', answer: '04 \"1\" 0A \"         0\"'}\n"
                      "  - {message: '05 \"1\"', answer: '05 \"1\"'}\n"
                      "  - {message: '08 31', answer: 'FF 08 .. 00'}\n"
                      "  - {message: '01', answer: '01 *'}\n"
                      "  - message: '01'\n");
    expect_fail(QUIET "  - {message: '04 \"1\"', answer: '04 \"1\" *', label: good}\n"
                      "  - {message: '04 \"1\"', answer: '04 \"2\" ..', label: bad}\n",
                4, "the answer 04 \"2\" ..", "the answer 04 \"1\" 0A \"         0\"");
    ck_assert_str_eq(result.label, "bad");
}
END_TEST

START_TEST(P1_a_program_must_be_taken_unless_another_flag_is_expected)
{
    expect_fail(QUIET "  - set: 'F1 R q'\n", 3, "the answer to the program with flag 0",
                "flag 2 (unknown command 'q'): TEXT:1:6: error: expected a command, found 'q'");
    expect_fail(QUIET "  - set: 'F0 R'\n", 3, "the answer to the program with flag 0",
                "flag 1 (bad value 'F'): TEXT:1:1: error: expected a number 1..16000000 after F, found 0");
    expect_pass(QUIET "  - {set: 'V0', flag: 1}\n");
    expect_fail(QUIET "  - {set: 'V1', flag: 1}\n", 3, "the answer to the program with flag 1", "flag 0 (ok)");
}
END_TEST

START_TEST(L3_what_is_sent_to_all_is_not_answered)
{
    expect_pass("units: 2,5\nsteps:\n  - {set: 'T03', unit: all, motor: 2}\n"
                "  - {wait: {do: {\"03\": 1}}, unit: 2, within: 2ms}\n  - {expect: {unit: 5, do: {\"03\": 1}}}\n");
    expect_pass_at("baud: 0\nsteps:\n  - {message: '01', unit: all, answer: none, within: 3s}\n", 3000 * MS);
}
END_TEST

START_TEST(a_unit_without_power_is_silent)
{
    expect_pass("steps:\n  - power: off\n  - {message: '01', answer: none}\n  - power: on\n  - message: '01'\n");
    expect_fail("steps:\n  - power: off\n  - {message: '01', within: 5ms}\n", 3, "an answer", "no answer within 0.005000 s");
}
END_TEST

START_TEST(L1_raw_bytes_are_put_on_the_line_as_they_are)
{
    expect_pass("steps:\n  - bytes: '7E 7E 33'\n  - {bytes: '7E 01 00 01 45 AE 7E', answer: none}\n"
                "  - {bytes: '7E 01 00 01 99 8D 7E', answer: '01 10 \"01.02,06.03.2009\"'}\n");
}
END_TEST

START_TEST(inputs_power_and_reset_act_at_once)
{
    expect_pass(QUIET "  - {set: 'O08 T01'}\n  - {stays: {motor: 1, state: wait}, for: 3s, at: 1001us}\n"
                      "  - {di: {\"08\": 1}}\n  - {wait: {do: {\"01\": 1}}, within: 2ms}\n  - {set: '=77 T80'}\n"
                      "  - {wait: {motor: 1, position: 77}}\n  - reset: true\n"
                      "  - expect: {motor: 1, position: 0, do: {\"01\": 0}, di: {\"08\": 1}}\n");
}
END_TEST

START_TEST(inputs_at_power_up_are_those_of_all_units)
{
    expect_pass("units: 1,4\ndi: {\"02\": 1, \"8\": 1}\nsteps:\n  - {expect: {di: {\"2\": 1, \"08\": 1, \"01\": 0}}, unit: 4}\n");
}
END_TEST

START_TEST(any_method_that_acts_at_once_can_be_called)
{
    expect_pass("steps:\n  - {call: di.set, params: {mask: 128}}\n  - expect: {di: {\"08\": 1}}\n");
    expect_error("steps:\n  - {call: di.sett}\n", "2:12: error: there is no method");
    expect_error("steps:\n  - {call: advance}\n", "2:12: error: there is no method");
}
END_TEST

START_TEST(pulses_are_counted_by_direction_and_since_the_last_expectation)
{
    static const char text[] = QUIET "  - set: 'F30 R B10 R'\n  - wait: {motor: 1, state: idle}\n"
                                     "  - pulses: {motor: 1, count: 40, forward: {\">\": 29, \"<=\": 30}, back: 10}\n"
                                     "  - set: 'R T41 R'\n  - wait: {motor: 1, state: idle}\n"
                                     "  - pulses: {motor: 1, count: 10, since: last}\n  - pulses: {motor: 1, count: 50}\n"
                                     "  - pulses: {motor: 1, count: 1, since: last}\n";
    expect_fail(text, 10, "pulses of motor 1 since the last check, count == 1", "0 pulses, 0 forward, 0 back");
}
END_TEST

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

START_TEST(a_wait_has_an_end_and_a_beginning)
{
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 100) + 1;
    expect_fail(QUIET "  - set: 'F100 R'\n  - {wait: {motor: 1, position: 101}, within: 1.5s}\n", 4,
                "motor 1 position == 101 within 1.500000 s", "motor 1 position 100");
    ck_assert_uint_eq(result.tick, 1500 * MS);
    expect_fail(QUIET "  - set: 'F100 R'\n  - {wait: {motor: 1, position: 100}, not_before: 1s}\n", 4,
                "motor 1 position == 100 not before 1.000000 s", "motor 1 position 100 after 0.360259 s");
    ck_assert_uint_eq(result.tick, end);
    expect_fail("timeout: 3s\nsteps:\n  - wait: {do: {\"01\": 1}}\n", 3, "DO 01 == 1 within 3.000000 s", "DO 01 0");
    expect_pass(QUIET "  - set: 'F100 R'\n  - {wait: {motor: 1, position: 100}, within: 360259us, not_before: 360259us}\n");
    expect_fail(QUIET "  - set: 'F100 R'\n  - {wait: {motor: 1, position: 100}, within: 360258us}\n", 4,
                "motor 1 position == 100 within 0.360258 s", "motor 1 position 99");
}
END_TEST

START_TEST(what_stays_has_to_stay_at_every_tick)
{
    expect_fail(QUIET "  - set: 'F100 R'\n  - {stays: {motor: 1, position: {\"<\": 50}}, for: 2s}\n", 4,
                "motor 1 position < 50 all the time for 2.000000 s", "motor 1 position 50");
    expect_pass_at(QUIET "  - {stays: {motor: 1, state: idle}, for: 2s}\n", 2000 * MS);
}
END_TEST

START_TEST(a_step_may_have_its_time)
{
    expect_pass_at(QUIET "  - {advance: 5ms, at: 2s}\n", 2005 * MS);
    expect_fail(QUIET "  - advance: 3s\n  - {di: {\"01\": 1}, at: 2s}\n", 4, "to begin at 2.000000 s",
                "the step before has just ended");
}
END_TEST

START_TEST(what_must_hold_always_is_checked_all_the_time)
{
    expect_fail("baud: 0\nalways: [{motor: 1, position: {\"<\": 50}}, {idle: false}]\nsteps:\n  - {set: 'W1'}\n", 2,
                "always idle == false", "idle true");
    expect_fail("baud: 0\nalways:\n  - {motor: 1, position: {\"<\": 50}}\nsteps:\n  - {set: 'F100 R'}\n  - advance: 9s\n", 3,
                "always motor 1 position < 50", "motor 1 position 50");
}
END_TEST

START_TEST(C7_a_fault_fails_unless_it_is_allowed)
{
    expect_fail(QUIET "  - set: 'W100 E'\n  - advance: 7s\n", 4, "no motor in fault",
                "unit 1 motor 1 in fault: no_loop at command 2");
    ck_assert_uint_eq(result.tick, 101 * MS);
    expect_pass("allow_faults: true\nsteps:\n  - set: 'E'\n  - wait: {motor: 1, fault: no_loop}\n");
}
END_TEST

/* ---- Stimuli -------------------------------------------------------------------------------------------------------- */

START_TEST(stimuli_come_at_times_and_on_conditions_whatever_the_steps_do)
{
    expect_pass_at("baud: 0\n"
                   "stimuli:\n"
                   "  - {at: 2s, di: {\"03\": 1}}\n"
                   "  - {when: {di: {\"03\": 1}}, after: 500ms, di: {\"04\": 1}}\n"
                   "  - {when: {motor: 1, state: wait}, expect: {t: 1}}\n"
                   "steps:\n"
                   "  - set: 'O03 T01 O04 T02'\n"
                   "  - {wait: {do: {\"01\": 1}}, within: 2002ms, not_before: 2s}\n"
                   "  - {wait: {do: {\"02\": 1}}}\n",
                   2501 * MS + 1);
}
END_TEST

START_TEST(a_stimulus_that_never_acts_is_a_failure)
{
    expect_fail("stimuli: [{when: {motor: 1, position: 5}, di: {\"03\": 1}}]\nsteps: [{advance: 1s}]\n", 1,
                "the stimulus to act before the last step ends", "motor 1 position 0");
    expect_fail("stimuli: [{at: 5s, di: {\"03\": 1}}]\nsteps: [{advance: 1s}]\n", 1,
                "the stimulus to act before the last step ends", "the last step ended before its time");
}
END_TEST

START_TEST(stimuli_that_call_for_each_other_come_to_an_end)
{
    expect_pass("stimuli:\n"
                "  - {when: {di: {\"02\": 1}}, di: {\"03\": 1}}\n"
                "  - {when: {di: {\"01\": 1}}, di: {\"02\": 1}}\n"
                "  - {at: 0us, di: {\"01\": 1}}\n"
                "  - {when: {di: {\"03\": 1}}, di: {\"01\": 0}}\n"
                "steps:\n  - expect: {di: {\"03\": 1, \"02\": 1, \"01\": 0}}\n");
}
END_TEST

/* ---- Surroundings --------------------------------------------------------------------------------------------------- */

START_TEST(faults_on_demand_can_be_used)
{
    expect_pass("steps:\n  - fault: {kind: no_answer, count: 1}\n  - {message: '01', answer: none}\n  - message: '01'\n");
    expect_fail("steps:\n  - fault: {kind: wrong_fcs}\n  - {message: '01', within: 100ms}\n", 3, "an answer",
                "no answer within 0.100000 s; dropped: 1 with a wrong check sum, 0 malformed, 0 too long");
    expect_pass("seed: 3\nsteps:\n  - fault: {kind: drop, probability: 0.5}\n  - {message: '01', answer: none}\n"
                "  - clear: all\n  - message: '01'\n");
    expect_error("steps:\n  - fault: {kind: drop, probability: 1.5.0}\n", "2:12: error: probability: expected");
    expect_error("steps:\n  - fault: {kind: sunshine}\n", "2:12: error: kind: expected");
}
END_TEST

START_TEST(two_units_of_one_address_can_be_told_apart)
{
    expect_pass("units: 3,3\nsteps:\n  - {power: off, unit: 3-2}\n  - {message: '01', unit: 3}\n"
                "  - expect: {unit: 3-2, powered: false}\n");
    expect_error("units: 3,3\nsteps:\n  - {message: '01'}\n", "3:5: error: unit: missing: expected one of 3, 3-2");
}
END_TEST

START_TEST(L2_another_framing_can_be_chosen)
{
    expect_pass("framing: plain\nunits: 7\nsteps:\n  - {bytes: '07 00 01 01', answer: '01 *'}\n  - message: '01'\n");
}
END_TEST

START_TEST(C4_the_latency_of_a_change_of_speed_can_be_set)
{
    expect_pass("baud: 0\nspeed_change_latency: 1500ms\nversion_text: mine\nsteps:\n"
                "  - {message: '01', answer: '01 04 \"mine\"'}\n  - set: 'V100 F2000 R'\n  - {set: 'V1000', at: 1s}\n"
                "  - {stays: {motor: 1, position: {\"<=\": 250}}, for: 1.5s}\n"
                "  - {wait: {motor: 1, position: 1000}, within: 2s}\n");
}
END_TEST

START_TEST(readings_can_be_set_and_are_kept)
{
    static const char text[] = "baud: 0\nreadings: {speed-change: 1.5s}\nsteps:\n"
                               "  - set: 'V100 F2000 R'\n  - {set: 'V1000', at: 1s}\n"
                               "  - {stays: {motor: 1, position: {\"<=\": 250}}, for: 1.5s}\n";
    const struct rkm04_config settings = {.readings = {.hold_exit = RKM04_HOLD_EXIT_LATCH}};
    const struct device_config readings = rkm04_device_config(&settings);
    expect_pass(text);
    struct scenario *scenario = read_bytes(text, strlen(text));
    scenario_set_readings(scenario, &readings);
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_PASSED);
    for (unsigned at = 0; at < READINGS; at++)
        ck_assert_int_eq(rkm04_device.readings->is_chosen(scenario_config(scenario), at), at == 9);
    scenario_free(scenario);
}
END_TEST

START_TEST(a_run_is_under_the_readings_that_were_set)
{
    static const char text[] = "baud: 0\nsteps:\n  - set: 'V100 F2000 R'\n  - {set: 'V1000', at: 1s}\n"
                               "  - {stays: {motor: 1, position: {\"<=\": 250}}, for: 1.5s}\n";
    const struct rkm04_config settings = {.readings = {.speed_change = 1500}};
    const struct device_config readings = rkm04_device_config(&settings);
    struct scenario *scenario = read_bytes(text, strlen(text));
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_FAILED);
    scenario_result_free(&result);
    scenario_set_readings(scenario, &readings);
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_PASSED);
    scenario_free(scenario);
}
END_TEST

/* ---- What is no scenario -------------------------------------------------------------------------------------------- */

START_TEST(errors_name_the_place_and_what_was_expected)
{
    expect_error("", "error: ");
    expect_error("steps", "1:1: error: expected a map");
    expect_error("name: x\n", "1:1: error: expected steps");
    expect_error("steps: 5\n", "1:8: error: expected steps, a list");
    expect_error("steps: []\n", "1:8: error: expected steps, a list");
    expect_error("step: []\nsteps: [{advance: 1s}]\n", "1:1: error: expected name,");
    expect_error("units: 17\nsteps: [{advance: 1s}]\n", "1:8: error: expected addresses from 1 to 16");
    expect_error("baud: 9600\nsteps: [{advance: 1s}]\n", "1:7: error: expected baud, 19200 or 0");
    expect_error("framing: x25\nsteps: [{advance: 1s}]\n", "1:10: error: expected framing, hdlc or plain");
    expect_error("turnaround: 2s\nsteps: [{advance: 1s}]\n", "1:13: error: expected turnaround of at most");
    expect_error("speed_change_latency: 3s\nsteps: [{advance: 1s}]\n", "1:23: error: expected speed_change_latency of at most");
    expect_error("readings: latch\nsteps: [{advance: 1s}]\n", "1:11: error: expected readings, a map as in {hold-exit: latch}");
    expect_error("readings: {hold-exti: latch}\nsteps: [{advance: 1s}]\n",
                 "1:12: error: unknown reading `hold-exti'; did you mean");
    expect_error("readings: {hold-exit: no}\nsteps: [{advance: 1s}]\n",
                 "1:23: error: hold-exit: expected new or latch, found `no'");
    expect_error("readings: {speed-change: 1}\nspeed_change_latency: 1ms\nsteps: [{advance: 1s}]\n",
                 "2:23: error: speed-change is given twice");
    expect_error("seed: -1\nsteps: [{advance: 1s}]\n", "1:7: error: expected seed");
    expect_error("plant: none.yaml\nsteps: [{advance: 1s}]\n", "1:8: error: cannot read folder/none.yaml: it is not there");
    expect_error("plant: {foo: 1}\nsteps: [{advance: 1s}]\n", "1:8: error: ");
    expect_error("di: {\"09\": 1}\nsteps: [{advance: 1s}]\n", "1:5: error: ");
    expect_error("always: [{motor: 9}]\nsteps: [{advance: 1s}]\n", "1:10: error: condition: nothing to wait for");
    expect_error(QUIET "  - advance: 5\n", "3:14: error: expected advance, a time with its unit");
    expect_error(QUIET "  - advance: 5s\n    within: 7s\n", "4:5: error: expected advance, at or label");
    expect_error(QUIET "  - {set: 'R', motor: 5}\n", "3:23: error: expected motor");
    expect_error(QUIET "  - {wait: {t: 1}, within: 1s, not_before: 2s}\n", "expected a time before within");
    expect_error(QUIET "  - {message: '0'}\n", "3:15: error: expected bytes");
    expect_error(QUIET "  - {message: '\"x'}\n", "3:15: error: expected bytes");
    expect_error(QUIET "  - {message: '01 *'}\n", "3:15: error: expected message without .. and *");
    expect_error(QUIET "  - {message: '01', answer: '01 * 02'}\n", "3:29: error: expected bytes");
    expect_error(QUIET "  - {message: '01', unit: all, answer: any}\n", "expected none: no unit answers");
    expect_error(QUIET "  - {pulses: {motor: 1, count: -1}}\n", "error: expected count");
    expect_error(QUIET "  - {pulses: {motor: 1, count: 1, since: noon}}\n", "error: expected start or last");
    expect_error(QUIET "  - {expect: {message: {number: 1}}}\n", "3:14: error: expected a state: for a message");
    expect_error(QUIET "  - {stays: {t: 1}}\n", "3:5: error: expected for");
    expect_error("stimuli: [{di: {\"01\": 1}}]\nsteps: [{advance: 1s}]\n", "1:11: error: expected either at or when");
    expect_error("stimuli: [{at: 1s, set: 'R'}]\nsteps: [{advance: 1s}]\n", "1:11: error: expected one of di, expect, power");
}
END_TEST

START_TEST(all_errors_are_reported_at_once)
{
    expect_error(QUIET "  - {set: 5, foo: 1}\n  - {wat: {motor: 1}}\n  - {advance: 1}\n", ":3:");
    ck_assert_ptr_nonnull(strstr(said, ":4:5: error: "));
    ck_assert_ptr_nonnull(strstr(said, ":5:15: error: "));
}
END_TEST

START_TEST(a_program_longer_than_a_request_is_refused)
{
    char *text = malloc(20000);
    int length = sprintf(text, QUIET "  - set: '%*s'\n", RKM04_MESSAGE_MAX - 1, "R");
    ck_assert_int_gt(length, RKM04_MESSAGE_MAX);
    expect_error(text, "3:5: error: expected a program of up to 9214 bytes");
    free(text);
}
END_TEST

/* Each byte of a scenario turned into something else, each of its beginnings: read, or refused; nothing worse. */
START_TEST(damaged_scenarios_do_no_harm)
{
    static const char text[] = "units: 1,2\ndi: {\"01\": 1}\nalways: [{t: {\">=\": 0}}]\n"
                               "stimuli: [{at: 1s, fault: {kind: drop}}]\nsteps:\n"
                               "  - {message: '04 \"1\"', unit: 1, answer: '04 .. *'}\n"
                               "  - {wait: {any: [{motor: 1, position: 5}]}, unit: 2, within: 5ms}\n"
                               "  - {pulses: {motor: 1, count: {\">\": 1}}, unit: 1}\n";
    static const char bad[] = {'\0', '\xFF', '{', ']', ':', '9', '"', '\n', '-', '*', '&', 'x'};
    char damaged[sizeof text];
    for (size_t i = 0; i < sizeof text - 1; i++) {
        scenario_free(read_bytes(text, i));
        for (size_t b = 0; b < sizeof bad; b++) {
            memcpy(damaged, text, sizeof text);
            damaged[i] = bad[b];
            struct scenario *scenario = read_bytes(damaged, sizeof text - 1);
            ck_assert_msg(scenario != NULL || said[0] != '\0', "byte %zu refused without a word", i);
            scenario_free(scenario);
        }
    }
}
END_TEST

/* ---- Runs ----------------------------------------------------------------------------------------------------------- */

static bool stop_soon(void *context, uint64_t tick)
{
    *(uint64_t *)context = tick;
    return tick > 1000 * SECOND;
}

START_TEST(a_run_can_be_interrupted)
{
    static const char text[] = "steps: [{set: '@1 F1000 R B1000 R J1'}, {advance: 1000000s}]\n";
    uint64_t tick = 0;
    struct scenario *scenario = read_bytes(text, sizeof text - 1);
    ck_assert_ptr_nonnull(scenario);
    ck_assert_int_eq(scenario_run(scenario, NULL, stop_soon, &tick, &result), SCENARIO_INTERRUPTED);
    ck_assert_uint_gt(tick, 1000 * SECOND);
    ck_assert_uint_lt(tick, 2000 * SECOND);
    scenario_free(scenario);
}
END_TEST

START_TEST(a_scenario_can_be_run_again)
{
    static const char text[] = "name: twice\nsteps: [{set: 'F5 R'}, {wait: {motor: 1, position: 5}}]\n";
    struct scenario *scenario = read_bytes(text, sizeof text - 1);
    ck_assert_ptr_nonnull(scenario);
    ck_assert_str_eq(scenario_name(scenario), "twice");
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_PASSED);
    uint64_t tick = result.tick;
    ck_assert_int_eq(scenario_run(scenario, NULL, NULL, NULL, &result), SCENARIO_PASSED);
    ck_assert_uint_eq(result.tick, tick);
    scenario_free(scenario);
}
END_TEST

static void expect_notation(const char *text, const char *printed)
{
    struct scenario_bytes bytes;
    char *is;
    size_t length;
    ck_assert_ptr_null(scenario_bytes_read(&bytes, text));
    FILE *out = open_memstream(&is, &length);
    scenario_bytes_print(out, &bytes);
    fclose(out);
    ck_assert_str_eq(is, printed);
    free(is);
    scenario_bytes_free(&bytes);
}

START_TEST(bytes_are_printed_as_they_are_written)
{
    expect_notation("04 \"1\" 0a \"   0\"", "04 \"1\" 0A \"   0\"");
    expect_notation("  02 31 41 42 22", "02 \"1AB\" 22");
    expect_notation("31 31", "31 \"1\"");
    expect_notation("01.. .. 30 *", "01 .. .. \"0\" *");
    expect_notation("", "");
}
END_TEST

static void add_tests(TCase *tcase, Suite *suite)
{
    tcase_add_checked_fixture(tcase, setup, teardown);
    suite_add_tcase(suite, tcase);
}

static TCase *steps_case(void)
{
    TCase *steps = tcase_create("steps");
    tcase_add_test(steps, a_program_runs_to_its_end);
    tcase_add_test(steps, U7_bytes_take_their_time_unless_baud_is_0);
    tcase_add_test(steps, a_program_may_be_in_a_file_beside_the_scenario);
    tcase_add_test(steps, answers_are_compared_byte_by_byte);
    tcase_add_test(steps, P1_a_program_must_be_taken_unless_another_flag_is_expected);
    tcase_add_test(steps, L3_what_is_sent_to_all_is_not_answered);
    tcase_add_test(steps, a_unit_without_power_is_silent);
    tcase_add_test(steps, L1_raw_bytes_are_put_on_the_line_as_they_are);
    tcase_add_test(steps, inputs_power_and_reset_act_at_once);
    tcase_add_test(steps, inputs_at_power_up_are_those_of_all_units);
    tcase_add_test(steps, any_method_that_acts_at_once_can_be_called);
    tcase_add_test(steps, pulses_are_counted_by_direction_and_since_the_last_expectation);
    return steps;
}

static TCase *time_case(void)
{
    TCase *time = tcase_create("time");
    tcase_add_test(time, a_wait_has_an_end_and_a_beginning);
    tcase_add_test(time, what_stays_has_to_stay_at_every_tick);
    tcase_add_test(time, a_step_may_have_its_time);
    tcase_add_test(time, what_must_hold_always_is_checked_all_the_time);
    tcase_add_test(time, C7_a_fault_fails_unless_it_is_allowed);
    tcase_add_test(time, stimuli_come_at_times_and_on_conditions_whatever_the_steps_do);
    tcase_add_test(time, a_stimulus_that_never_acts_is_a_failure);
    tcase_add_test(time, stimuli_that_call_for_each_other_come_to_an_end);
    return time;
}

static Suite *scenario_suite(void)
{
    Suite *suite = suite_create("scenario");
    add_tests(steps_case(), suite);
    add_tests(time_case(), suite);

    TCase *around = tcase_create("around");
    tcase_add_test(around, faults_on_demand_can_be_used);
    tcase_add_test(around, two_units_of_one_address_can_be_told_apart);
    tcase_add_test(around, L2_another_framing_can_be_chosen);
    tcase_add_test(around, C4_the_latency_of_a_change_of_speed_can_be_set);
    tcase_add_test(around, readings_can_be_set_and_are_kept);
    tcase_add_test(around, a_run_is_under_the_readings_that_were_set);
    add_tests(around, suite);

    TCase *reading = tcase_create("reading");
    tcase_add_test(reading, errors_name_the_place_and_what_was_expected);
    tcase_add_test(reading, all_errors_are_reported_at_once);
    tcase_add_test(reading, a_program_longer_than_a_request_is_refused);
    tcase_add_test(reading, damaged_scenarios_do_no_harm);
    tcase_add_test(reading, bytes_are_printed_as_they_are_written);
    tcase_set_timeout(reading, 60);
    add_tests(reading, suite);

    TCase *runs = tcase_create("runs");
    tcase_add_test(runs, a_run_can_be_interrupted);
    tcase_add_test(runs, a_scenario_can_be_run_again);
    add_tests(runs, suite);
    return suite;
}

int main(void)
{
    return rig_run(scenario_suite(), "./test_scenario");
}
