/* SPDX-License-Identifier: MIT */
/* test_sim.c: a line with everything around it in virtual time. One test alone: CK_RUN_CASE=NAME ./test_sim */
#include <check.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "core/story.h"
#include "device/rkm04_device.h"
#include "sim/sim.h"

#define LINES_MAX 400000u /* bytes of what was seen */

/* A line, and all that was seen of it, in words. */
struct seen {
    struct sim sim;
    struct watcher watcher;
    size_t length;
    bool backwards; /* something was reported after something later */
    uint64_t last;
    char text[LINES_MAX];
};

static struct seen *one;

static void add(struct seen *seen, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    seen->length += (size_t)vsnprintf(seen->text + seen->length, LINES_MAX - seen->length, format, list);
    va_end(list);
    ck_assert_uint_lt(seen->length, LINES_MAX);
}

static void on_event(void *context, const struct watch_event *event)
{
    struct seen *seen = context;
    seen->backwards = seen->backwards || event->tick < seen->last;
    seen->last = event->tick;
    add(seen, "%" PRIu64 " %s %u %u %" PRId32 "\n", event->tick, watch_kind_name(event->kind), event->unit, event->motor,
        event->value);
}

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    struct seen *seen = context;
    for (size_t i = 0; i < length; i++)
        add(seen, "%" PRIu64 " master hears %02X\n", sim_now(&seen->sim), bytes[i]);
}

static struct seen *line(bool timed, unsigned units, uint32_t kinds)
{
    struct seen *seen = calloc(1, sizeof *seen);
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_hdlc}),
        .nodes = {.count = units, .node = {1, 2, 3}},
        .timed = timed,
        .turnaround = timed ? SEGMENT_TURNAROUND : 0,
        .seed = 1,
        .out = hear,
        .context = seen,
    };
    ck_assert(sim_begin(&seen->sim, &config));
    seen->watcher = (struct watcher){.kinds = kinds, .on_event = on_event, .context = seen};
    sim_watch(&seen->sim, &seen->watcher);
    return seen;
}

static void line_ends(struct seen *seen)
{
    sim_end(&seen->sim);
    free(seen);
}

/* A request from the host at the present tick. */
static void ask(struct seen *seen, uint8_t node, const void *message, size_t length)
{
    const struct rkm04_framing *framing = &rkm04_hdlc;
    struct rkm04_sender sender;
    uint8_t frame[2 * STORY_TEXT_MAX + 32];
    size_t at = framing->begin(&sender, node, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        at += framing->put(&sender, ((const uint8_t *)message)[i], frame + at);
    at += framing->end(&sender, frame + at);
    sim_queue_bytes(&seen->sim, frame, at, sim_now(&seen->sim));
}

static void set(struct seen *seen, uint8_t node, char motor, const char *text)
{
    char message[STORY_TEXT_MAX];
    int length = snprintf(message, sizeof message, "\x02%c%s", motor, text);
    ask(seen, node, message, (size_t)length);
}

static json_t *command(struct seen *seen, const char *method, const char *params)
{
    struct refusal refusal;
    json_t *json = json_loads(params, 0, NULL), *result = sim_command(&seen->sim, method, json, &refusal);
    ck_assert_msg(result, "%s %s: refused: %s", method, params, refusal.text);
    json_decref(json);
    return result;
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

/* What one of the clocks would do: real looks every now and then, max goes from one happening to the next, stepped goes by
 * ticks. */
static void go_to(struct seen *seen, uint64_t tick, unsigned way, uint64_t *dice)
{
    while (sim_now(&seen->sim) < tick) {
        uint64_t end = tick, event = sim_next_event(&seen->sim), byte = sim_due(&seen->sim);
        *dice = *dice * UINT64_C(6364136223846793005) + 1442695040888963407u;
        if (way == 1)
            end = sim_now(&seen->sim) + 1u + (*dice >> 40) % 3000u;
        else if (way == 2 && event < tick)
            end = event + 1u;
        else if (way == 3)
            end = sim_now(&seen->sim) + 7u;
        if (way == 2 && byte < end)
            end = byte;
        sim_advance(&seen->sim, end > tick ? tick : end > sim_now(&seen->sim) ? end : sim_now(&seen->sim) + 1u);
    }
}

/* Tell a story to two units, in one of the ways. */
static struct seen *live(const struct story *story, bool timed, unsigned way)
{
    struct seen *seen = line(timed, 2, WATCH_ALL);
    uint64_t dice = story->seed;
    for (unsigned i = 0; i < story->count; i++) {
        const struct action *action = &story->action[i];
        uint8_t message[STORY_TEXT_MAX + 2] = {2, (uint8_t)action->motor};
        go_to(seen, action->tick, way, &dice);
        if (action->kind == ACT_INPUTS) {
            sim_set_di(&seen->sim, 1 + i % 2, action->inputs);
        } else if (action->kind == ACT_TEXT) {
            memcpy(message + 2, action->text, action->length);
            ask(seen, (uint8_t)(1 + i % 2), message, 2u + action->length);
        } else if (action->kind == ACT_FRAME) {
            sim_queue_bytes(&seen->sim, action->text, action->length, sim_now(&seen->sim));
        }
    }
    go_to(seen, story->end, way, &dice);
    return seen;
}

START_TEST(K3_the_same_session_is_told_the_same_whatever_the_clock_does)
{
    static struct story story;
    for (unsigned seed = 0; seed < 12; seed++) {
        story_tell(&story, 8000 + seed, 60000, seed % 2 != 0);
        bool timed = seed % 3 != 0;
        struct seen *whole = live(&story, timed, 0);
        for (unsigned way = 1; way <= 3; way++) {
            struct seen *cut = live(&story, timed, way);
            ck_assert_msg(whole->length == cut->length && memcmp(whole->text, cut->text, cut->length) == 0,
                          "story %u: way %u is told otherwise", 8000 + seed, way);
            ck_assert_msg(!cut->backwards, "story %u: way %u is told out of order", 8000 + seed, way);
            line_ends(cut);
        }
        line_ends(whole);
    }
}
END_TEST

START_TEST(time_does_not_pass_by_reading_it)
{
    one = line(true, 1, WATCH_ALL);
    sim_advance(&one->sim, 5000);
    sim_advance(&one->sim, 5000);
    sim_advance(&one->sim, 100);
    ck_assert_uint_eq(sim_now(&one->sim), 5000);
    line_ends(one);
}
END_TEST

START_TEST(bytes_that_are_under_way_arrive_before_the_line_takes_no_time)
{
    one = line(true, 1, WATCH_BIT(WATCH_MESSAGE));
    ask(one, 1, "\x01", 1);
    sim_set_timed(&one->sim, false);
    ck_assert_msg(strstr(one->text, "master hears 7E"), "no answer: %s", one->text);
    ck_assert_uint_gt(sim_now(&one->sim), 6 * 521);
    uint64_t now = sim_now(&one->sim);
    one->length = 0;
    ask(one, 1, "\x01", 1);
    sim_advance(&one->sim, now);
    ck_assert_msg(strstr(one->text, "master hears 7E"), "no answer at the instant: %s", one->text);
    line_ends(one);
}
END_TEST

/* ---- Inputs and power ----------------------------------------------------------------------------------------------- */

START_TEST(an_input_is_told_when_it_changes_and_reaches_the_unit)
{
    one = line(false, 2, WATCH_BIT(WATCH_INPUTS) | WATCH_BIT(WATCH_OUTPUTS));
    set(one, 2, '1', "O05 T03");
    sim_advance(&one->sim, 10500);
    sim_set_di(&one->sim, 2, 0x10);
    sim_set_di(&one->sim, 2, 0x10);
    sim_advance(&one->sim, 20000);
    ck_assert_ptr_nonnull(strstr(one->text, "10500 inputs 2 0 16\n12000 outputs 2 0 4\n"));
    ck_assert_ptr_null(strstr(one->text, "inputs 1"));
    line_ends(one);
}
END_TEST

START_TEST(U5_inputs_stay_when_the_power_goes_and_comes)
{
    one = line(false, 1, WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_INPUTS));
    sim_set_di(&one->sim, 1, 0x81);
    sim_advance(&one->sim, 1000);
    sim_power(&one->sim, 1, false);
    sim_advance(&one->sim, 2000);
    sim_power(&one->sim, 1, true);
    sim_advance(&one->sim, 3000);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&one->sim, 1))), 0x81);
    ck_assert_str_eq(one->text, "0 inputs 1 0 129\n1000 power 1 0 0\n2000 power 1 0 1\n2000 inputs 1 0 129\n");
    line_ends(one);
}
END_TEST

START_TEST(flash_costs_nothing_until_something_is_stored)
{
    uint8_t byte = 0;
    one = line(false, 1, WATCH_BIT(WATCH_MOTION));
    sim_advance(&one->sim, 100000);
    sim_power(&one->sim, 1, false);
    sim_power(&one->sim, 1, true);
    ck_assert_ptr_null(one->sim.unit[0].memory);
    ck_assert_int_eq(sim_flash_read(&one->sim.unit[0], 7, 4095, &byte, 1), 0);
    ck_assert_uint_eq(byte, 0xFF);
    ck_assert_int_eq(sim_flash_program(&one->sim.unit[0], 7, 4088, "ABCDEFG", 8), 0);
    ck_assert_ptr_nonnull(one->sim.unit[0].memory);
    ck_assert_int_eq(sim_flash_read(&one->sim.unit[0], 7, 4088, &byte, 1), 0);
    ck_assert_uint_eq(byte, 'A');
    ck_assert_int_eq(sim_flash_read(&one->sim.unit[0], 6, 0, &byte, 1), 0);
    ck_assert_uint_eq(byte, 0xFF);
    line_ends(one);
}
END_TEST

START_TEST(pulses_cost_nothing_while_nobody_wants_them)
{
    one = line(false, 1, WATCH_BIT(WATCH_MOTION));
    set(one, 1, '1', "S1000 V1000 F1000 R");
    sim_advance(&one->sim, 100000);
    ck_assert_ptr_null(one->sim.unit[0].port.steps);
    struct watcher watcher = {.kinds = WATCH_BIT(WATCH_STEP), .on_event = on_event, .context = one};
    sim_watch(&one->sim, &watcher);
    sim_advance(&one->sim, 102000);
    sim_unwatch(&one->sim, &watcher);
    sim_advance(&one->sim, 2000000);
    ck_assert_msg(strstr(one->text, "100000 step 1 1 ") || strstr(one->text, "101000 step 1 1 "), "%s", one->text);
    ck_assert_ptr_null(strstr(one->text, "102000 step"));
    struct rkm04_motor_state state;
    rkm04_motor_state(rkm04_of(sim_core(&one->sim, 1)), 1, &state);
    ck_assert_int_eq(state.position, 1000);
    line_ends(one);
}
END_TEST

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

START_TEST(a_command_that_is_wrong_says_what_was_expected_and_changes_nothing)
{
    static const struct {
        const char *method, *params, *expected;
        int code;
    } of[] = {
        {"no.such", "{}", "there is no method `no.such'", REFUSED_METHOD},
        {"state", "[1]", "params: expected an object", REFUSED_PARAMS},
        {"power", "{\"on\": false}", "unit: missing: expected one of 1, 2", REFUSED_PARAMS},
        {"power", "{\"unit\": 7, \"on\": false}", "expected one of 1, 2", REFUSED_PARAMS},
        {"power", "{\"unit\": \"2\\u0000\", \"on\": false}", "expected one of 1, 2", REFUSED_PARAMS},
        {"power", "{\"unit\": {}, \"on\": false}", "expected one of 1, 2", REFUSED_PARAMS},
    };
    struct refusal refusal = {0};
    one = line(false, 2, WATCH_BIT(WATCH_POWER));
    json_t *params = json_loads(of[_i].params, JSON_ALLOW_NUL, NULL);
    ck_assert_ptr_nonnull(params);
    ck_assert_ptr_null(sim_command(&one->sim, of[_i].method, params, &refusal));
    ck_assert_msg(strstr(refusal.text, of[_i].expected), "%s", refusal.text);
    ck_assert_int_eq(refusal.code, of[_i].code);
    sim_advance(&one->sim, 1000);
    ck_assert_str_eq(one->text, "");
    json_decref(params);
    line_ends(one);
}
END_TEST

static void on_command(void *context, uint64_t now, const char *method, const json_t *params)
{
    char *text = json_dumps(params, JSON_COMPACT);
    add(context, "%" PRIu64 " %s %s\n", now, method, text);
    free(text);
}

START_TEST(what_is_obeyed_is_taken_down_in_the_journal_and_what_only_asks_is_not)
{
    one = line(false, 1, 0);
    const struct sim_journal journal = {.command = on_command, .context = one};
    one->sim.journal = &journal;
    sim_advance(&one->sim, 500);
    json_decref(command(one, "power", "{\"on\":false}"));
    json_decref(command(one, "state", "{}"));
    ck_assert_str_eq(one->text, "500 power {\"on\":false}\n");
    one->sim.journal = NULL;
    line_ends(one);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sim");
    TCase *tcase = tcase_create("time");
    tcase_set_timeout(tcase, 200);
    tcase_add_test(tcase, K3_the_same_session_is_told_the_same_whatever_the_clock_does);
    tcase_add_test(tcase, time_does_not_pass_by_reading_it);
    tcase_add_test(tcase, bytes_that_are_under_way_arrive_before_the_line_takes_no_time);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("units");
    tcase_add_test(tcase, an_input_is_told_when_it_changes_and_reaches_the_unit);
    tcase_add_test(tcase, U5_inputs_stay_when_the_power_goes_and_comes);
    tcase_add_test(tcase, flash_costs_nothing_until_something_is_stored);
    tcase_add_test(tcase, pulses_cost_nothing_while_nobody_wants_them);
    suite_add_tcase(suite, tcase);
    tcase = tcase_create("commands");
    tcase_add_loop_test(tcase, a_command_that_is_wrong_says_what_was_expected_and_changes_nothing, 0, 6);
    tcase_add_test(tcase, what_is_obeyed_is_taken_down_in_the_journal_and_what_only_asks_is_not);
    suite_add_tcase(suite, tcase);
    return rig_run(suite, "./test_sim");
}
