/* SPDX-License-Identifier: MIT */
/* test_trace.c: CSV traces of a line. One test alone: CK_RUN_CASE=order ./test_trace */
#include <check.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "trace_rig.h"

#define HEADER "t_us,source,event,value\n"

static void csv(void)
{
    trace_rig_begin("1", TRACE_CSV);
}

START_TEST(a_trace_of_nothing_is_its_header)
{
    ck_assert_str_eq(trace_rig_text(), HEADER);
}
END_TEST

START_TEST(every_event_has_its_row)
{
    happens(0, WATCH_DELIVERED, 0, WATCH_INPUTS, 0x81);
    happens(1000, WATCH_TURNS, 1, WATCH_COMMAND, 700);
    happens(1000, WATCH_TURNS, 1, WATCH_DIRECTION, 0);
    happens(1000, WATCH_TURNS, 1, WATCH_MOTION, 1);
    happens(1000, WATCH_TURNS, 1, WATCH_LED, RKM04_LED_ON);
    happens(1020, WATCH_PULSES, 1, WATCH_STEP, INT32_MIN);
    happens(1030, WATCH_PULSES, 4, WATCH_STEP, INT32_MAX);
    happens(1030, WATCH_TURNS, 4, WATCH_MOTION, 0);
    happens(1030, WATCH_TURNS, 4, WATCH_LED, RKM04_LED_OFF);
    happens(2000, WATCH_TURNS, 2, WATCH_LED, RKM04_LED_BLINK);
    happens(2000, WATCH_TURNS, 3, WATCH_DIRECTION, 1);
    happens(2000, WATCH_TURNS, 0, WATCH_OUTPUTS, 255);
    happens(2500, WATCH_DELIVERED, 0, WATCH_POWER, 0);
    happens(2500, WATCH_DELIVERED, 0, WATCH_POWER, 1);
    happens(UINT64_MAX - 1, WATCH_TURNS, 0, WATCH_VARIABLES, 65535);
    ck_assert_str_eq(trace_rig_text(), HEADER "0,unit,di,129\n"
                                              "1000,m1,command,700\n"
                                              "1000,m1,dir,-1\n"
                                              "1000,m1,motion,begin\n"
                                              "1000,m1,led,on\n"
                                              "1020,m1,step,-2147483648\n"
                                              "1030,m4,step,2147483647\n"
                                              "1030,m4,motion,end\n"
                                              "1030,m4,led,off\n"
                                              "2000,m2,led,blink\n"
                                              "2000,m3,dir,1\n"
                                              "2000,unit,do,255\n"
                                              "2500,unit,power,off\n"
                                              "2500,unit,power,on\n"
                                              "18446744073709551614,unit,var,65535\n");
}
END_TEST

START_TEST(with_several_units_the_source_begins_with_the_name_of_the_unit)
{
    trace_rig_end();
    trace_rig_begin("3,12,3", TRACE_CSV);
    trace_rig_set(1, '1', "S100 V100 F1 R T01");
    trace_rig_set(3, '4', "S100 V100 B1 R");
    sim_advance(trace_rig_sim(), 20000);
    ck_assert_str_eq(trace_rig_text(), HEADER "1000,3.m1,command,1\n1000,3-2.m4,command,1\n"
                                              "2000,3.m1,command,2\n2000,3-2.m4,command,2\n"
                                              "3000,3.m1,command,3\n3000,3-2.m4,command,3\n"
                                              "4000,3.m1,command,4\n4000,3.m1,dir,1\n"
                                              "4000,3.m1,led,on\n4000,3.m1,motion,begin\n"
                                              "4000,3-2.m4,command,4\n"
                                              "4000,3-2.m4,led,on\n4000,3-2.m4,motion,begin\n"
                                              "14000,3.m1,step,1\n14000,3-2.m4,step,-1\n"
                                              "14000,3.m1,led,off\n14000,3.m1,motion,end\n"
                                              "14000,3-2.m4,led,off\n14000,3-2.m4,motion,end\n"
                                              "15000,3.m1,command,5\n15000,3.unit,do,1\n15000,3-2.m4,command,0\n"
                                              "16000,3.m1,command,0\n");
}
END_TEST

START_TEST(a_trace_that_begins_later_begins_with_what_is_not_as_after_power_up)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '2', "S100 V100 T03 T90 F50 R");
    sim_set_di(sim, 1, 0x42);
    sim_advance(sim, 100000);
    trace_rig_end_trace();
    trace_rig_begin_trace(TRACE_CSV);
    ck_assert_str_eq(trace_rig_text(), HEADER "100000,unit,di,66\n100000,unit,do,4\n100000,unit,var,1024\n"
                                              "100000,m2,position,9\n100000,m2,command,6\n100000,m2,dir,1\n"
                                              "100000,m2,led,on\n100000,m2,motion,begin\n");
}
END_TEST

START_TEST(a_counter_that_is_set_has_a_row)
{
    trace_rig_set(1, '1', "=-7 =-7 C100 C100");
    sim_advance(trace_rig_sim(), 5000);
    ck_assert_str_eq(trace_rig_text(), HEADER "1000,m1,command,1\n1000,m1,position,-7\n2000,m1,command,2\n"
                                              "3000,m1,command,3\n3000,m1,position,0\n4000,m1,command,4\n");
}
END_TEST

START_TEST(C11_under_T41_the_end_of_a_motion_tells_where_the_counter_is)
{
    trace_rig_set(1, '1', "S100 V100 T41 B2 R");
    sim_advance(trace_rig_sim(), 26000);
    ck_assert_str_eq(strstr(trace_rig_text(), "5000,m1,motion,begin\n"),
                     "5000,m1,motion,begin\n25000,m1,led,off\n25000,m1,position,-2\n25000,m1,motion,end\n");
}
END_TEST

/* ---- Order ---------------------------------------------------------------------------------------------------------- */

START_TEST(rows_of_several_motors_come_in_the_order_of_time)
{
    for (unsigned motor = 1; motor <= 4; motor++) {
        for (int i = 0; i < 3; i++)
            happens(1000 + (uint64_t)i * 100 + motor, WATCH_PULSES, motor, WATCH_STEP, i);
    }
    ck_assert_str_eq(trace_rig_text(), HEADER "1001,m1,step,0\n1002,m2,step,0\n1003,m3,step,0\n1004,m4,step,0\n"
                                              "1101,m1,step,1\n1102,m2,step,1\n1103,m3,step,1\n1104,m4,step,1\n"
                                              "1201,m1,step,2\n1202,m2,step,2\n1203,m3,step,2\n1204,m4,step,2\n");
}
END_TEST

START_TEST(K2_in_a_tick_what_is_delivered_comes_first_then_pulses_then_the_turns)
{
    happens(5000, WATCH_PULSES, 1, WATCH_STEP, 1);
    happens(5000, WATCH_TURNS, 1, WATCH_MOTION, 0);
    happens(5000, WATCH_PULSES, 2, WATCH_STEP, 2);
    happens(5000, WATCH_TURNS, 1, WATCH_COMMAND, 0);
    happens(5000, WATCH_DELIVERED, 0, WATCH_INPUTS, 1);
    happens(5000, WATCH_TURNS, 2, WATCH_COMMAND, 7);
    ck_assert_str_eq(trace_rig_text(), HEADER "5000,unit,di,1\n"
                                              "5000,m1,step,1\n"
                                              "5000,m2,step,2\n"
                                              "5000,m1,motion,end\n"
                                              "5000,m1,command,0\n"
                                              "5000,m2,command,7\n");
}
END_TEST

START_TEST(rows_wait_until_nothing_earlier_can_come)
{
    struct sim *sim = trace_rig_sim();
    happens(10, WATCH_PULSES, 1, WATCH_STEP, 1);
    happens(30, WATCH_PULSES, 1, WATCH_STEP, 3);
    watch_deliver(&sim->watch, 30);
    happens(30, WATCH_DELIVERED, 0, WATCH_INPUTS, 2);
    ck_assert_str_eq(trace_rig_so_far(), HEADER "10,m1,step,1\n");
    ck_assert_str_eq(trace_rig_text(), HEADER "10,m1,step,1\n30,unit,di,2\n30,m1,step,3\n");
}
END_TEST

START_TEST(more_rows_than_there_is_room_for_are_all_written)
{
    const int rows = 50000;
    for (int i = 0; i < rows; i++)
        happens(42, WATCH_DELIVERED, 0, WATCH_INPUTS, i);
    const char *at = trace_rig_text() + strlen(HEADER);
    for (int i = 0; i < rows; i++) {
        char line[32];
        int n = sprintf(line, "42,unit,di,%d\n", i);
        ck_assert_mem_eq(at, line, (size_t)n);
        at += n;
    }
    ck_assert_int_eq(*at, '\0');
}
END_TEST

START_TEST(what_is_delivered_in_the_last_tick_is_in_the_trace)
{
    struct sim *sim = trace_rig_sim();
    sim_advance(sim, 500);
    sim_set_di(sim, 1, 1);
    ck_assert_str_eq(trace_rig_text(), HEADER "500,unit,di,1\n");
}
END_TEST

/* The trace of a program, with time cut into pieces of `piece` ticks. */
static char *cut_into(enum trace_format format, uint64_t piece)
{
    trace_rig_begin("1-2", format);
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '0', "S300 V16000 A60000 @1 T85 F500 Y V100 Y R C85 W3 J1");
    trace_rig_set(2, '3', "@1 F900 R W7 D R T02 J1");
    trace_rig_set(2, '1', "F10 Y B10 Y R");
    for (uint64_t tick = piece; tick <= 700000; tick += piece)
        sim_advance(sim, tick);
    sim_advance(sim, 700000);
    char *text = strdup(trace_rig_text());
    trace_rig_end();
    return text;
}

START_TEST(K3_a_trace_does_not_depend_on_how_time_is_cut)
{
    static const uint64_t pieces[] = {1, 7, 999, 1000, 123457};
    for (int format = 0; format < TRACE_FORMATS; format++) {
        char *whole = cut_into((enum trace_format)format, 700000);
        for (size_t i = 0; i < sizeof pieces / sizeof pieces[0]; i++) {
            char *text = cut_into((enum trace_format)format, pieces[i]);
            ck_assert_msg(strcmp(text, whole) == 0, "format %d, pieces of %d ticks", format, (int)pieces[i]);
            free(text);
        }
        free(whole);
    }
}
END_TEST

/* ---- Names and failures --------------------------------------------------------------------------------------------- */

START_TEST(the_name_of_a_file_chooses_the_format)
{
    ck_assert_int_eq(trace_file_format("run.vcd"), TRACE_VCD);
    ck_assert_int_eq(trace_file_format("a/b.c/run.csv"), TRACE_CSV);
    ck_assert_int_eq(trace_file_format("run.vcd.jsonl"), TRACE_JSONL);
    static const char *const none[] = {"", "vcd", ".vcd", "a/.csv", "run.VCD", "run.vcd ", "run.csv.gz", "-", "run.json"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
        ck_assert_msg(!trace_file_named(none[i]), "'%s'", none[i]);
}
END_TEST

START_TEST(a_file_that_cannot_be_opened_is_told_with_the_reason)
{
    char *error;
    ck_assert_ptr_null(trace_file_begin(trace_rig_sim(), "/no/such/folder/run.vcd", 0, &error));
    ck_assert_str_eq(error, "cannot write /no/such/folder/run.vcd: No such file or directory");
    free(error);
    ck_assert_ptr_null(trace_file_begin(trace_rig_sim(), "run.txt", 0, &error));
    ck_assert_str_eq(error, "run.txt: expected a name that ends with .vcd, .csv or .jsonl");
    free(error);
}
END_TEST

START_TEST(a_device_that_is_full_is_told)
{
    FILE *full = fopen("/dev/full", "w");
    ck_assert_ptr_nonnull(full);
    struct trace_file *trace = trace_file_begin_on(trace_rig_sim(), full, (enum trace_format)_i);
    for (int i = 0; i < 100000; i++) {
        happens((uint64_t)i, WATCH_PULSES, 1, WATCH_STEP, i);
        watch_deliver(&trace_rig_sim()->watch, (uint64_t)i);
    }
    ck_assert_int_eq(trace_file_failed(trace), ENOSPC);
    ck_assert_int_eq(trace_file_end(trace), ENOSPC);
    fclose(full);
}
END_TEST

START_TEST(a_short_trace_that_cannot_be_written_is_told_at_its_end)
{
    FILE *full = fopen("/dev/full", "w");
    ck_assert_ptr_nonnull(full);
    struct trace_file *trace = trace_file_begin_on(trace_rig_sim(), full, (enum trace_format)_i);
    ck_assert_int_eq(trace_file_end(trace), ENOSPC);
    fclose(full);
}
END_TEST

static Suite *trace_suite(void)
{
    Suite *suite = suite_create("trace");
    TCase *rows = tcase_create("rows");
    tcase_add_checked_fixture(rows, csv, trace_rig_end);
    tcase_add_test(rows, a_trace_of_nothing_is_its_header);
    tcase_add_test(rows, every_event_has_its_row);
    tcase_add_test(rows, with_several_units_the_source_begins_with_the_name_of_the_unit);
    tcase_add_test(rows, a_trace_that_begins_later_begins_with_what_is_not_as_after_power_up);
    tcase_add_test(rows, a_counter_that_is_set_has_a_row);
    tcase_add_test(rows, C11_under_T41_the_end_of_a_motion_tells_where_the_counter_is);
    suite_add_tcase(suite, rows);
    TCase *order = tcase_create("order");
    tcase_add_checked_fixture(order, csv, trace_rig_end);
    tcase_add_test(order, rows_of_several_motors_come_in_the_order_of_time);
    tcase_add_test(order, K2_in_a_tick_what_is_delivered_comes_first_then_pulses_then_the_turns);
    tcase_add_test(order, rows_wait_until_nothing_earlier_can_come);
    tcase_add_test(order, more_rows_than_there_is_room_for_are_all_written);
    tcase_add_test(order, what_is_delivered_in_the_last_tick_is_in_the_trace);
    suite_add_tcase(suite, order);
    TCase *cut = tcase_create("cut");
    tcase_set_timeout(cut, 120);
    tcase_add_test(cut, K3_a_trace_does_not_depend_on_how_time_is_cut);
    suite_add_tcase(suite, cut);
    TCase *failures = tcase_create("failures");
    tcase_add_checked_fixture(failures, csv, trace_rig_end);
    tcase_add_test(failures, the_name_of_a_file_chooses_the_format);
    tcase_add_test(failures, a_file_that_cannot_be_opened_is_told_with_the_reason);
    tcase_add_loop_test(failures, a_device_that_is_full_is_told, 0, TRACE_FORMATS);
    tcase_add_loop_test(failures, a_short_trace_that_cannot_be_written_is_told_at_its_end, 0, TRACE_FORMATS);
    suite_add_tcase(suite, failures);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(trace_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=rows|order|cut|failures ./test_trace");
    return failed > 0;
}
