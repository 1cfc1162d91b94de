/* SPDX-License-Identifier: MIT */
/* test_segment_time.c: a line without time (--baud 0), one in the framing plain (L2), how time may be cut (K3), and a full load.
 * One case alone: CK_RUN_CASE=CASE ./test_segment_time */
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "segment_rig.h"

#define line (&line_rig.segment)
#define heard (&line_rig.host)
#define VERSION "\1"

static const uint8_t three[] = {1, 2, 7, 0}, twins[] = {5, 5, 0};
static const uint8_t all[] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 0};
static const struct segment_config untimed = {.timed = false, .turnaround = SEGMENT_TURNAROUND};

/* ---- Without time --------------------------------------------------------------------------------------------------- */

START_TEST(without_time_the_answer_comes_in_the_tick_of_the_request)
{
    line_begin(&untimed, three, NULL);
    line_ask(2, VERSION, 1, 4321);
    ck_assert_uint_eq(segment_due(line), 4321);
    segment_advance(line, 4321);
    ck_assert_uint_eq(line_answers(2, 1), 1);
    ck_assert_uint_eq(heard->tick[heard->count - 1], 4321);
    ck_assert_uint_eq(line_unit_counters(1).others, 2);
    ck_assert_uint_eq(segment_due(line), RKM04_NEVER);
}
END_TEST

START_TEST(P10_requests_in_one_go_are_all_answered_in_their_order)
{
    line_begin(&untimed, three, NULL);
    for (unsigned i = 0; i < 10; i++) {
        line_ask(1, "\0040", 2, 0);
        line_ask(2, VERSION, 1, 0);
        line_ask(1, "\0051", 2, 0);
    }
    segment_advance(line, 0);
    ck_assert_uint_eq(line_answers(1, 4), 10);
    ck_assert_uint_eq(line_answers(2, 1), 10);
    ck_assert_uint_eq(line_answers(1, 5), 10);
    ck_assert_uint_eq(segment_counters(line).overruns, 0);
    ck_assert_uint_eq(segment_room(line), SEGMENT_ROOM);
}
END_TEST

START_TEST(without_time_nothing_collides)
{
    line_begin(&untimed, twins, NULL);
    line_ask(5, VERSION, 1, 0);
    line_settle();
    ck_assert_uint_eq(line_answers(5, 1), 2); /* one after the other */
    ck_assert_uint_eq(segment_counters(line).collisions, 0);
    ck_assert_uint_eq(line_rig.monitor[line_rig.monitored - 1].senders, 1u << 2);
}
END_TEST

START_TEST(L3_without_time_a_broadcast_is_obeyed_by_all)
{
    line_begin(&untimed, all, NULL);
    line_set(0, '0', "F100", 0);
    line_settle();
    ck_assert_uint_eq(heard->count, 0);
    for (unsigned number = 1; number <= 16; number++)
        ck_assert_uint_eq(line_motor(number, 4).commands, 1);
}
END_TEST

START_TEST(without_time_every_byte_is_taken_and_none_is_lost)
{
    static uint8_t noise[SEGMENT_ROOM];
    memset(noise, 0x7E, sizeof noise);
    line_begin(&untimed, three, NULL);
    segment_queue_bytes(line, noise, sizeof noise, 10);
    ck_assert_uint_eq(segment_room(line), 0);
    segment_advance(line, 10);
    ck_assert_uint_eq(segment_room(line), SEGMENT_ROOM);
    ck_assert_uint_eq(segment_counters(line).bytes, SEGMENT_ROOM);
}
END_TEST

/* ---- L2 --------------------------------------------------------------------------------------------------------------- */

START_TEST(L2_units_are_addressed_and_answer_in_plain)
{
    struct segment_config config = _i == 0 ? line_timed() : untimed;
    line_begin(&config, three, &rkm04_plain);
    uint64_t tick = 0;
    for (unsigned round = 0; round < 3; round++) {
        line_ask(2, "\0040", 2, tick);
        tick = line_settle();
        line_ask(7, VERSION, 1, tick);
        tick = line_settle();
        line_set(0, '1', "F1", tick); /* and none answers */
        tick = line_settle();
    }
    ck_assert_uint_eq(line_answers(2, 4), 3);
    ck_assert_uint_eq(line_answers(7, 1), 3);
    ck_assert_uint_eq(line_count().whole, 6);
    ck_assert_uint_eq(line_unit_counters(1).dropped, 0);
    ck_assert_uint_eq(line_motor(1, 1).commands, 3);
}
END_TEST

START_TEST(L2_silence_brings_everybody_back_after_a_collision)
{
    struct segment_config config = line_timed();
    line_begin(&config, three, &rkm04_plain);
    size_t length = line_ask(1, VERSION, 1, 0);
    line_ask(2, VERSION, 1, line_passed(0, length) + 3000); /* into the answer */
    uint64_t quiet = line_settle();
    ck_assert_uint_gt(segment_counters(line).collisions, 0);
    heard->count = 0;
    line_ask(7, VERSION, 1, quiet + 100000);
    line_settle();
    ck_assert_uint_eq(line_answers(7, 1), 1);
}
END_TEST

START_TEST(L2_units_that_take_answers_for_requests_do_not_stop_the_time)
{
    uint8_t request[8];
    line_begin(&untimed, twins, &rkm04_plain);
    size_t length = line_frame(5, "\377", 1, request);
    segment_power(line, 2, false);
    segment_queue_bytes(line, request, length - 1, 0);
    segment_advance(line, 0);
    segment_power(line, 2, true); /* misses the request, and takes the answer for one */
    segment_queue_bytes(line, request + length - 1, 1, 0);
    segment_advance(line, 0);
    ck_assert_uint_eq(line_count().whole, 1);
    ck_assert_uint_eq(segment_due(line), 1);
    segment_advance(line, 100);
    ck_assert_uint_eq(line_count().whole, 101); /* one in each tick */
    segment_power(line, 2, false);
    segment_advance(line, 200);
    ck_assert_uint_eq(segment_due(line), RKM04_NEVER);
    ck_assert_uint_le(line_count().whole, 102);
}
END_TEST

/* ---- How time is cut -------------------------------------------------------------------------------------------------- */

#define STORY_END (100 * MS)

enum way { TICK_BY_TICK, FROM_DUE_TO_DUE, FROM_ACTION_TO_ACTION, WAYS };

static uint32_t seed;

static uint32_t any(uint32_t below)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % below;
}

/* Bring the line to `tick`. No byte reaches anybody before segment_due() has said so. */
static void cut(enum way way, uint64_t tick)
{
    while (segment_now(line) < tick) {
        uint64_t due = segment_due(line), next = tick;
        size_t before = line_rig.monitored + heard->count;
        if (way == TICK_BY_TICK)
            next = segment_now(line) + 1;
        else if (way == FROM_DUE_TO_DUE && due > segment_now(line) && due < tick)
            next = due;
        segment_advance(line, next);
        ck_assert_uint_eq(segment_now(line), next);
        ck_assert(way != TICK_BY_TICK || next >= due || line_rig.monitored + heard->count == before);
    }
}

static void act(uint64_t tick)
{
    static const uint8_t node[] = {0, 1, 2, 5, 9};
    uint8_t noise[3] = {(uint8_t)any(256), 0x7E, (uint8_t)any(256)};
    uint8_t dnode = node[any(5)];
    switch (any(8)) {
    case 0:
        segment_queue_bytes(line, noise, 1 + any(3), tick);
        break;
    case 1:
        line_set(dnode, '1', any(2) ? "F50 R" : "\\B7 R W1", tick);
        break;
    case 2:
        segment_power(line, 1 + any(4), any(4) != 0);
        break;
    case 3:
        segment_break(line, any(2) != 0);
        break;
    case 4:
        if (any(3) == 0)
            segment_purge(line);
        break;
    case 5:
        line_ask(dnode, "\0040", 2, tick);
        break;
    default:
        line_ask(dnode, VERSION, 1, tick);
    }
}

static void tell_story(enum way way, int number, const struct rkm04_framing *framing)
{
    static const uint8_t nodes[] = {1, 2, 5, 5, 0};
    seed = (uint32_t)number;
    struct segment_config config = line_timed();
    config.timed = number % 4 != 0;
    config.echo = any(2) != 0;
    config.turnaround = any(2) ? SEGMENT_TURNAROUND : any(8000);
    line_begin(&config, nodes, framing);
    for (uint64_t tick = any(9000); tick < STORY_END; tick += any(3) ? any(9000) : any(400)) {
        cut(way, tick);
        act(tick);
    }
    segment_break(line, false);
    cut(way, STORY_END);
}

START_TEST(K3_how_the_time_is_cut_makes_no_difference)
{
    static struct line_rig first;
    const struct rkm04_framing *framing = _i % 3 == 2 ? &rkm04_plain : &rkm04_hdlc;
    for (enum way way = 0; way < WAYS; way++) {
        tell_story(way, _i, framing);
        if (way == 0) {
            segment_end(&first.segment);
            first = line_rig; /* its units, too */
            memset(line_rig.segment.unit, 0, sizeof line_rig.segment.unit);
            continue;
        }
        ck_assert_uint_eq(heard->count, first.host.count);
        ck_assert_mem_eq(heard->byte, first.host.byte, heard->count);
        ck_assert_mem_eq(heard->tick, first.host.tick, heard->count * sizeof heard->tick[0]);
        ck_assert_uint_eq(line_rig.monitored, first.monitored);
        for (size_t i = 0; i < line_rig.monitored; i++) {
            ck_assert_uint_eq(line_rig.monitor[i].start, first.monitor[i].start);
            ck_assert_uint_eq(line_rig.monitor[i].tick, first.monitor[i].tick);
            ck_assert_uint_eq(line_rig.monitor[i].byte, first.monitor[i].byte);
            ck_assert_uint_eq(line_rig.monitor[i].senders, first.monitor[i].senders);
        }
        for (unsigned number = 1; number <= 4; number++) {
            struct rkm04_unit *unit = rkm04_of(segment_unit(&first.segment, number));
            struct rkm04_counters now = line_unit_counters(number), then = rkm04_counters(unit);
            ck_assert_mem_eq(&now, &then, sizeof now);
            struct rkm04_motor_state state;
            rkm04_motor_state(unit, 1, &state);
            ck_assert_int_eq(line_motor(number, 1).position, state.position);
            ck_assert_int_eq(line_motor(number, 1).state, state.state);
        }
    }
    ck_assert_uint_gt(heard->count, 0);
}
END_TEST

/* ---- Load ------------------------------------------------------------------------------------------------------------- */

#define MINUTE (60 * SECOND)

/* Polls of the load, and the position that was answered last. */
static struct {
    struct segment segment;
    struct rkm04_receiver receiver;
    uint8_t answer[64];
    uint64_t polls, answers;
    uint64_t bytes;           /* of answers */
    size_t request;           /* bytes of the last request */
    uint64_t asked, answered; /* ticks of the last ones */
    int32_t position;
    bool whole;
} load;

static void take_answer(void *context, const uint8_t *bytes, size_t length)
{
    (void)context;
    load.bytes += length;
    for (size_t i = 0; i < length; i++) {
        uint64_t now = segment_now(&load.segment);
        if (!rkm04_hdlc.receive(&load.receiver, bytes[i], now, load.answer, sizeof load.answer))
            continue;
        ck_assert_uint_eq(load.receiver.length, 13);
        load.answer[13] = 0;
        load.position = atoi((const char *)load.answer + 3);
        load.answered = now;
        load.answers++;
        load.whole = true;
    }
}

/* Ask for the position of a motor and wait for the answer, which has to come from this unit. */
static void poll(uint8_t node, unsigned motor)
{
    uint8_t bytes[32], message[2] = {4, (uint8_t)('0' + motor)};
    load.asked = segment_now(&load.segment);
    load.request = line_frame(node, message, 2, bytes);
    segment_queue_bytes(&load.segment, bytes, load.request, load.asked);
    load.whole = false;
    load.polls++;
    while (!load.whole) {
        ck_assert_msg(segment_due(&load.segment) != RKM04_NEVER, "unit %u does not answer", node);
        segment_advance(&load.segment, segment_due(&load.segment));
    }
    ck_assert_uint_eq(load.receiver.snode, node);
    ck_assert_uint_eq(load.answer[1], message[1]);
}

START_TEST(U3_sixteen_units_at_full_speed_are_polled_for_a_minute_without_loss)
{
    static const struct rkm04_port nowhere;
    static const struct device_port nothing;
    static struct rkm04_unit alone; /* what the first unit would be on a line of its own */
    struct segment_config config = line_timed();
    config.out = take_answer;
    memset(&load.receiver, 0, sizeof load.receiver);
    load.polls = load.answers = load.bytes = 0;
    uint64_t sent = 0;
    segment_end(&load.segment);
    segment_begin(&load.segment, &config);
    line_rig.framing = &rkm04_hdlc;
    struct rkm04_config unit = {.node = 1};
    rkm04_init(&alone, &unit, &nowhere, NULL);
    for (; unit.node <= 16; unit.node++)
        segment_add_unit(&load.segment, &(struct device_config){.node = unit.node}, &nothing, NULL);

    static const char go[] = "\0020S2000 A60000 V16000 G+";
    uint8_t bytes[80];
    size_t length = line_frame(0, go, sizeof go - 1, bytes);
    segment_queue_bytes(&load.segment, bytes, length, 0);
    segment_advance(&load.segment, line_passed(0, length));
    rkm04_advance(&alone, line_passed(0, length));
    rkm04_receive(&alone, bytes, length);

    for (unsigned i = 0; segment_now(&load.segment) < MINUTE; i++) {
        uint64_t before = load.bytes;
        poll((uint8_t)(1 + i % 16), 1 + i / 16 % 4);
        sent += load.request;
        uint64_t acted = line_passed(load.asked, load.request);
        ck_assert_uint_eq(load.answered, line_passed(load.asked + SEGMENT_TURNAROUND, load.request + load.bytes - before));
        rkm04_advance(&alone, acted - rkm04_now(&alone));
        struct rkm04_motor_state state;
        rkm04_motor_state(&alone, 1, &state);
        ck_assert_int_eq(load.position, state.position);
    }
    ck_assert_uint_eq(load.answers, load.polls);
    ck_assert_uint_gt(load.polls, 4000);
    ck_assert_int_gt(load.position, 59 * 16000);
    struct segment_counters counters = segment_counters(&load.segment);
    ck_assert_uint_eq(counters.collisions + counters.framing_errors + counters.overruns, 0);
    ck_assert_uint_eq(counters.bytes, length + sent + load.bytes);
}
END_TEST

static TCase *add_case(Suite *suite, const char *name)
{
    TCase *tcase = tcase_create(name);
    tcase_set_timeout(tcase, 120);
    suite_add_tcase(suite, tcase);
    return tcase;
}

int main(void)
{
    Suite *suite = suite_create("segment_time");
    TCase *baud0 = add_case(suite, "baud0");
    tcase_add_test(baud0, without_time_the_answer_comes_in_the_tick_of_the_request);
    tcase_add_test(baud0, P10_requests_in_one_go_are_all_answered_in_their_order);
    tcase_add_test(baud0, without_time_nothing_collides);
    tcase_add_test(baud0, L3_without_time_a_broadcast_is_obeyed_by_all);
    tcase_add_test(baud0, without_time_every_byte_is_taken_and_none_is_lost);
    TCase *plain = add_case(suite, "plain");
    tcase_add_loop_test(plain, L2_units_are_addressed_and_answer_in_plain, 0, 2);
    tcase_add_test(plain, L2_silence_brings_everybody_back_after_a_collision);
    tcase_add_test(plain, L2_units_that_take_answers_for_requests_do_not_stop_the_time);
    TCase *cuts = add_case(suite, "cuts");
    tcase_add_loop_test(cuts, K3_how_the_time_is_cut_makes_no_difference, 0, 12);
    TCase *full = add_case(suite, "load");
    tcase_add_test(full, U3_sixteen_units_at_full_speed_are_polled_for_a_minute_without_loss);
    return rig_run(suite, "./test_segment_time");
}
