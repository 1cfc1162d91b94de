/* SPDX-License-Identifier: MIT */
/* test_trace_vcd.c: traces as value change dumps. One test alone: CK_RUN_CASE=signals ./test_trace_vcd */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "trace_rig.h"

/* Ids of one unit's signals, as the head declares them. */
#define STEP_1 "B"
#define DIR_1 "C"
#define LED_1 "D"
#define MOVING_1 "E"
#define COMMAND_1 "F"
#define SPEED_1 "G"
#define POSITION_1 "H"

static void vcd(void)
{
    trace_rig_begin("1", TRACE_VCD);
}

/* What follows the values at the beginning. */
static const char *changes(void)
{
    static const char end[] = "\n$end\n";
    const char *text = strstr(trace_rig_text(), "$dumpvars\n");
    ck_assert_ptr_nonnull(text);
    return strstr(text, end) + sizeof end - 1;
}

/* The line declares the signal `name` with this id. */
static void declares(const char *text, const char *type, const char *id, const char *name)
{
    char line[80];
    snprintf(line, sizeof line, "\n$var %s %s %s $end\n", type, id, name);
    ck_assert_msg(strstr(text, line) != NULL, "expected '%s'", line + 1);
}

/* The changes of the signal `id`, a line each with the time in front: "14000 1". To be freed. */
static char *changes_of(const char *id)
{
    char *copy = strdup(changes()), *list = calloc(1, strlen(copy) + 100000), *at = list, *rest;
    char tick[24] = "?";
    for (char *line = strtok_r(copy, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        size_t length = strlen(line), tail = strlen(id);
        if (*line == '#')
            snprintf(tick, sizeof tick, "%s", line + 1);
        else if (length > tail && strcmp(line + length - tail, id) == 0)
            at += sprintf(at, "%s %.*s\n", tick, (int)(length - tail), line);
    }
    free(copy);
    return list;
}

/* ---- Signals -------------------------------------------------------------------------------------------------------- */

START_TEST(every_signal_has_a_name_of_its_own)
{
    const char *text = trace_rig_text();
    declares(text, "wire 1", "!", "power");
    declares(text, "wire 1", "\"", "di01");
    declares(text, "wire 1", "1", "do08");
    declares(text, "wire 1", "2", "var80");
    declares(text, "wire 1", "A", "var95");
    declares(text, "wire 1", STEP_1, "m1_step");
    declares(text, "wire 1", DIR_1, "m1_dir");
    declares(text, "wire 1", LED_1, "m1_led");
    declares(text, "wire 1", MOVING_1, "m1_moving");
    declares(text, "real 64", COMMAND_1, "m1_command");
    declares(text, "real 64", SPEED_1, "m1_speed");
    declares(text, "real 64", POSITION_1, "m1_position");
    declares(text, "real 64", "]", "m4_position");
    ck_assert_ptr_nonnull(strstr(text, "\n$timescale 1 us $end\n"));
}
END_TEST

START_TEST(with_several_units_a_name_begins_with_the_unit)
{
    trace_rig_end();
    trace_rig_begin("3,7,3", TRACE_VCD);
    const char *text = trace_rig_text();
    declares(text, "wire 1", "!", "u3_power");
    declares(text, "wire 1", "B", "u3_m1_step");
    declares(text, "wire 1", "^", "u7_power");
    declares(text, "wire 1", "!=", "u3_2_power"); /* 122 = 94 + 28 */
    declares(text, "real 64", "!y", "u3_2_m4_position");
}
END_TEST

START_TEST(R7_a_pulse_is_10_us_wide)
{
    trace_rig_set(1, '1', "S100 V100 F2 R");
    sim_advance(trace_rig_sim(), 30000);
    ck_assert_str_eq(changes(), "#1000\nr1 F\n#2000\nr2 F\n#3000\nr3 F\n#4000\nr4 F\n1C\n1D\n1E\n"
                                "#14000\n1B\nr1 H\nr100 G\n#14010\n0B\n"
                                "#24000\n1B\nr2 H\n0D\n0E\nr0 G\n#24010\n0B\n#25000\nr0 F\n#30000\n");
}
END_TEST

START_TEST(only_the_bits_that_change_are_written)
{
    struct sim *sim = trace_rig_sim();
    sim_advance(sim, 10);
    sim_set_di(sim, 1, 0x81);
    sim_advance(sim, 20);
    sim_set_di(sim, 1, 0x82);
    sim_advance(sim, 30);
    happens(40, WATCH_TURNS, 0, WATCH_OUTPUTS, 0x10);
    happens(41, WATCH_TURNS, 0, WATCH_VARIABLES, 0x8001);
    happens(42, WATCH_TURNS, 0, WATCH_VARIABLES, 0x8000);
    ck_assert_str_eq(changes(), "#10\n1\"\n1)\n#20\n0\"\n1#\n#40\n1.\n#41\n12\n1A\n#42\n02\n");
}
END_TEST

START_TEST(a_position_is_signed)
{
    happens(10, WATCH_PULSES, 1, WATCH_STEP, -1);
    happens(100, WATCH_PULSES, 1, WATCH_STEP, INT32_MIN);
    ck_assert_str_eq(changes(), "#10\n1B\nr-1 H\n#20\n0B\n#100\n1B\nr-2147483648 H\n");
}
END_TEST

START_TEST(a_position_that_is_set_is_seen_at_once)
{
    trace_rig_set(1, '1', "=-2000000000 C100");
    sim_advance(trace_rig_sim(), 2500);
    ck_assert_str_eq(changes(), "#1000\nr1 F\nr-2000000000 H\n#2000\nr2 F\nr0 H\n#2500\n");
}
END_TEST

START_TEST(the_values_at_the_beginning_are_those_there_are)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '2', "S100 V100 T03 T90 F50 R");
    sim_set_di(sim, 1, 0x42);
    sim_advance(sim, 100000);
    trace_rig_end_trace();
    trace_rig_begin_trace(TRACE_VCD);
    static const char *const values[] = {"\n1!\n", "\n0\"\n", "\n1#\n", "\n1(\n", "\n1,\n", "\n1<\n", "\n0I\n", "\n1J\n",
                                         "\n1K\n", "\n1L\n",  "\nr6 M\n", "\nr100 N\n", "\nr9 O\n"};
    const char *text = strstr(trace_rig_text(), "\n#100000\n$dumpvars\n");
    ck_assert_ptr_nonnull(text);
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++)
        ck_assert_msg(strstr(text, values[i]) != NULL, "expected '%s'", values[i]);
}
END_TEST

/* ---- What follows of itself ----------------------------------------------------------------------------------------- */

START_TEST(U6_a_blinking_LED_blinks)
{
    trace_rig_set(1, '1', "F10 Y B10 Y R");
    sim_advance(trace_rig_sim(), 1600000);
    char *led = changes_of(LED_1);
    ck_assert_str_eq(led, "5000 1\n505000 0\n1005000 1\n1505000 0\n");
    free(led);
}
END_TEST

START_TEST(U6_a_trace_that_begins_while_a_LED_blinks_goes_on_with_it)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '1', "F10 Y B10 Y R");
    sim_advance(sim, 600000);
    trace_rig_end_trace();
    trace_rig_begin_trace(TRACE_VCD);
    trace_rig_set(1, '1', "\\");
    sim_advance(sim, 700000);
    trace_rig_set(1, '1', "F10 Y B10 Y R");
    sim_advance(sim, 1300000);
    char *led = changes_of(LED_1);
    ck_assert_str_eq(led, "704000 1\n1204000 0\n");
    free(led);
    trace_rig_end_trace();
    trace_rig_begin_trace(TRACE_VCD);
    sim_advance(sim, 2000000);
    led = changes_of(LED_1);
    ck_assert_str_eq(led, "1704000 1\n");
    free(led);
}
END_TEST

/* At 60 000 steps/s^2 a millisecond changes the speed by 60 steps/s; a count of whole pulses is wrong by up to a tick. */
START_TEST(the_speed_is_that_of_the_pulses)
{
    trace_rig_set(1, '1', "S2000 V16000 A60000 F8000 R");
    sim_advance(trace_rig_sim(), 1000000);
    char *speed = changes_of(SPEED_1), *rest;
    double highest = 0, last = -1;
    unsigned count = 0;
    for (char *line = strtok_r(speed, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
        uint64_t tick = strtoull(line, &line, 10);
        last = strtod(line + 2, NULL);
        double time = (double)tick / 1e6 - 0.005; /* R is the fifth command */
        if (last > 0 && time < 0.233)
            ck_assert_msg(last > 2000 + 60000 * time - 110 && last < 2000 + 60000 * time + 20, "%g steps/s at %g s", last, time);
        highest = last > highest ? last : highest;
        count++;
    }
    ck_assert_double_eq(highest, 16000);
    ck_assert_double_eq(last, 0);
    ck_assert_uint_gt(count, 400);
    free(speed);
}
END_TEST

START_TEST(without_power_everything_but_the_inputs_is_0)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '1', "S100 V100 T01 T80 F2 R");
    sim_set_di(sim, 1, 1);
    sim_advance(sim, 16005); /* in the middle of the first pulse */
    sim_power(sim, 1, false);
    sim_advance(sim, 20000);
    sim_power(sim, 1, true);
    sim_advance(sim, 40000);
    static const struct {
        const char *id, *changes;
    } signals[] = {
        {"!", "16005 0\n20000 1\n"}, {STEP_1, "16000 1\n16005 0\n20000 0\n"}, {DIR_1, "6000 1\n16005 0\n20000 0\n"},
        {LED_1, "6000 1\n16005 0\n20000 0\n"}, {"*", "3000 1\n16005 0\n20000 0\n"}, {"2", "4000 1\n16005 0\n20000 0\n"},
        {POSITION_1, "16000 r1 \n16005 r0 \n20000 r0 \n"}, {"\"", "0 1\n16005 1\n20000 1\n"},
    };
    char *text = strdup(trace_rig_text());
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++) {
        char tick[24] = "0", list[400] = "", *copy = strdup(strstr(strstr(text, "$dumpvars"), "$end") + 4), *rest;
        for (char *line = strtok_r(copy, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest)) {
            size_t length = strlen(line) - 1;
            if (*line == '#')
                snprintf(tick, sizeof tick, "%s", line + 1);
            else if (strcmp(line + length, signals[i].id) == 0)
                sprintf(list + strlen(list), "%s %.*s\n", tick, (int)length, line);
        }
        ck_assert_str_eq(list, signals[i].changes);
        free(copy);
    }
    free(text);
}
END_TEST

static Suite *vcd_suite(void)
{
    Suite *suite = suite_create("trace_vcd");
    TCase *signals = tcase_create("signals");
    tcase_add_checked_fixture(signals, vcd, trace_rig_end);
    tcase_add_test(signals, every_signal_has_a_name_of_its_own);
    tcase_add_test(signals, with_several_units_a_name_begins_with_the_unit);
    tcase_add_test(signals, R7_a_pulse_is_10_us_wide);
    tcase_add_test(signals, only_the_bits_that_change_are_written);
    tcase_add_test(signals, a_position_is_signed);
    tcase_add_test(signals, a_position_that_is_set_is_seen_at_once);
    tcase_add_test(signals, the_values_at_the_beginning_are_those_there_are);
    suite_add_tcase(suite, signals);
    TCase *time = tcase_create("time");
    tcase_add_checked_fixture(time, vcd, trace_rig_end);
    tcase_add_test(time, U6_a_blinking_LED_blinks);
    tcase_add_test(time, U6_a_trace_that_begins_while_a_LED_blinks_goes_on_with_it);
    tcase_add_test(time, the_speed_is_that_of_the_pulses);
    tcase_add_test(time, without_power_everything_but_the_inputs_is_0);
    suite_add_tcase(suite, time);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(vcd_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=signals|time ./test_trace_vcd");
    return failed > 0;
}
