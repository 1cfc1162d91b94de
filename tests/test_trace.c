/* test_trace.c: the CSV trace of `rkm04 exec`. One test alone: CK_RUN_CASE=order ./test_trace */
#include <check.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#include "sim/trace.h"

#define HEADER "t_us,source,event,value\n"

static struct trace trace;
static FILE *out;
static char *text;
static size_t length;

static void begin(void)
{
    out = open_memstream(&text, &length);
    ck_assert_ptr_nonnull(out);
    trace_begin(&trace, out);
}

static void end(void)
{
    fclose(out);
    free(text);
}

static const char *finished(void)
{
    ck_assert_int_eq(trace_finish(&trace), 0);
    return text;
}

START_TEST(a_trace_of_nothing_is_its_header)
{
    ck_assert_str_eq(finished(), HEADER);
}
END_TEST

START_TEST(every_event_has_its_row)
{
    trace_add(&trace, 0, TRACE_DELIVERED, 0, TRACE_INPUTS, 0x81);
    trace_add(&trace, 1000, TRACE_TURNS, 1, TRACE_COMMAND, 700);
    trace_add(&trace, 1000, TRACE_TURNS, 1, TRACE_DIRECTION, -1);
    trace_add(&trace, 1000, TRACE_TURNS, 1, TRACE_MOTION, 1);
    trace_add(&trace, 1000, TRACE_TURNS, 1, TRACE_LED, RKM04_LED_ON);
    trace_add(&trace, 1020, TRACE_PULSES, 1, TRACE_STEP, INT32_MIN);
    trace_add(&trace, 1030, TRACE_PULSES, 4, TRACE_STEP, INT32_MAX);
    trace_add(&trace, 1030, TRACE_TURNS, 4, TRACE_MOTION, 0);
    trace_add(&trace, 1030, TRACE_TURNS, 4, TRACE_LED, RKM04_LED_OFF);
    trace_add(&trace, 2000, TRACE_TURNS, 2, TRACE_LED, RKM04_LED_BLINK);
    trace_add(&trace, 2000, TRACE_TURNS, 3, TRACE_DIRECTION, 1);
    trace_add(&trace, 2000, TRACE_TURNS, 0, TRACE_OUTPUTS, 255);
    trace_add(&trace, UINT64_MAX - 1, TRACE_TURNS, 0, TRACE_VARIABLES, 65535);
    ck_assert_str_eq(finished(), HEADER "0,unit,di,129\n"
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
                                        "18446744073709551614,unit,var,65535\n");
}
END_TEST

START_TEST(rows_of_several_motors_come_in_the_order_of_time)
{
    for (unsigned motor = 1; motor <= 4; motor++) {
        for (int i = 0; i < 3; i++)
            trace_add(&trace, 1000 + (uint64_t)i * 100 + motor, TRACE_PULSES, motor, TRACE_STEP, i);
    }
    ck_assert_str_eq(finished(), HEADER "1001,m1,step,0\n1002,m2,step,0\n1003,m3,step,0\n1004,m4,step,0\n"
                                        "1101,m1,step,1\n1102,m2,step,1\n1103,m3,step,1\n1104,m4,step,1\n"
                                        "1201,m1,step,2\n1202,m2,step,2\n1203,m3,step,2\n1204,m4,step,2\n");
}
END_TEST

START_TEST(K2_in_a_tick_what_is_delivered_comes_first_then_pulses_then_the_turns)
{
    trace_add(&trace, 5000, TRACE_PULSES, 1, TRACE_STEP, 1);
    trace_add(&trace, 5000, TRACE_TURNS, 1, TRACE_MOTION, 0);
    trace_add(&trace, 5000, TRACE_PULSES, 2, TRACE_STEP, 2);
    trace_add(&trace, 5000, TRACE_TURNS, 1, TRACE_COMMAND, 0);
    trace_add(&trace, 5000, TRACE_DELIVERED, 0, TRACE_INPUTS, 1);
    trace_add(&trace, 5000, TRACE_TURNS, 2, TRACE_COMMAND, 7);
    ck_assert_str_eq(finished(), HEADER "5000,unit,di,1\n"
                                        "5000,m1,step,1\n"
                                        "5000,m2,step,2\n"
                                        "5000,m1,motion,end\n"
                                        "5000,m1,command,0\n"
                                        "5000,m2,command,7\n");
}
END_TEST

START_TEST(rows_wait_until_nothing_earlier_can_come)
{
    trace_add(&trace, 10, TRACE_PULSES, 1, TRACE_STEP, 1);
    trace_add(&trace, 30, TRACE_PULSES, 1, TRACE_STEP, 3);
    trace_write_before(&trace, 30);
    trace_add(&trace, 30, TRACE_DELIVERED, 0, TRACE_INPUTS, 2);
    fflush(out);
    ck_assert_str_eq(text, HEADER "10,m1,step,1\n");
    ck_assert_str_eq(finished(), HEADER "10,m1,step,1\n30,unit,di,2\n30,m1,step,3\n");
}
END_TEST

START_TEST(more_rows_than_there_is_room_for_are_all_written)
{
    const int rows = 5 * TRACE_ROOM;
    for (int i = 0; i < rows; i++)
        trace_add(&trace, 42, TRACE_DELIVERED, 0, TRACE_INPUTS, i);
    const char *at = finished() + strlen(HEADER);
    for (int i = 0; i < rows; i++) {
        char line[32];
        int n = sprintf(line, "42,unit,di,%d\n", i);
        ck_assert_mem_eq(at, line, (size_t)n);
        at += n;
    }
    ck_assert_int_eq(*at, '\0');
}
END_TEST

START_TEST(a_device_that_is_full_is_told)
{
    static struct trace other;
    FILE *full = fopen("/dev/full", "w");
    ck_assert_ptr_nonnull(full);
    trace_begin(&other, full);
    for (int i = 0; i < 100000; i++) {
        trace_add(&other, (uint64_t)i, TRACE_PULSES, 1, TRACE_STEP, i);
        trace_write_before(&other, (uint64_t)i);
    }
    ck_assert(other.failed);
    ck_assert_int_eq(trace_finish(&other), ENOSPC);
    fclose(full);
}
END_TEST

static Suite *trace_suite(void)
{
    Suite *suite = suite_create("trace");
    TCase *rows = tcase_create("rows");
    tcase_add_checked_fixture(rows, begin, end);
    tcase_add_test(rows, a_trace_of_nothing_is_its_header);
    tcase_add_test(rows, every_event_has_its_row);
    suite_add_tcase(suite, rows);
    TCase *order = tcase_create("order");
    tcase_add_checked_fixture(order, begin, end);
    tcase_add_test(order, rows_of_several_motors_come_in_the_order_of_time);
    tcase_add_test(order, K2_in_a_tick_what_is_delivered_comes_first_then_pulses_then_the_turns);
    tcase_add_test(order, rows_wait_until_nothing_earlier_can_come);
    tcase_add_test(order, more_rows_than_there_is_room_for_are_all_written);
    suite_add_tcase(suite, order);
    TCase *failures = tcase_create("failures");
    tcase_add_test(failures, a_device_that_is_full_is_told);
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
        puts("one test case alone: CK_RUN_CASE=rows|order|failures ./test_trace");
    return failed > 0;
}
