/* SPDX-License-Identifier: MIT */
/* test_trace_jsonl.c: traces as JSON lines, read with the library that clients use. One test alone:
 * CK_RUN_CASE=lines ./test_trace_jsonl */
#include <check.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "trace/event_json.h"
#include "trace_rig.h"

static void jsonl(void)
{
    trace_rig_begin("1", TRACE_JSONL);
}

/* The lines of the trace as a list. Every one must be an object with t_us and kind, and time must not go back. */
static json_t *lines(void)
{
    json_t *list = json_array();
    json_int_t last = 0;
    const char *text = trace_rig_text();
    while (*text) {
        size_t length = strcspn(text, "\n");
        ck_assert_int_eq(text[length], '\n');
        json_t *line = json_loadb(text, length, JSON_REJECT_DUPLICATES, NULL);
        ck_assert_msg(json_is_object(line), "'%.*s'", (int)length, text);
        ck_assert_msg(json_is_string(json_object_get(line, "kind")), "'%.*s'", (int)length, text);
        json_int_t tick = json_integer_value(json_object_get(line, "t_us"));
        ck_assert_int_ge(tick, last);
        last = tick;
        json_array_append_new(list, line);
        text += length + 1;
    }
    return list;
}

static json_t *first_of(const json_t *list, const char *kind)
{
    size_t at;
    json_t *line;
    json_array_foreach(list, at, line)
        if (strcmp(json_string_value(json_object_get(line, "kind")), kind) == 0)
            return line;
    ck_abort_msg("no %s", kind);
    return NULL;
}

static void is(const json_t *line, const char *wanted)
{
    char *text = json_dumps(line, JSON_COMPACT);
    ck_assert_str_eq(text, wanted);
    free(text);
}

START_TEST(it_begins_with_what_there_is_and_ends_with_the_time)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_set(1, '2', "S100 V100 T03 T90 F50 R");
    sim_set_di(sim, 1, 0x42);
    sim_advance(sim, 100000);
    trace_rig_end_trace();
    trace_rig_begin_trace(TRACE_JSONL);
    sim_advance(sim, 100500);
    json_t *list = lines();
    ck_assert_uint_eq(json_array_size(list), 2);
    json_t *begin = json_array_get(list, 0), *unit = json_array_get(json_object_get(begin, "units"), 0);
    ck_assert_int_eq(json_integer_value(json_object_get(begin, "t_us")), 100000);
    is(json_array_get(json_object_get(unit, "motors"), 1),
       "{\"motor\":2,\"position\":9,\"direction\":1,\"motion\":1,\"command\":6,\"led\":\"on\",\"fault\":\"none\"}");
    json_object_del(unit, "motors");
    is(unit, "{\"unit\":\"1\",\"power\":1,\"inputs\":66,\"outputs\":4,\"variables\":1024}");
    is(json_array_get(list, 1), "{\"t_us\":100500,\"kind\":\"end\"}");
    json_decref(list);
}
END_TEST

START_TEST(every_event_of_a_unit_is_a_line)
{
    happens(0, WATCH_DELIVERED, 0, WATCH_INPUTS, 0x81);
    happens(1000, WATCH_TURNS, 1, WATCH_COMMAND, 700);
    happens(1000, WATCH_TURNS, 1, WATCH_DIRECTION, 0);
    happens(1000, WATCH_TURNS, 1, WATCH_MOTION, 1);
    happens(1000, WATCH_TURNS, 1, WATCH_LED, RKM04_LED_ON);
    happens(1020, WATCH_PULSES, 4, WATCH_STEP, INT32_MIN);
    happens(2000, WATCH_TURNS, 2, WATCH_FAULT, RKM04_FAULT_NO_LABEL);
    happens(2000, WATCH_TURNS, 0, WATCH_OUTPUTS, 255);
    happens(2000, WATCH_TURNS, 0, WATCH_VARIABLES, 65535);
    happens(3000, WATCH_DELIVERED, 0, WATCH_POWER, 0);
    const char *wanted = "\n{\"t_us\":0,\"kind\":\"inputs\",\"unit\":\"1\",\"value\":129}\n"
                         "{\"t_us\":1000,\"kind\":\"command\",\"unit\":\"1\",\"motor\":1,\"value\":700}\n"
                         "{\"t_us\":1000,\"kind\":\"direction\",\"unit\":\"1\",\"motor\":1,\"value\":0}\n"
                         "{\"t_us\":1000,\"kind\":\"motion\",\"unit\":\"1\",\"motor\":1,\"value\":1}\n"
                         "{\"t_us\":1000,\"kind\":\"led\",\"unit\":\"1\",\"motor\":1,\"value\":\"on\"}\n"
                         "{\"t_us\":1020,\"kind\":\"step\",\"unit\":\"1\",\"motor\":4,\"value\":-2147483648}\n"
                         "{\"t_us\":2000,\"kind\":\"fault\",\"unit\":\"1\",\"motor\":2,\"value\":\"no_label\"}\n"
                         "{\"t_us\":2000,\"kind\":\"outputs\",\"unit\":\"1\",\"value\":255}\n"
                         "{\"t_us\":2000,\"kind\":\"variables\",\"unit\":\"1\",\"value\":65535}\n"
                         "{\"t_us\":3000,\"kind\":\"power\",\"unit\":\"1\",\"value\":0}\n"
                         "{\"t_us\":0,\"kind\":\"end\"}\n";
    ck_assert_str_eq(strchr(trace_rig_text(), '\n'), wanted);
}
END_TEST

START_TEST(what_passes_on_the_wires_is_in_the_trace)
{
    static const uint8_t request[] = {0x7E, 0x01, 0x00, 0x04, 0x31, 0x0F, 0xA7, 0x7E};
    struct sim *sim = trace_rig_sim();
    sim_advance(sim, 700);
    sim_queue_bytes(sim, request, sizeof request, 700);
    sim_advance(sim, 2000);
    json_t *list = lines();
    is(first_of(list, "byte"), "{\"t_us\":700,\"kind\":\"byte\",\"value\":126,\"from\":[\"master\"],\"lost\":false}");
    json_t *message = first_of(list, "message");
    ck_assert_str_eq(json_string_value(json_object_get(message, "bytes")), "7E010004310FA77E");
    ck_assert_str_eq(json_string_value(json_object_get(message, "message")), "0431");
    ck_assert_int_eq(json_integer_value(json_object_get(message, "value")), 4);
    ck_assert(json_is_false(json_object_get(message, "answer")));
    ck_assert(json_is_null(json_object_get(message, "dropped")));
    json_decref(list);
}
END_TEST

START_TEST(a_text_is_quoted)
{
    struct sim *sim = trace_rig_sim();
    const struct watch_event plant = {.tick = 5, .value = PLANT_JAM, .kind = WATCH_PLANT, .unit = 1, .motor = 3};
    const struct watch_event injected = {.tick = 6, .value = 17, .kind = WATCH_INJECTED};
    sim_report_text(sim, WATCH_PULSES, &plant, "a \"jam\"\\\n\x01%s", "\xC3\xA9");
    sim_report_text(sim, WATCH_DELIVERED, &injected, "%s", "");
    sim_advance(sim, 10);
    json_t *list = lines();
    json_t *line = first_of(list, "plant");
    ck_assert_str_eq(json_string_value(json_object_get(line, "text")), "a \"jam\"\\\n\x01\xC3\xA9");
    ck_assert_str_eq(json_string_value(json_object_get(line, "value")), "jam");
    is(first_of(list, "injected"), "{\"t_us\":6,\"kind\":\"injected\",\"value\":17,\"text\":\"\"}");
    json_decref(list);
}
END_TEST

START_TEST(a_line_may_be_longer_than_the_buffer)
{
    const size_t length = 300000;
    const struct watch_event event = {.tick = 5, .value = 1, .kind = WATCH_INJECTED};
    char *text = malloc(length + 1);
    memset(text, '\x02', length);
    text[length] = '\0';
    happens(4, WATCH_TURNS, 1, WATCH_COMMAND, 1);
    sim_report_text(trace_rig_sim(), WATCH_DELIVERED, &event, "%s", text);
    happens(6, WATCH_TURNS, 1, WATCH_COMMAND, 2);
    sim_advance(trace_rig_sim(), 10);
    json_t *list = lines();
    ck_assert_uint_eq(json_array_size(list), 5);
    ck_assert_str_eq(json_string_value(json_object_get(first_of(list, "injected"), "text")), text);
    json_decref(list);
    free(text);
}
END_TEST

/* The longest there is of each kind, written into exactly the room that was asked for: the sanitizers see to it. */
START_TEST(no_event_needs_more_room_than_it_says)
{
    struct sim *sim = trace_rig_sim();
    trace_rig_end();
    trace_rig_begin("10,10,10,10,10,10,10,10,10,10,10,10,10,10,10,10", TRACE_JSONL);
    static uint8_t raw[WIRE_RAW_MAX], bytes[WIRE_ANSWER_MAX];
    memset(raw, 0xFF, sizeof raw);
    memset(bytes, 0xFF, sizeof bytes);
    struct wire_message message = {
        .start = INT64_MAX, .senders = UINT32_MAX, .dnode = 255, .snode = 255, .dropped = "\x01\x01", .refused = "\x01\x01",
        .raw_length = sizeof raw, .length = sizeof bytes, .raw = raw, .message = bytes};
    sim->watch.cells = calloc(1, sizeof *sim->watch.cells);
    memset(sim->watch.cells->name, 1, sizeof sim->watch.cells->name - 1);
    static const struct watch_service service = {.name = "\x01\x01", .act = WATCH_SERVICE_RECEIVED};
    for (unsigned kind = 0; kind < WATCH_KINDS; kind++) {
        struct watch_event event = {.tick = INT64_MAX, .value = INT32_MIN, .kind = (uint8_t)kind, .unit = 16, .motor = 4};
        if (kind == WATCH_BYTE)
            event.byte = (struct segment_byte){.senders = UINT32_MAX, .byte = 255, .lost = true};
        else if (kind == WATCH_MESSAGE)
            event.message = &message;
        else if (kind == WATCH_SERVICE)
            event.service = &service;
        else if (kind == WATCH_CELL)
            event.cell = INT64_MIN;
        else
            event.text = "\x01\x01\x01";
        size_t room = event_json_room(&event);
        char *text = malloc(room), *end = event_json(text, sim, &event);
        ck_assert_uint_le((size_t)(end - text), room);
        char *object = malloc(room + 3);
        object[0] = '{';
        memcpy(object + 1, text, (size_t)(end - text));
        memcpy(object + 1 + (end - text), "}", 2);
        json_t *json = json_loads(object, 0, NULL);
        ck_assert_msg(json != NULL, "kind %u: %s", kind, object);
        json_decref(json);
        free(object);
        free(text);
    }
}
END_TEST

static Suite *jsonl_suite(void)
{
    Suite *suite = suite_create("trace_jsonl");
    TCase *cases = tcase_create("lines");
    tcase_add_checked_fixture(cases, jsonl, trace_rig_end);
    tcase_add_test(cases, it_begins_with_what_there_is_and_ends_with_the_time);
    tcase_add_test(cases, every_event_of_a_unit_is_a_line);
    tcase_add_test(cases, what_passes_on_the_wires_is_in_the_trace);
    tcase_add_test(cases, a_text_is_quoted);
    tcase_add_test(cases, a_line_may_be_longer_than_the_buffer);
    tcase_add_test(cases, no_event_needs_more_room_than_it_says);
    suite_add_tcase(suite, cases);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(jsonl_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=lines ./test_trace_jsonl");
    return failed > 0;
}
