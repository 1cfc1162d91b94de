/* SPDX-License-Identifier: MIT */
/* test_segment.c: a host and several units on one pair of wires (U4, U7, K4, P10, L1-L3). One case alone:
 * CK_RUN_CASE=CASE ./test_segment */
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "segment_rig.h"

#define line (&line_rig.segment)
#define heard (&line_rig.host)

static const uint8_t one[] = {1, 0}, three[] = {1, 2, 7, 0}, twins[] = {5, 5, 0};
static const uint8_t all[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 0};

#define VERSION "\1"
#define ANSWER_BYTES (1 + 2 + 18 + 2 + 1) /* hdlc frame of the answer to it, nothing escaped */

static void begin(const uint8_t *nodes)
{
    struct segment_config config = line_timed();
    line_begin(&config, nodes, NULL);
}

/* ---- Times ---------------------------------------------------------------------------------------------------------- */

START_TEST(U7_byte_k_of_a_burst_has_passed_after_k_times_ten_bits)
{
    begin(one);
    size_t request = line_ask(1, VERSION, 1, 7777);
    line_settle();
    ck_assert_uint_eq(line_rig.monitored, request + heard->count);
    for (size_t k = 1; k <= request; k++) {
        ck_assert_uint_eq(line_rig.monitor[k - 1].tick, 7777 + (k * 6250 + 11) / 12);
        ck_assert_uint_eq(line_rig.monitor[k - 1].start, 7777 + (k - 1) * 6250 / 12);
        ck_assert_uint_eq(line_rig.monitor[k - 1].senders, 1);
    }
    uint64_t answer = 7777 * 12 + request * 6250 + SEGMENT_TURNAROUND * 12; /* exact, in twelfths */
    ck_assert_uint_eq(line_answers(1, 1), 1);
    for (size_t k = 1; k <= heard->count; k++) {
        ck_assert_uint_eq(heard->tick[k - 1], (answer + k * 6250 + 11) / 12);
        ck_assert_uint_eq(line_rig.monitor[request + k - 1].senders, 1u << 1);
    }
}
END_TEST

START_TEST(U7_six_thousand_bytes_take_their_time_to_the_tick)
{
    static const uint8_t noise[100] = {0};
    begin(one);
    for (uint64_t i = 0; i < 60; i++) {
        segment_advance(line, i * 1000);
        while (segment_room(line) < sizeof noise)
            segment_advance(line, segment_due(line));
        segment_queue_bytes(line, noise, sizeof noise, segment_now(line));
    }
    ck_assert_uint_eq(line_settle(), 6000 / 12 * 6250);
}
END_TEST

START_TEST(U7_bytes_handed_over_when_the_one_before_has_passed_follow_without_a_gap)
{
    begin(one);
    for (unsigned k = 0; k < 120; k++) {
        segment_queue_bytes(line, (const uint8_t *)"x", 1, segment_now(line));
        line_settle();
    }
    ck_assert_uint_eq(segment_now(line), 120 / 12 * 6250);
}
END_TEST

START_TEST(U7_gaps_between_bytes_are_kept)
{
    static const uint64_t tick[] = {100, 5000, 5100, 5543, 7003, 9001};
    static const uint64_t start[] = {100, 5000, 5520, 6041, 7003, 9001}; /* the third and fourth have to wait */
    begin(one);
    for (size_t i = 0; i < 6; i++)
        segment_queue_bytes(line, (const uint8_t *)"abcdef" + i, 1, tick[i]);
    line_settle();
    ck_assert_uint_eq(line_rig.monitored, 6);
    for (size_t i = 0; i < 6; i++) {
        ck_assert_uint_eq(line_rig.monitor[i].start, start[i]);
        ck_assert_uint_eq(line_rig.monitor[i].byte, 'a' + i);
    }
}
END_TEST

START_TEST(K4_a_request_acts_when_its_last_byte_has_passed)
{
    begin(three);
    size_t length = line_set(2, '1', "W1000", 50);
    segment_advance(line, line_passed(50, length) - 1);
    ck_assert_uint_eq(line_motor(2, 1).commands, 0);
    segment_advance(line, line_passed(50, length));
    ck_assert_uint_eq(line_motor(2, 1).commands, 1);
}
END_TEST

START_TEST(the_answer_begins_when_the_turnaround_is_over)
{
    static const uint32_t turnaround[] = {0, 1, 521, 2000, SEGMENT_TURNAROUND_MAX};
    struct segment_config config = line_timed();
    config.turnaround = turnaround[_i];
    line_begin(&config, one, NULL);
    size_t request = line_ask(1, VERSION, 1, 0);
    line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 1);
    ck_assert_uint_eq(line_rig.monitor[request].start, request * 6250 / 12 + turnaround[_i]);
}
END_TEST

/* ---- Who is meant --------------------------------------------------------------------------------------------------- */

START_TEST(U4_each_of_sixteen_units_answers_for_itself_alone)
{
    uint64_t tick = 0;
    begin(all);
    for (uint8_t node = 1; node <= 16; node++) {
        line_ask(node, VERSION, 1, tick);
        tick = line_settle();
        ck_assert_uint_eq(line_answers(node, 1), 1);
        ck_assert_uint_eq(line_count().whole, node);
        ck_assert_uint_eq(line_rig.monitor[line_rig.monitored - 1].senders, UINT32_C(1) << node);
    }
    ck_assert_uint_eq(segment_counters(line).collisions, 0);
}
END_TEST

START_TEST(L1_answers_of_others_are_received_and_not_obeyed)
{
    begin(three);
    line_set(2, '1', "F100 R", 0);
    line_ask(2, "\0051", 2, line_settle());
    line_settle();
    ck_assert_uint_eq(line_count().whole, 2);
    static const unsigned others[] = {1, 3};
    for (size_t i = 0; i < 2; i++) {
        struct rkm04_counters counters = line_unit_counters(others[i]);
        ck_assert_uint_eq(counters.others, 4); /* two requests and two answers */
        ck_assert_uint_eq(counters.requests, 0);
        ck_assert_uint_eq(counters.dropped, 0);
        ck_assert_uint_eq(line_motor(others[i], 1).commands, 0);
    }
    ck_assert_uint_eq(line_unit_counters(2).others, 0);
}
END_TEST

START_TEST(L3_a_broadcast_is_obeyed_by_all_and_answered_by_none)
{
    begin(all);
    size_t length = line_set(0, '0', "F100", 0);
    ck_assert_uint_eq(line_settle(), line_passed(0, length));
    ck_assert_uint_eq(heard->count, 0);
    for (unsigned number = 1; number <= 16; number++)
        for (unsigned motor = 1; motor <= 4; motor++)
            ck_assert_uint_eq(line_motor(number, motor).commands, 1);
}
END_TEST

START_TEST(L3_a_request_for_nobody_is_answered_by_nobody)
{
    begin(three);
    line_ask(9, VERSION, 1, 0);
    line_settle();
    ck_assert_uint_eq(heard->count, 0);
}
END_TEST

/* ---- Collisions ------------------------------------------------------------------------------------------------------- */

START_TEST(two_units_of_one_address_with_the_same_answer_look_like_one)
{
    begin(twins);
    line_ask(5, VERSION, 1, 0);
    line_settle();
    ck_assert_uint_eq(line_answers(5, 1), 1);
    ck_assert_uint_eq(heard->count, ANSWER_BYTES);
    ck_assert_uint_eq(line_rig.monitor[line_rig.monitored - 1].senders, 1u << 1 | 1u << 2);
    ck_assert_uint_eq(segment_counters(line).collisions, 2 * ANSWER_BYTES);
}
END_TEST

START_TEST(two_units_of_one_address_with_different_answers_destroy_them)
{
    static const struct device_port nothing;
    struct device_config other = rkm04_device_config(&(struct rkm04_config){.node = 5, .version_text = "02.01,06.03.2010"});
    begin(one);
    struct device_config first = {.node = 5};
    segment_add_unit(line, &first, &nothing, NULL);
    segment_add_unit(line, &other, &nothing, NULL);
    line_ask(5, VERSION, 1, 0);
    line_ask(1, VERSION, 1, line_settle());
    line_settle();
    ck_assert_uint_eq(line_answers(5, 1), 0);
    ck_assert_uint_ge(line_count().dropped, 1);
    ck_assert_uint_eq(line_answers(1, 1), 1); /* the line works on */
    ck_assert_uint_eq(line_unit_counters(2).answers, 1);
    ck_assert_uint_eq(line_unit_counters(3).answers, 1);
}
END_TEST

START_TEST(two_units_of_one_address_with_different_programs_destroy_their_answers)
{
    begin(twins);
    ck_assert_int_eq(rkm04_set_command(rkm04_of(segment_unit(line, 1)), '1', "F100 W2000", 10, NULL), 0);
    ck_assert_int_eq(rkm04_set_command(rkm04_of(segment_unit(line, 2)), '1', "F200", 4, NULL), 0);
    line_ask(5, "\0051", 2, 0);
    line_ask(5, VERSION, 1, line_settle());
    line_settle();
    ck_assert_uint_eq(line_answers(5, 5), 0);
    ck_assert_uint_ge(line_count().dropped, 1);
    ck_assert_uint_eq(line_answers(5, 1), 1);
}
END_TEST

/* Two requests, the second begun `tick` after the end of the first, and one more when all is quiet again. */
static void ask_too_early(uint64_t ticks)
{
    begin(three);
    size_t length = line_ask(1, VERSION, 1, 0);
    line_ask(2, VERSION, 1, line_passed(0, length) + ticks);
    uint64_t quiet = line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 0);
    ck_assert_uint_gt(segment_counters(line).collisions, 0);
    line_ask(7, VERSION, 1, quiet);
    line_settle();
    ck_assert_uint_eq(line_answers(7, 1), 1);
}

START_TEST(a_request_that_begins_during_an_answer_collides_with_it)
{
    ask_too_early(SEGMENT_TURNAROUND + (uint64_t)_i * 97); /* somewhere within the answer, at all parts of a bit and a byte */
    ck_assert_uint_eq(line_unit_counters(1).requests, 1); /* it did not receive the second */
    ck_assert_uint_eq(line_unit_counters(1).others, 2);   /* only the third, and its answer */
}
END_TEST

START_TEST(a_request_right_after_another_one_collides_with_its_answer)
{
    ask_too_early(0);
    ck_assert_uint_eq(line_answers(2, 1), 0);
}
END_TEST

START_TEST(a_request_after_the_last_byte_of_an_answer_does_not_collide)
{
    begin(three);
    line_ask(1, VERSION, 1, 0);
    line_ask(2, VERSION, 1, line_settle());
    line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 1);
    ck_assert_uint_eq(line_answers(2, 1), 1);
    ck_assert_uint_eq(segment_counters(line).collisions, 0);
}
END_TEST

/* ---- P10 -------------------------------------------------------------------------------------------------------------- */

START_TEST(P10_a_request_during_the_turnaround_is_taken_after_the_answer)
{
    struct segment_config config = line_timed();
    config.turnaround = 20000;
    line_begin(&config, three, NULL);
    size_t length = line_ask(1, VERSION, 1, 0);
    line_ask(1, "\0041", 2, 0);
    line_settle();
    ck_assert_uint_eq(heard->tick[0], line_passed(20000, length + 1));
    ck_assert_uint_eq(line_answers(1, 1), 1);
    ck_assert_uint_eq(line_answers(1, 4), 1);
    ck_assert_uint_eq(segment_counters(line).overruns, 0);
    for (size_t i = 1; i < heard->count; i++) /* one after the other */
        ck_assert_uint_le(heard->tick[i] - heard->tick[i - 1], 521);
}
END_TEST

START_TEST(P10_a_third_request_during_the_turnaround_is_lost)
{
    struct segment_config config = line_timed();
    config.turnaround = 20000;
    line_begin(&config, three, NULL);
    line_ask(1, VERSION, 1, 0);
    line_ask(1, "\0041", 2, 0);
    size_t lost = line_ask(1, "\0042", 2, 0);
    uint64_t quiet = line_settle();
    ck_assert_uint_eq(line_count().whole, 2);
    ck_assert_uint_eq(segment_counters(line).overruns, lost);
    line_ask(1, "\0043", 2, quiet);
    line_settle();
    ck_assert_uint_eq(line_count().whole, 3);
}
END_TEST

/* ---- Power, echo, break, purge ---------------------------------------------------------------------------------------- */

START_TEST(a_unit_without_power_is_silent_and_the_others_work_on)
{
    begin(three);
    segment_power(line, 2, false);
    line_ask(2, VERSION, 1, 0);
    line_ask(7, VERSION, 1, line_settle() + 100000);
    line_settle();
    ck_assert_uint_eq(line_count().whole, 1);
    ck_assert_uint_eq(line_answers(7, 1), 1);
    ck_assert_uint_eq(rkm04_now(rkm04_of(segment_unit(line, 2))), 0);
}
END_TEST

START_TEST(a_unit_that_loses_power_stops_in_the_middle_of_its_answer)
{
    begin(three);
    size_t length = line_ask(2, VERSION, 1, 0);
    segment_advance(line, line_passed(0, length + 1 + 10) + 200); /* in the middle of its byte 11 */
    ck_assert_uint_eq(heard->count, 10);
    segment_power(line, 2, false);
    line_ask(1, VERSION, 1, line_settle());
    line_settle();
    ck_assert_uint_eq(line_answers(2, 1), 0);
    ck_assert_uint_eq(line_answers(1, 1), 1);
}
END_TEST

START_TEST(a_unit_that_loses_power_during_the_turnaround_does_not_answer)
{
    begin(three);
    size_t length = line_ask(2, VERSION, 1, 0);
    segment_advance(line, line_passed(0, length) + 100);
    ck_assert(!segment_idle(line));
    segment_power(line, 2, false);
    ck_assert(segment_idle(line));
    segment_advance(line, SECOND);
    ck_assert_uint_eq(heard->count, 0);
    ck_assert_uint_eq(line_rig.monitored, length);
}
END_TEST

START_TEST(U8_power_up_begins_anew_with_a_time_of_its_own)
{
    begin(three);
    line_set(2, '1', "F100 R", 0);
    segment_advance(line, 2 * SECOND);
    ck_assert_int_eq(line_motor(2, 1).position, 100);
    segment_power(line, 2, false);
    segment_advance(line, 2 * SECOND + 777);
    segment_power(line, 2, true);
    ck_assert_uint_eq(segment_since(line, 2), 2 * SECOND + 777);
    ck_assert_int_eq(line_motor(2, 1).position, 0);
    ck_assert_uint_eq(line_motor(2, 1).commands, 0);
    line_ask(2, VERSION, 1, 3 * SECOND);
    ck_assert_uint_eq(rkm04_now(rkm04_of(segment_unit(line, 2))), SECOND - 777);
    line_settle();
    ck_assert_uint_eq(line_answers(2, 1), 1);
}
END_TEST

START_TEST(next_events_count_in_the_time_of_the_line)
{
    begin(three);
    ck_assert_uint_eq(segment_next_event(line), RKM04_NEVER);
    segment_advance(line, 12345);
    segment_power(line, 2, true);
    ck_assert_int_eq(rkm04_set_command(rkm04_of(segment_unit(line, 2)), '1', "W5", 2, NULL), 0);
    ck_assert_uint_eq(segment_next_event(line), 12345 + rkm04_next_event(rkm04_of(segment_unit(line, 2))));
}
END_TEST

START_TEST(with_an_echo_the_host_receives_its_own_bytes)
{
    struct segment_config config = line_timed();
    config.echo = true;
    config.timed = _i == 0;
    line_begin(&config, one, NULL);
    uint8_t request[64];
    size_t length = line_frame(1, VERSION, 1, request);
    segment_queue_bytes(line, request, length, 0);
    line_settle();
    ck_assert_uint_eq(heard->count, length + ANSWER_BYTES);
    ck_assert_mem_eq(heard->byte, request, length);
    ck_assert_uint_eq(line_answers(1, 1), 1);
}
END_TEST

START_TEST(a_break_spoils_what_is_sent_meanwhile)
{
    begin(one);
    size_t length = line_ask(1, VERSION, 1, 0);
    segment_advance(line, line_passed(0, length + 5));
    segment_break(line, true);
    segment_advance(line, line_passed(0, length + 10));
    segment_break(line, false);
    uint64_t quiet = line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 0);
    ck_assert_uint_gt(segment_counters(line).framing_errors, 0);
    line_ask(1, VERSION, 1, quiet);
    line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 1);
}
END_TEST

START_TEST(a_break_that_ends_while_bytes_take_no_time_is_over)
{
    begin(one);
    segment_break(line, true);
    segment_advance(line, 5000);
    segment_set_timed(line, false);
    segment_break(line, false);
    segment_set_timed(line, true);
    line_ask(1, VERSION, 1, 50000);
    line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 1);
}
END_TEST

START_TEST(a_break_that_begins_while_bytes_take_no_time_is_there_when_they_do)
{
    begin(one);
    segment_set_timed(line, false);
    segment_break(line, true);
    segment_set_timed(line, true);
    line_ask(1, VERSION, 1, 100);
    segment_advance(line, 100000);
    ck_assert_uint_eq(line_answers(1, 1), 0);
}
END_TEST

START_TEST(a_break_is_no_byte_for_the_host_either)
{
    struct segment_config config = line_timed();
    config.echo = true;
    line_begin(&config, one, NULL);
    segment_break(line, true);
    segment_advance(line, 5000);
    segment_break(line, false);
    line_settle();
    ck_assert_uint_eq(heard->count, 0);
    ck_assert_uint_eq(line_rig.monitored, 1);
    ck_assert(line_rig.monitor[0].lost);
}
END_TEST

START_TEST(bytes_that_are_purged_never_set_out)
{
    begin(one);
    size_t length = line_ask(1, VERSION, 1, 0);
    segment_advance(line, 1000); /* the second byte is on the wire */
    ck_assert_uint_eq(segment_purge(line), length - 2);
    size_t again = line_ask(1, VERSION, 1, 1000); /* follows the second byte */
    line_settle();
    ck_assert_uint_eq(line_answers(1, 1), 1);
    ck_assert_uint_eq(line_rig.monitor[1 + again].tick, line_passed(0, 2 + again));
}
END_TEST

/* ---- State ------------------------------------------------------------------------------------------------------------ */

START_TEST(a_frame_is_open_until_its_last_byte)
{
    uint8_t bytes[32];
    struct segment_config config = line_timed();
    config.timed = _i == 0;
    line_begin(&config, three, NULL);
    ck_assert(!segment_in_frame(line));
    size_t length = line_frame(2, VERSION, 1, bytes);
    segment_queue_bytes(line, bytes, length - 1, 0);
    line_settle();
    ck_assert(segment_in_frame(line));
    segment_queue_bytes(line, bytes + length - 1, 1, segment_now(line));
    line_settle();
    ck_assert(!segment_in_frame(line));
}
END_TEST

START_TEST(a_line_is_idle_before_the_first_byte_and_after_the_last_one)
{
    begin(three);
    ck_assert(segment_idle(line));
    line_ask(1, VERSION, 1, 100);
    ck_assert_uint_eq(segment_due(line), line_passed(100, 1));
    while (line_answers(1, 1) == 0) {
        ck_assert(!segment_idle(line));
        segment_advance(line, segment_due(line));
    }
    ck_assert(segment_idle(line));
    ck_assert_uint_eq(segment_due(line), RKM04_NEVER);
    ck_assert_uint_eq(segment_room(line), SEGMENT_ROOM);
}
END_TEST

START_TEST(U4_there_is_room_for_sixteen_units)
{
    static const struct device_port nothing;
    struct device_config config = {.node = 1};
    begin(all);
    ck_assert_uint_eq(segment_add_unit(line, &config, &nothing, NULL), 0);
    ck_assert_uint_eq(line->units, 16);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 60);
    suite_add_tcase(suite, tcase);
    return tcase;
}

int main(void)
{
    Suite *suite = suite_create("segment");
    TCase *times = add_case(suite, "times");
    tcase_add_test(times, U7_byte_k_of_a_burst_has_passed_after_k_times_ten_bits);
    tcase_add_test(times, U7_six_thousand_bytes_take_their_time_to_the_tick);
    tcase_add_test(times, U7_bytes_handed_over_when_the_one_before_has_passed_follow_without_a_gap);
    tcase_add_test(times, U7_gaps_between_bytes_are_kept);
    tcase_add_test(times, K4_a_request_acts_when_its_last_byte_has_passed);
    tcase_add_loop_test(times, the_answer_begins_when_the_turnaround_is_over, 0, 5);
    TCase *addresses = add_case(suite, "addresses");
    tcase_add_test(addresses, U4_each_of_sixteen_units_answers_for_itself_alone);
    tcase_add_test(addresses, L1_answers_of_others_are_received_and_not_obeyed);
    tcase_add_test(addresses, L3_a_broadcast_is_obeyed_by_all_and_answered_by_none);
    tcase_add_test(addresses, L3_a_request_for_nobody_is_answered_by_nobody);
    TCase *collisions = add_case(suite, "collisions");
    tcase_add_test(collisions, two_units_of_one_address_with_the_same_answer_look_like_one);
    tcase_add_test(collisions, two_units_of_one_address_with_different_answers_destroy_them);
    tcase_add_test(collisions, two_units_of_one_address_with_different_programs_destroy_their_answers);
    tcase_add_loop_test(collisions, a_request_that_begins_during_an_answer_collides_with_it, 0, 60);
    tcase_add_test(collisions, a_request_right_after_another_one_collides_with_its_answer);
    tcase_add_test(collisions, a_request_after_the_last_byte_of_an_answer_does_not_collide);
    TCase *waiting = add_case(suite, "waiting");
    tcase_add_test(waiting, P10_a_request_during_the_turnaround_is_taken_after_the_answer);
    tcase_add_test(waiting, P10_a_third_request_during_the_turnaround_is_lost);
    TCase *power = add_case(suite, "power");
    tcase_add_test(power, a_unit_without_power_is_silent_and_the_others_work_on);
    tcase_add_test(power, a_unit_that_loses_power_stops_in_the_middle_of_its_answer);
    tcase_add_test(power, a_unit_that_loses_power_during_the_turnaround_does_not_answer);
    tcase_add_test(power, U8_power_up_begins_anew_with_a_time_of_its_own);
    tcase_add_test(power, next_events_count_in_the_time_of_the_line);
    TCase *host = add_case(suite, "master");
    tcase_add_loop_test(host, with_an_echo_the_host_receives_its_own_bytes, 0, 2);
    tcase_add_test(host, a_break_spoils_what_is_sent_meanwhile);
    tcase_add_test(host, a_break_that_ends_while_bytes_take_no_time_is_over);
    tcase_add_test(host, a_break_that_begins_while_bytes_take_no_time_is_there_when_they_do);
    tcase_add_test(host, a_break_is_no_byte_for_the_host_either);
    tcase_add_test(host, bytes_that_are_purged_never_set_out);
    TCase *state = add_case(suite, "state");
    tcase_add_loop_test(state, a_frame_is_open_until_its_last_byte, 0, 2);
    tcase_add_test(state, a_line_is_idle_before_the_first_byte_and_after_the_last_one);
    tcase_add_test(state, U4_there_is_room_for_sixteen_units);
    return rig_run(suite, "./test_segment");
}
