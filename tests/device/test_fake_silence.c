/* SPDX-License-Identifier: MIT */
/* test_fake_silence.c: messages that end with a silence: units, wire monitor, scenarios, replays. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "fake.h"
#include "fake_device.h"
#include "fake_rig.h"
#include "record/record.h"

#define BYTE_US 521u /* a byte on the wires, rounded up */

static struct fake_rig rig;

/* ---- The wires ------------------------------------------------------------------------------------------------------ */

static void send_request(unsigned address, const char *text, uint8_t wrong)
{
    uint8_t bytes[64] = {(uint8_t)(0x80 + address)}, sum = bytes[0];
    size_t length = strlen(text);
    memcpy(bytes + 1, text, length);
    for (size_t i = 0; i < length; i++)
        sum = (uint8_t)(sum + bytes[1 + i]);
    bytes[1 + length] = (uint8_t)(sum + wrong);
    sim_queue_bytes(&rig.sim, bytes, length + 2, sim_now(&rig.sim));
}

/* Six bytes pass at 3125 us; the silence ends at 5125 us; the first byte of the answer has passed a byte later. */
START_TEST(silence_ends_a_request_and_the_answer_begins_at_once)
{
    fake_rig_begin_as(&rig, &fake_device, "end=sums", "1,2", true);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 1000000);
    ck_assert_str_eq(fake_rig_seen(&rig), "5646 heard 30\n6167 heard 30\n");
    fake_rig_end(&rig);
}
END_TEST

/* The turnaround counts from the last byte, and the silence ends within it. */
START_TEST(turnaround_that_is_longer_than_the_silence_is_kept)
{
    fake_rig_begin_as(&rig, &fake_device, "end=sums", "1", true);
    rig.sim.segment.config.turnaround = 4000;
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 1000000);
    ck_assert_str_eq(fake_rig_seen(&rig), "7646 heard 30\n8167 heard 30\n");
    fake_rig_end(&rig);
}
END_TEST

START_TEST(silence_passes_where_bytes_take_no_time)
{
    fake_rig_begin_as(&rig, &fake_device, "end=sums", "1", false);
    send_request(1, "POS?", 0);
    ck_assert_uint_eq(sim_due(&rig.sim), 0);
    sim_advance(&rig.sim, 0);
    ck_assert_uint_eq(sim_due(&rig.sim), FAKE_SILENCE);
    sim_advance(&rig.sim, 1000000);
    ck_assert_str_eq(fake_rig_seen(&rig), "2000 heard 30\n2000 heard 30\n");
    fake_rig_end(&rig);
}
END_TEST

/* A gap shorter than the silence is nothing; one as long ends the request, which is none. */
START_TEST(gap_ends_a_request_from_the_length_of_the_silence_on)
{
    static const uint8_t head[] = {0x81, 'P', 'O'}, rest[] = {'S', '?', (uint8_t)(0x81 + 'P' + 'O' + 'S' + '?')};
    for (int longer = 0; longer <= 1; longer++) {
        fake_rig_begin_as(&rig, &fake_device, "end=sums", "1", false);
        sim_queue_bytes(&rig.sim, head, sizeof head, 0);
        sim_queue_bytes(&rig.sim, rest, sizeof rest, FAKE_SILENCE - 1u + (unsigned)longer);
        sim_advance(&rig.sim, 1000000);
        ck_assert_str_eq(fake_rig_seen(&rig), longer ? "" : "3999 heard 30\n3999 heard 30\n");
        fake_rig_end(&rig);
    }
}
END_TEST

/* However time is cut, the same comes of it. */
START_TEST(cut_of_time_does_not_matter)
{
    char *whole = NULL;
    static const unsigned steps[] = {1000000, 1, 7, 500, 2000};
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        fake_rig_begin_as(&rig, &fake_device, "end=sums", "1,2", true);
        send_request(1, "MOVE 3", 0);
        send_request(2, "POS?", 0);
        for (uint64_t us = 0; us < 60000; us += steps[i])
            sim_advance(&rig.sim, us + steps[i]);
        sim_advance(&rig.sim, 1000000);
        const char *seen = fake_rig_seen(&rig);
        if (!whole)
            whole = strdup(seen);
        ck_assert_str_eq(seen, whole);
        fake_rig_end(&rig);
    }
    free(whole);
}
END_TEST

/* ---- The monitor ---------------------------------------------------------------------------------------------------- */

static char found[1024];

static void on_message(void *context, const struct watch_event *event)
{
    const struct wire_message *message = event->message;
    size_t length = strlen(found);
    (void)context;
    snprintf(found + length, sizeof found - length, "%llu-%llu %s %u %.*s%s\n", (unsigned long long)message->start,
             (unsigned long long)event->tick, message->answer ? "answer" : "request", message->dnode, (int)message->length,
             (const char *)message->message, message->dropped ? message->dropped : "");
}

static struct watcher messages = {.kinds = WATCH_BIT(WATCH_MESSAGE), .on_event = on_message};

static void begin_watching(bool timed)
{
    fake_rig_begin_as(&rig, &fake_device, "end=sums", "1,2", timed);
    found[0] = '\0';
    sim_watch(&rig.sim, &messages);
}

START_TEST(monitor_finds_messages_by_the_silence_after_them)
{
    begin_watching(true);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 20000);
    send_request(2, "OUT 1", 1);
    sim_advance(&rig.sim, 40000);
    ck_assert_str_eq(found, "0-5125 request 1 POS?\n"
                            "5125-8167 answer 0 0\n"
                            "20000-25646 request 0 wrong FCS\n");
    fake_rig_end(&rig);
}
END_TEST

/* Without time nothing but the change of the sender parts a request from its answer, and that from the next request. */
START_TEST(other_side_ends_a_message_too)
{
    begin_watching(false);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, FAKE_SILENCE);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 4 * FAKE_SILENCE);
    ck_assert_str_eq(found, "0-2000 request 1 POS?\n2000-2000 answer 0 0\n2000-4000 request 1 POS?\n4000-6000 answer 0 0\n");
    fake_rig_end(&rig);
}
END_TEST

/* As logs need it that end there. */
START_TEST(message_at_the_end_is_whole_before_its_silence_is_over)
{
    begin_watching(true);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 4000);
    struct wire_message *rest = wire_monitor_rest(&rig.sim.monitor, false);
    ck_assert_ptr_nonnull(rest);
    ck_assert_int_eq(rest->fate, WIRE_WHOLE);
    ck_assert_mem_eq(rest->message, "POS?", 4);
    free(rest);
    ck_assert_ptr_null(wire_monitor_rest(&rig.sim.monitor, true));
    fake_rig_end(&rig);
}
END_TEST

START_TEST(snapshot_in_the_middle_of_a_request_continues_with_it)
{
    fake_rig_begin_as(&rig, &fake_device, "end=sums", "1", true);
    send_request(1, "POS?", 0);
    sim_advance(&rig.sim, 4000);
    fake_rig_do(&rig, "snapshot", "{\"name\": \"a\"}");
    sim_advance(&rig.sim, 100000);
    ck_assert_str_eq(fake_rig_seen(&rig), "5646 heard 30\n6167 heard 30\n");
    fake_rig_do(&rig, "restore", "{\"name\": \"a\"}");
    sim_advance(&rig.sim, 200000);
    ck_assert_str_eq(fake_rig_seen(&rig), "101646 heard 30\n102167 heard 30\n");
    fake_rig_end(&rig);
}
END_TEST

/* ---- Scenarios ------------------------------------------------------------------------------------------------------ */

START_TEST(host_of_a_scenario_keeps_and_waits_for_silences)
{
    for (int timed = 0; timed <= 1; timed++) {
        char text[600];
        snprintf(text, sizeof text,
                 "device: fake\nend: sums\nunits: 1,2\nbaud: %s\nsteps:\n"
                 "  - message: '\"OUT 1\"'\n    unit: 1\n    answer: '\"OK\"'\n"
                 "  - message: '\"MOVE 5\"'\n    unit: 1\n    answer: '\"OK\"'\n"
                 "  - message: '\"POS?\"'\n    unit: 2\n    answer: '\"0\"'\n"
                 "  - bytes: '81 \"POS?\" 00'\n    answer: none\n    within: 10ms\n"
                 "  - expect: {unit: 1, do: {\"01\": 1}}\n",
                 timed ? "19200" : "0");
        run_story(text, SCENARIO_PASSED, NULL);
    }
    run_story("device: fake\nend: sums\nsteps:\n  - message: '\"POS?\"'\n    answer: '\"1\"'\n", SCENARIO_FAILED, "answer 30");
}
END_TEST

static Suite *fake_silence_suite(void)
{
    Suite *suite = suite_create("fake_silence");
    TCase *all = tcase_create("all");
    tcase_add_test(all, silence_ends_a_request_and_the_answer_begins_at_once);
    tcase_add_test(all, turnaround_that_is_longer_than_the_silence_is_kept);
    tcase_add_test(all, silence_passes_where_bytes_take_no_time);
    tcase_add_test(all, gap_ends_a_request_from_the_length_of_the_silence_on);
    tcase_add_test(all, cut_of_time_does_not_matter);
    tcase_add_test(all, monitor_finds_messages_by_the_silence_after_them);
    tcase_add_test(all, other_side_ends_a_message_too);
    tcase_add_test(all, message_at_the_end_is_whole_before_its_silence_is_over);
    tcase_add_test(all, snapshot_in_the_middle_of_a_request_continues_with_it);
    tcase_add_test(all, host_of_a_scenario_keeps_and_waits_for_silences);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(fake_silence_suite(), "./test_fake_silence");
}
