/* SPDX-License-Identifier: MIT */
/* test_fault_answer.c: what a host sees of faults of answers. One case alone: CK_RUN_CASE=CASE ./test_fault_answer */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fault_rig.h"

#define ANSWER 24u /* bytes of the answer to VERSION */

/* The answer of unit 1 to VERSION, asked for at the tick at which a line is powered up. */
static struct heard clean;

static void begin_with(bool timed, const char *fault)
{
    rig_begin(timed, 2);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    clean = rig.host;
    ck_assert_uint_eq(clean.count, ANSWER);
    rig_end();
    rig_begin(timed, 2);
    inject("%s", fault);
}

static void assert_first(size_t count, uint64_t later)
{
    ck_assert_uint_eq(rig.host.count, count);
    ck_assert_mem_eq(rig.host.byte, clean.byte, count);
    for (size_t i = 0; i < count; i++)
        ck_assert_uint_eq(rig.host.tick[i], clean.tick[i] + later);
}

static void clear(void)
{
    json_decref(run_command("fault.clear", "{}"));
}

/* ---- Late ----------------------------------------------------------------------------------------------------------- */

START_TEST(a_delayed_answer_comes_later_to_the_tick)
{
    begin_with(_i, "{'kind': 'delay', 'delay': '123.457ms'}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    assert_first(ANSWER, 123457);
    ck_assert_uint_eq(rig.news, 1);
    assert_news(0, "1 delay: the answer is late by 123457 us");
    clear();
    uint64_t asked = sim_now(&rig.sim);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    ck_assert_uint_lt(rig.host.tick[0] - asked, 10000);
    rig_end();
}
END_TEST

START_TEST(a_delayed_answer_is_that_of_the_tick_of_the_request)
{
    begin_with(_i, "{'kind': 'delay', 'delay': '2s', 'skip': 1}");
    set(1, "\\C100S1000V1000F1000R");
    settle();
    run(500000);
    ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 1);
    ck_assert_uint_ge(sim_now(&rig.sim), 2500000);
    int position = (answer_byte(10) - '0') * 100 + (answer_byte(11) - '0') * 10 + answer_byte(12) - '0';
    ck_assert_int_ge(position, 480);
    ck_assert_int_le(position, 520);
    rig_end();
}
END_TEST

START_TEST(P10_a_request_during_the_delay_is_answered_after_it)
{
    begin_with(_i, "{'kind': 'delay', 'delay': '100ms', 'count': 1}");
    ask(1, VERSION, 1);
    run(50000);
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 2);
    ck_assert_uint_eq(counters(1).answers, 2);
    rig_end();
}
END_TEST

START_TEST(the_answers_of_others_are_not_late)
{
    begin_with(_i, "{'kind': 'delay', 'delay': '100ms', 'unit': 1}");
    ask(1, VERSION, 1);
    run(20000);
    ask(2, VERSION, 1);
    run(20000);
    ck_assert_uint_eq(rig.host.count, ANSWER);
    ck_assert_uint_eq(rig.host.byte[2], 2);
    settle();
    ck_assert_uint_eq(rig.host.count, 2 * ANSWER);
    ck_assert_uint_eq(rig.host.byte[ANSWER + 2], 1);
    rig_end();
}
END_TEST

START_TEST(an_answer_may_be_an_hour_late_and_time_may_leap_there)
{
    begin_with(_i, "{'kind': 'delay', 'delay': '3600s', 'count': 1}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    assert_first(ANSWER, UINT64_C(3600000000));
    rig_end();
}
END_TEST

/* ---- Not, or in part ------------------------------------------------------------------------------------------------ */

START_TEST(without_an_answer_the_request_is_obeyed_all_the_same)
{
    begin_with(_i, "{'kind': 'no_answer', 'count': 1}");
    forget();
    set(1, "=4711");
    settle();
    ck_assert_uint_eq(rig.host.count, 0);
    ck_assert_uint_eq(counters(1).answers, 1);
    assert_news(0, "1 no_answer: no answer");
    run(2000);
    ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 1);
    ck_assert_uint_eq(answer_byte(12), '1');
    ck_assert_uint_eq(answer_byte(9), '4');
    rig_end();
}
END_TEST

START_TEST(an_answer_is_cut_after_any_number_of_bytes)
{
    for (unsigned n = 0; n <= ANSWER + 1; n++) {
        char fault[80];
        snprintf(fault, sizeof fault, "{'kind': 'cut', 'bytes': %u, 'count': 1}", n);
        begin_with(_i, fault);
        ask(1, VERSION, 1);
        settle();
        assert_first(n < ANSWER ? n : ANSWER, 0);
        ck_assert_uint_eq(counters(1).answers, 1);
        ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
        rig_end();
    }
}
END_TEST

START_TEST(a_fault_that_comes_or_goes_during_an_answer_does_nothing_to_it)
{
    begin_with(true, "{'kind': 'cut', 'bytes': 10}");
    ask(1, VERSION, 1);
    sim_advance(&rig.sim, clean.tick[4]);
    clear();
    settle();
    assert_first(10, 0);
    rig_end();
    rig_begin(true, 2);
    ask(1, VERSION, 1);
    sim_advance(&rig.sim, clean.tick[4]);
    inject("{'kind': 'cut', 'bytes': 10}");
    inject("{'kind': 'no_answer'}");
    settle();
    assert_first(ANSWER, 0);
    rig_end();
}
END_TEST

/* ---- Wrong ---------------------------------------------------------------------------------------------------------- */

/* What a host's receiver makes of what it has received. */
static struct rkm04_receiver judge(unsigned *whole)
{
    static uint8_t message[RKM04_MESSAGE_MAX];
    struct rkm04_receiver receiver = {0};
    *whole = 0;
    for (size_t i = 0; i < rig.host.count; i++)
        *whole += rkm04_hdlc.receive(&receiver, rig.host.byte[i], 0, message, sizeof message);
    return receiver;
}

static unsigned differences(const struct heard *one)
{
    unsigned number = 0;
    ck_assert_uint_eq(one->count, rig.host.count);
    for (size_t i = 0; i < one->count; i++)
        number += one->byte[i] != rig.host.byte[i];
    return number;
}

/* Many answers, so that check values with bytes that are escaped are among them. */
START_TEST(L1_a_wrong_check_value_is_all_that_is_wrong_with_the_answer)
{
    rig_begin(_i, 1);
    unsigned escaped = 0;
    for (unsigned i = 0; i < 1000; i++) {
        unsigned whole;
        char text[20];
        snprintf(text, sizeof text, "=%u", i * 7919u);
        set(1, text);
        settle();
        run(2000);
        ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 1);
        clean = rig.host;
        escaped += rig.host.count > 19;
        inject("{'kind': 'wrong_fcs', 'count': 1}");
        ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 0);
        struct rkm04_receiver receiver = judge(&whole);
        ck_assert_uint_eq(whole, 0);
        ck_assert_uint_eq(receiver.bad_check, 1);
        ck_assert_uint_eq(receiver.malformed, 0);
        ck_assert_uint_eq(differences(&clean), 1);
        ck_assert_uint_eq(clean.byte[clean.count - 1], rig.host.byte[clean.count - 1]);
        ck_assert_mem_eq(clean.byte, rig.host.byte, clean.count - 5);
        if (i % 60 == 59)
            clear();
    }
    ck_assert_uint_gt(escaped, 2);
    rig_end();
}
END_TEST

START_TEST(the_check_value_of_a_long_answer_may_be_wrong_and_of_the_next_one_right)
{
    rig_begin(_i, 1);
    char text[280] = "";
    for (unsigned i = 0; i < 50; i++)
        strcat(text, "W100 ");
    set(1, text);
    settle();
    ck_assert_uint_eq(answers_to(1, "\5" "1", 2), 1);
    clean = rig.host;
    inject("{'kind': 'wrong_fcs', 'count': 1}");
    ck_assert_uint_eq(answers_to(1, "\5" "1", 2), 0);
    ck_assert_uint_eq(differences(&clean), 1);
    ck_assert_uint_eq(answers_to(1, "\5" "1", 2), 1);
    ck_assert_uint_eq(differences(&clean), 0);
    rig_end();
}
END_TEST

/* Two units of one address, one of them late: each takes the other's answer for a request. */
START_TEST(units_that_answer_one_another_for_ever_are_cut_off)
{
    rig_begin_with(false, 2, 1, &rkm04_plain);
    json_decref(run_command("switch", "{'unit': '2', 'node': 1, 'reset': true}"));
    inject("{'kind': 'delay', 'unit': '2', 'delay': 10, 'count': 1}");
    ask(1, VERSION, 1);
    for (unsigned i = 0; i < 10000; i++) {
        run(100);
        if (rig.host.count > RIG_BYTES / 2)
            forget();
    }
    struct segment_counters line = segment_counters(&rig.sim.segment);
    ck_assert_uint_eq(line.cuts, 1);
    ck_assert_uint_ge(line.cut_ticks, SEGMENT_UNASKED_MAX / 2);
    ck_assert_uint_lt(line.cut_ticks, 10 * SEGMENT_UNASKED_MAX);
    ck_assert(segment_idle(&rig.sim.segment));
    ck_assert_uint_gt(counters(1).answers + counters(2).answers, SEGMENT_UNASKED_MAX);
    ck_assert_uint_le(counters(1).answers + counters(2).answers, SEGMENT_UNASKED_MAX + 16);
    json_decref(run_command("fault.clear", "{}"));
    forget();
    ask(1, VERSION, 1);
    settle();
    ck_assert_uint_gt(rig.host.count, 0);
    rig_end();
}
END_TEST

START_TEST(L2_plain_frames_have_no_check_value_to_be_wrong)
{
    rig_begin_with(true, 1, 1, &rkm04_plain);
    ck_assert_str_eq(refused("fault.inject", "{'kind': 'wrong_fcs'}"), "-32000 wrong_fcs: framing `plain' has no check value");
    inject("{'kind': 'cut', 'bytes': 3, 'count': 1}");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
    ck_assert_uint_eq(rig.host.count, 3);
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    rig_end();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fault_answer");
    TCase *late = tcase_create("late"), *part = tcase_create("part"), *wrong = tcase_create("wrong");
    tcase_add_loop_test(late, a_delayed_answer_comes_later_to_the_tick, 0, 2);
    tcase_add_loop_test(late, a_delayed_answer_is_that_of_the_tick_of_the_request, 0, 2);
    tcase_add_loop_test(late, P10_a_request_during_the_delay_is_answered_after_it, 0, 2);
    tcase_add_loop_test(late, the_answers_of_others_are_not_late, 0, 2);
    tcase_add_loop_test(late, an_answer_may_be_an_hour_late_and_time_may_leap_there, 0, 2);
    tcase_add_loop_test(part, without_an_answer_the_request_is_obeyed_all_the_same, 0, 2);
    tcase_add_loop_test(part, an_answer_is_cut_after_any_number_of_bytes, 0, 2);
    tcase_add_test(part, a_fault_that_comes_or_goes_during_an_answer_does_nothing_to_it);
    tcase_add_loop_test(wrong, L1_a_wrong_check_value_is_all_that_is_wrong_with_the_answer, 0, 2);
    tcase_add_loop_test(wrong, the_check_value_of_a_long_answer_may_be_wrong_and_of_the_next_one_right, 0, 2);
    tcase_add_test(late, units_that_answer_one_another_for_ever_are_cut_off);
    tcase_add_test(wrong, L2_plain_frames_have_no_check_value_to_be_wrong);
    tcase_set_timeout(wrong, 60);
    suite_add_tcase(suite, late);
    suite_add_tcase(suite, part);
    suite_add_tcase(suite, wrong);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
