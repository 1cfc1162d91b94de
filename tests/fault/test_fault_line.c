/* SPDX-License-Identifier: MIT */
/* test_fault_line.c: what a host sees of faults of bytes, of the line and of the adapter. One case alone:
 * CK_RUN_CASE=CASE ./test_fault_line */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fault_rig.h"

#define REQUEST 7u /* bytes of the frame that asks for the version */
#define ANSWER 24u /* and of the answer */
#define BEGIN 1000u

/* What passes without a fault when the version is asked for at BEGIN. */
static struct heard clean, clean_line;

/* A line of two units that has asked for the version of unit 1 at BEGIN with a fault; the same without is in `clean`. */
static void version_with(bool timed, const char *fault)
{
    rig_begin(timed, 2);
    run(BEGIN);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    clean = rig.host;
    clean_line = rig.line;
    ck_assert_uint_eq(clean.count, ANSWER);
    ck_assert_uint_eq(clean_line.count, REQUEST + ANSWER);
    rig_end();
    rig_begin(timed, 2);
    run(BEGIN);
    inject("%s", fault);
    ask(1, VERSION, 1);
    settle();
}

static const char *text(const char *format, int number)
{
    static char out[160];
    snprintf(out, sizeof out, format, number);
    return out;
}

static void assert_as(const struct heard *found, size_t at, const struct heard *expected, size_t from, size_t length)
{
    for (size_t i = 0; i < length; i++) {
        ck_assert_uint_eq(found->byte[at + i], expected->byte[from + i]);
        ck_assert_uint_eq(found->tick[at + i], expected->tick[from + i]);
    }
}

/* The line works again. */
static void assert_answered(void)
{
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    ck_assert_uint_eq(rig.host.count, ANSWER);
    rig_end();
}

/* ---- Bytes to the host -------------------------------------------------------------------------------------------- */

START_TEST(a_byte_dropped_to_the_host_is_missing_and_the_others_come_when_they_would)
{
    for (unsigned k = 0; k < ANSWER; k++) {
        version_with(_i, text("{'kind': 'drop', 'direction': 'to_master', 'skip': %d, 'count': 1}", (int)k));
        ck_assert_uint_eq(rig.host.count, ANSWER - 1);
        assert_as(&rig.host, 0, &clean, 0, k);
        assert_as(&rig.host, k, &clean, k + 1, ANSWER - 1 - k);
        ck_assert_uint_eq(rig.news, 1);
        ck_assert_uint_eq(rig.told[0].unit, 1);
        assert_answered();
    }
}
END_TEST

START_TEST(a_flipped_byte_to_the_host_differs_in_the_bits_of_the_mask)
{
    for (unsigned k = 0; k < ANSWER; k++) {
        version_with(_i, text("{'kind': 'flip', 'mask': 129, 'unit': 1, 'skip': %d, 'count': 1}", (int)k));
        clean.byte[k] ^= 129;
        ck_assert_uint_eq(rig.host.count, ANSWER);
        assert_as(&rig.host, 0, &clean, 0, ANSWER);
        assert_answered();
    }
}
END_TEST

START_TEST(a_byte_to_the_host_comes_twice_and_the_next_ones_later)
{
    for (unsigned k = 0; k < ANSWER; k++) {
        version_with(true, text("{'kind': 'duplicate', 'direction': 'to_master', 'skip': %d, 'count': 1}", (int)k));
        ck_assert_uint_eq(rig.host.count, ANSWER + 1);
        assert_as(&rig.host, 0, &clean, 0, k + 1);
        ck_assert_mem_eq(rig.host.byte + k + 1, clean.byte + k, ANSWER - k);
        for (unsigned i = k + 1; i < ANSWER; i++)
            ck_assert_uint_eq(rig.host.tick[i], clean.tick[i]); /* when the byte after it would have come */
        ck_assert_uint_eq((rig.host.tick[ANSWER] * 12 - clean.tick[ANSWER - 1] * 12 + 12) / 6250, 1);
        assert_answered();
    }
}
END_TEST

START_TEST(a_byte_is_inserted_before_one_to_the_master)
{
    for (unsigned k = 0; k < ANSWER; k++) {
        version_with(_i, text("{'kind': 'insert', 'byte': 85, 'direction': 'to_master', 'skip': %d, 'count': 1}", (int)k));
        ck_assert_uint_eq(rig.host.count, ANSWER + 1);
        assert_as(&rig.host, 0, &clean, 0, k);
        ck_assert_uint_eq(rig.host.byte[k], 85);
        ck_assert_uint_eq(rig.host.tick[k], clean.tick[k]);
        ck_assert_mem_eq(rig.host.byte + k + 1, clean.byte + k, ANSWER - k);
        assert_answered();
    }
}
END_TEST

START_TEST(all_that_can_happen_to_a_byte_can_happen_to_one)
{
    version_with(true, "{'kind': 'insert', 'byte': 1, 'unit': 1, 'count': 1}");
    inject("{'kind': 'flip', 'mask': 2, 'unit': 1, 'count': 1}");
    inject("{'kind': 'duplicate', 'unit': 1, 'count': 1}");
    forget();
    inject("{'kind': 'insert', 'byte': 1, 'unit': 1, 'count': 1}");
    ask(1, VERSION, 1);
    settle();
    ck_assert_uint_eq(rig.host.count, ANSWER + 2);
    ck_assert_mem_eq(rig.host.byte, "\1\x7c\x7c", 3);
    ck_assert_mem_eq(rig.host.byte + 3, clean.byte + 1, ANSWER - 1);
    ck_assert_uint_eq(rig.news, 3);
    assert_answered();
}
END_TEST

/* ---- Bytes to the units --------------------------------------------------------------------------------------------- */

START_TEST(a_byte_dropped_to_the_units_leaves_a_gap_and_the_request_is_not_understood)
{
    for (unsigned k = 0; k < REQUEST; k++) {
        version_with(_i, text("{'kind': 'drop', 'direction': 'to_units', 'skip': %d, 'count': 1}", (int)k));
        ck_assert_uint_eq(rig.host.count, 0);
        ck_assert_uint_eq(counters(1).requests, 0);
        ck_assert_uint_eq(rig.line.count, REQUEST - 1);
        assert_as(&rig.line, 0, &clean_line, 0, k);
        assert_as(&rig.line, k, &clean_line, k + 1, REQUEST - 1 - k);
        if (k == REQUEST - 1) {
            sim_queue_bytes(&rig.sim, (const uint8_t *)"\x7e", 1, sim_now(&rig.sim)); /* all that was missing */
            settle();
            ck_assert_uint_eq(counters(1).requests, 1);
        }
        assert_answered();
    }
}
END_TEST

START_TEST(a_flipped_byte_to_the_units_spoils_the_frame)
{
    for (unsigned k = 1; k < REQUEST - 1; k++) {
        version_with(_i, text("{'kind': 'flip', 'direction': 'to_units', 'skip': %d, 'count': 1}", (int)k));
        ck_assert_uint_eq(rig.host.count, 0);
        ck_assert_uint_eq(counters(1).dropped, 1);
        ck_assert_uint_eq(counters(2).dropped, 1);
        ck_assert_uint_eq(rig.line.byte[k], clean_line.byte[k] ^ 1u);
        ck_assert_uint_eq(rig.line.tick[k], clean_line.tick[k]);
        assert_answered();
    }
}
END_TEST

START_TEST(a_byte_to_the_units_comes_twice_and_those_after_it_wait)
{
    version_with(true, "{'kind': 'duplicate', 'direction': 'to_units', 'skip': 3, 'count': 1}");
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(counters(1).dropped, 1);
    ck_assert_uint_eq(rig.line.count, REQUEST + 1);
    ck_assert_mem_eq(rig.line.byte, "\x7e\1\0\1\1", 5);
    assert_as(&rig.line, 0, &clean_line, 0, 4);
    for (unsigned k = 0; k <= REQUEST; k++)
        ck_assert_uint_eq(rig.line.tick[k], BEGIN + ((k + 1) * 6250 + 11) / 12);
    assert_answered();
}
END_TEST

START_TEST(bytes_of_the_host_after_a_gap_are_not_moved_by_one_that_comes_twice)
{
    rig_begin(true, 1);
    inject("{'kind': 'insert', 'byte': 33, 'count': 1}");
    sim_queue_bytes(&rig.sim, (const uint8_t *)"ab", 2, 0);
    sim_queue_bytes(&rig.sim, (const uint8_t *)"c", 1, 10000);
    settle();
    ck_assert_uint_eq(rig.line.count, 4);
    ck_assert_mem_eq(rig.line.byte, "!abc", 4);
    ck_assert_uint_eq(rig.line.tick[2], (3 * 6250 + 11) / 12);
    ck_assert_uint_eq(rig.line.tick[3], 10521);
    rig_end();
}
END_TEST

START_TEST(a_flag_inserted_into_a_request_spoils_it_and_before_it_does_no_harm)
{
    version_with(_i, "{'kind': 'insert', 'byte': 126, 'direction': 'to_units', 'skip': 3, 'count': 1}");
    ck_assert_uint_eq(rig.host.count, 0);
    rig_end();
    version_with(_i, "{'kind': 'insert', 'byte': 126, 'direction': 'to_units', 'count': 1}");
    ck_assert_uint_eq(rig.host.count, ANSWER);
    assert_answered();
}
END_TEST

START_TEST(the_answers_of_one_unit_suffer_alone)
{
    rig_begin(_i, 2);
    inject("{'kind': 'flip', 'unit': 2}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    ck_assert_uint_eq(answers_to(2, VERSION, 1), 0);
    ck_assert_uint_eq(rig.host.count, ANSWER);
    rig_end();
}
END_TEST

/* ---- Echo ----------------------------------------------------------------------------------------------------------- */

START_TEST(with_local_echo_the_host_receives_its_request_before_the_answer)
{
    version_with(_i, "{'kind': 'echo'}");
    ck_assert_uint_eq(rig.host.count, REQUEST + ANSWER);
    assert_as(&rig.host, 0, &clean_line, 0, REQUEST);
    assert_as(&rig.host, REQUEST, &clean, 0, ANSWER);
    json_decref(run_command("fault.clear", "{}"));
    assert_answered();
}
END_TEST

START_TEST(an_echo_may_end_after_some_bytes)
{
    version_with(_i, "{'kind': 'echo', 'count': 3}");
    ck_assert_uint_eq(rig.host.count, 3 + ANSWER);
    assert_as(&rig.host, 0, &clean_line, 0, 3);
    assert_answered();
}
END_TEST

/* ---- Break ---------------------------------------------------------------------------------------------------------- */

START_TEST(a_break_spoils_the_request_under_way_and_is_one_framing_error)
{
    version_with(true, "{'kind': 'break', 'after': 1000, 'duration': '20ms'}");
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(counters(1).requests, 0);
    ck_assert_uint_eq(segment_counters(&rig.sim.segment).framing_errors, 1);
    ck_assert_uint_eq(rig.lost, 1);
    run(20000);
    ck_assert_uint_eq(rig.news, 2);
    assert_news(0, "1 break: the bus is held at 0");
    assert_news(1, "1 break: over");
    ck_assert_uint_eq(rig.told[0].tick, BEGIN + 1000);
    ck_assert_uint_eq(rig.told[1].tick, BEGIN + 21000);
    assert_answered();
}
END_TEST

START_TEST(a_break_cuts_an_answer_short)
{
    version_with(true, "{'kind': 'break', 'after': 9000, 'duration': '20ms'}");
    ck_assert_uint_gt(rig.host.count, 0);
    ck_assert_uint_lt(rig.host.count, ANSWER);
    assert_as(&rig.host, 0, &clean, 0, rig.host.count - 1); /* the one that it began in may be anything */
    run(20000);
    assert_answered();
}
END_TEST

START_TEST(on_a_line_without_time_nothing_gets_through_a_break)
{
    rig_begin(false, 1);
    inject("{'kind': 'break', 'duration': '1s'}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    ck_assert_uint_eq(counters(1).requests, 0);
    ck_assert_uint_eq(rig.lost, REQUEST);
    run(999999);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    run(1);
    assert_answered();
}
END_TEST

START_TEST(a_break_on_an_idle_line_harms_nobody)
{
    rig_begin(true, 1);
    inject("{'kind': 'break', 'duration': '5ms', 'every': '10ms', 'count': 3}");
    run(100000);
    ck_assert_uint_eq(rig.news, 6);
    ck_assert_uint_eq(rig.lost, 3);
    ck_assert_uint_eq(rig.host.count, 0);
    assert_answered();
}
END_TEST

START_TEST(a_break_stays_when_bytes_begin_to_take_time)
{
    rig_begin(false, 1);
    inject("{'kind': 'break', 'duration': '1s'}");
    run(1000);
    sim_set_timed(&rig.sim, true);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    run(1000000);
    assert_answered();
}
END_TEST

/* ---- Cable cut ------------------------------------------------------------------------------------------------------ */

START_TEST(with_the_cable_cut_there_is_silence_until_it_is_mended)
{
    version_with(_i, "{'kind': 'cable', 'duration': '2s'}");
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(counters(1).requests, 0);
    ck_assert_uint_eq(rig.plugs, 0);
    run(1900000);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    run(100000);
    assert_answered();
}
END_TEST

START_TEST(a_cable_cut_during_an_answer_ends_it_at_the_host_and_not_at_the_unit)
{
    version_with(true, "{'kind': 'cable', 'after': 9000, 'duration': '1s'}");
    ck_assert_uint_gt(rig.host.count, 0);
    ck_assert_uint_lt(rig.host.count, ANSWER);
    assert_as(&rig.host, 0, &clean, 0, rig.host.count);
    ck_assert_uint_le(rig.host.tick[rig.host.count - 1], BEGIN + 9000);
    ck_assert_uint_gt(clean.tick[rig.host.count], BEGIN + 9000);
    ck_assert_uint_eq(counters(1).answers, 1);
    ck_assert_uint_eq(counters(2).others, 2); /* the others receive it on their side of the cut */
    run(1000000);
    assert_answered();
}
END_TEST

START_TEST(the_cable_of_one_unit_cuts_off_that_one_alone)
{
    rig_begin(_i, 3);
    inject("{'kind': 'cable', 'unit': 2, 'duration': '1s'}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    ck_assert_uint_eq(answers_to(2, VERSION, 1), 0);
    ck_assert_uint_eq(answers_to(3, VERSION, 1), 1);
    ck_assert_uint_eq(counters(2).requests + counters(2).others, 0);
    run(1000000);
    ck_assert_uint_eq(answers_to(2, VERSION, 1), 1);
    rig_end();
}
END_TEST

/* ---- Adapter unplugged ---------------------------------------------------------------------------------------------- */

START_TEST(an_unplugged_adapter_is_told_when_it_goes_and_when_it_comes_back)
{
    rig_begin(_i, 1);
    inject("{'kind': 'unplugged', 'after': 1234, 'duration': '1s', 'every': '3s', 'count': 2}");
    run(10000000);
    ck_assert_uint_eq(rig.plugs, 4);
    for (unsigned i = 0; i < 4; i++) {
        ck_assert_uint_eq(rig.plug[i].tick, 1234 + i / 2 * 3000000 + i % 2 * 1000000);
        ck_assert(rig.plug[i].plugged == (i % 2 == 1));
    }
    assert_news(0, "1 unplugged: the adapter is unplugged");
    assert_answered();
}
END_TEST

START_TEST(what_was_under_way_when_the_adapter_was_unplugged_is_lost)
{
    version_with(true, "{'kind': 'unplugged', 'after': 1000, 'duration': '1s'}");
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(rig.line.count, 2); /* the byte that was being sent is cut off from the units only */
    ck_assert_uint_eq(counters(1).requests, 0);
    run(1000000);
    assert_answered();
}
END_TEST

START_TEST(an_adapter_unplugged_twice_over_comes_back_when_both_faults_are_over)
{
    rig_begin(true, 1);
    uint32_t first = inject("{'kind': 'unplugged'}");
    inject("{'kind': 'unplugged', 'for': '1s'}");
    ck_assert_uint_eq(rig.plugs, 1);
    run(2000000);
    ck_assert_uint_eq(rig.plugs, 1);
    char params[40];
    snprintf(params, sizeof params, "{'id': %u}", (unsigned)first);
    json_decref(run_command("fault.clear", params));
    ck_assert_uint_eq(rig.plugs, 2);
    ck_assert(rig.plug[1].plugged);
    assert_answered();
}
END_TEST

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

static const char *const script[] = {
    "{'kind': 'drop', 'probability': 0.05}",
    "{'kind': 'flip', 'mask': 16, 'probability': 0.05, 'after': '20ms'}",
    "{'kind': 'duplicate', 'probability': 0.05}",
    "{'kind': 'insert', 'byte': 126, 'probability': 0.02}",
    "{'kind': 'delay', 'delay': 777, 'probability': 0.3}",
    "{'kind': 'cut', 'bytes': 5, 'probability': 0.2}",
    "{'kind': 'echo', 'probability': 0.5, 'for': '100ms'}",
    "{'kind': 'break', 'after': '50ms', 'duration': 700, 'every': '31ms', 'probability': 0.5}",
    "{'kind': 'cable', 'after': 90001, 'duration': 30000}",
    "{'kind': 'input', 'input': 3, 'level': 1, 'duration': 10, 'every': 5003}",
};

static void run_script(bool timed, uint64_t step)
{
    rig_begin_with(timed, 2, 99, NULL);
    for (size_t i = 0; i < sizeof script / sizeof script[0]; i++)
        inject("%s", script[i]);
    for (unsigned i = 0; i < 20; i++) {
        ask((uint8_t)(1 + i % 2), VERSION, 1);
        for (uint64_t end = sim_now(&rig.sim) + 30000; sim_now(&rig.sim) < end;)
            run(step);
    }
    sim_end(&rig.sim);
}

START_TEST(K3_faults_do_the_same_however_time_is_cut)
{
    run_script(_i, 30000);
    struct heard host = rig.host, line = rig.line;
    size_t news = rig.news;
    ck_assert_uint_gt(news, 50);
    run_script(_i, 10);
    ck_assert_uint_eq(rig.news, news);
    ck_assert_mem_eq(&rig.host, &host, sizeof host);
    ck_assert_mem_eq(&rig.line, &line, sizeof line);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fault_line");
    TCase *bytes = tcase_create("bytes"), *line = tcase_create("line"), *adapter = tcase_create("adapter"),
          *time = tcase_create("time");
    tcase_add_loop_test(bytes, a_byte_dropped_to_the_host_is_missing_and_the_others_come_when_they_would, 0, 2);
    tcase_add_loop_test(bytes, a_flipped_byte_to_the_host_differs_in_the_bits_of_the_mask, 0, 2);
    tcase_add_test(bytes, a_byte_to_the_host_comes_twice_and_the_next_ones_later);
    tcase_add_loop_test(bytes, a_byte_is_inserted_before_one_to_the_master, 0, 2);
    tcase_add_test(bytes, all_that_can_happen_to_a_byte_can_happen_to_one);
    tcase_add_loop_test(bytes, a_byte_dropped_to_the_units_leaves_a_gap_and_the_request_is_not_understood, 0, 2);
    tcase_add_loop_test(bytes, a_flipped_byte_to_the_units_spoils_the_frame, 0, 2);
    tcase_add_test(bytes, a_byte_to_the_units_comes_twice_and_those_after_it_wait);
    tcase_add_test(bytes, bytes_of_the_host_after_a_gap_are_not_moved_by_one_that_comes_twice);
    tcase_add_loop_test(bytes, a_flag_inserted_into_a_request_spoils_it_and_before_it_does_no_harm, 0, 2);
    tcase_add_loop_test(bytes, the_answers_of_one_unit_suffer_alone, 0, 2);
    tcase_add_loop_test(line, with_local_echo_the_host_receives_its_request_before_the_answer, 0, 2);
    tcase_add_loop_test(line, an_echo_may_end_after_some_bytes, 0, 2);
    tcase_add_test(line, a_break_spoils_the_request_under_way_and_is_one_framing_error);
    tcase_add_test(line, a_break_cuts_an_answer_short);
    tcase_add_test(line, on_a_line_without_time_nothing_gets_through_a_break);
    tcase_add_test(line, a_break_on_an_idle_line_harms_nobody);
    tcase_add_test(line, a_break_stays_when_bytes_begin_to_take_time);
    tcase_add_loop_test(line, with_the_cable_cut_there_is_silence_until_it_is_mended, 0, 2);
    tcase_add_test(line, a_cable_cut_during_an_answer_ends_it_at_the_host_and_not_at_the_unit);
    tcase_add_loop_test(line, the_cable_of_one_unit_cuts_off_that_one_alone, 0, 2);
    tcase_add_loop_test(adapter, an_unplugged_adapter_is_told_when_it_goes_and_when_it_comes_back, 0, 2);
    tcase_add_test(adapter, what_was_under_way_when_the_adapter_was_unplugged_is_lost);
    tcase_add_test(adapter, an_adapter_unplugged_twice_over_comes_back_when_both_faults_are_over);
    tcase_add_loop_test(time, K3_faults_do_the_same_however_time_is_cut, 0, 2);
    tcase_set_timeout(time, 60);
    suite_add_tcase(suite, bytes);
    suite_add_tcase(suite, line);
    suite_add_tcase(suite, adapter);
    suite_add_tcase(suite, time);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
