/* SPDX-License-Identifier: MIT */
/* test_cnc872_cells.c: cells of a CNC872 through the seam: events of those that change. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "core/rig.h"
#include "fake_rig.h"
#include "record/record.h"
#include "trace/trace.h"

static struct fake_rig rig;

static void begin(void)
{
    fake_rig_begin_as(&rig, &cnc872_device, NULL, "1", true);
}

static void end(void)
{
    fake_rig_end(&rig);
}

/* Advance to the end of T number k. */
static void do_turns(uint64_t k)
{
    sim_advance(&rig.sim, k * 1000 + 1);
}

/* ---- Events of cells ------------------------------------------------------------------------------------------------ */

struct listener {
    struct watcher watcher;
    struct event_filter filter;
    FILE *stream;
    char *text;
    size_t length, seen;
};

static void on_cell(void *context, const struct watch_event *event)
{
    struct listener *listener = context;
    if (!event_filter_passes(&listener->filter, &rig.sim, &listener->watcher, event))
        return;
    fprintf(listener->stream, "%llu %s %s %lld\n", (unsigned long long)event->tick,
            watch_kind_name((enum watch_kind)event->kind),
            event->kind == WATCH_CELL ? rig.sim.watch.cells[event->number].name : "-",
            (long long)(event->kind == WATCH_CELL ? event->cell : event->value));
}

static json_t *subscribe(struct listener *listener, const char *params, struct refusal *refusal)
{
    json_t *json = json_loads(params, 0, NULL), *answer = NULL;
    ck_assert_msg(json != NULL, "%s", params);
    *listener = (struct listener){.watcher = {.on_event = on_cell, .context = listener}};
    listener->stream = open_memstream(&listener->text, &listener->length);
    if (event_filter_read(&listener->filter, &rig.sim, json, refusal))
        answer = event_watch(&rig.sim, &listener->watcher, &listener->filter, 1, json, refusal);
    json_decref(json);
    return answer;
}

static void end_listening(struct listener *listener)
{
    fclose(listener->stream);
    free(listener->text);
}

static void listen_to(struct listener *listener, const char *params, const char *answer)
{
    struct refusal refusal;
    json_t *json = subscribe(listener, params, &refusal);
    char *text = json_dumps(json, JSON_COMPACT);
    ck_assert_msg(json != NULL, "%s", refusal.text);
    ck_assert_str_eq(text, answer);
    free(text);
    json_decref(json);
}

static void expect_heard(struct listener *listener, const char *wanted)
{
    fflush(listener->stream);
    ck_assert_str_eq(listener->text + listener->seen, wanted);
    listener->seen = listener->length;
}

static void expect_no_subscription(const char *params, int code, const char *wanted)
{
    struct listener listener;
    struct refusal refusal;
    ck_assert_msg(subscribe(&listener, params, &refusal) == NULL, "%s", params);
    ck_assert_msg(refusal.code == code && strstr(refusal.text, wanted) != NULL, "%s: %s", params, refusal.text);
    end_listening(&listener);
}

static void run_block(uint64_t step)
{
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X0.01 F1000\"}");
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    for (uint64_t tick = step; tick < 40000; tick += step)
        sim_advance(&rig.sim, tick);
    sim_advance(&rig.sim, 40000);
}

START_TEST(NL2_events_of_cells_are_exact_to_the_T)
{
    static const char heard[] = "1000 cell PO_F 1\n1000 cell PO_OSXPI 1\n9000 cell PO_OSXPI 0\n9000 cell PO_POL 1\n"
                                "10000 cell PO_F 0\n";
    static const uint64_t steps[] = {40000, 1, 999, 1000, 1001, 7777};
    for (size_t i = 0; i < sizeof steps / sizeof steps[0]; i++) {
        struct listener listener;
        end();
        begin();
        listen_to(&listener, "{\"cells\": [\"PO_F\", \"PO_OSXPI\", \"PO_POL\"]}",
                  "{\"t_us\":0,\"subscription\":1,\"cells\":{\"PO_F\":0,\"PO_OSXPI\":0,\"PO_POL\":0}}");
        run_block(steps[i]);
        expect_heard(&listener, heard);
        sim_unwatch(&rig.sim, &listener.watcher);
        ck_assert_ptr_null(rig.sim.unit[0].port.slot); /* it costs nothing any more */
        end_listening(&listener);
    }
}
END_TEST

START_TEST(NL2_a_cell_that_is_set_has_its_event_in_the_next_T)
{
    struct listener listener;
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 5}}");
    listen_to(&listener, "{\"kinds\": [\"motion\"], \"cells\": [\"BZH09\", \"QWRD.REFPOINT_DIST\"]}",
              "{\"t_us\":0,\"subscription\":1,\"cells\":{\"BZH09\":5,\"QWRD.REFPOINT_DIST\":0}}");
    do_turns(3);
    expect_heard(&listener, "");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 6, \"REFPOINT_DIST[0]\": -9007199254740993}}");
    do_turns(4);
    expect_heard(&listener, "4000 cell BZH09 6\n4000 cell QWRD.REFPOINT_DIST -9007199254740993\n");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 7}}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 6}}");
    do_turns(5);
    expect_heard(&listener, "");
    fake_rig_do(&rig, "snapshot", "{\"name\": \"a\"}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"BZH09\": 9}}");
    do_turns(6);
    fake_rig_do(&rig, "restore", "{\"name\": \"a\"}");
    do_turns(7);
    expect_heard(&listener, "6000 cell BZH09 9\n6001 cell BZH09 6\n");
    sim_unwatch(&rig.sim, &listener.watcher);
    end_listening(&listener);
}
END_TEST

/* Each has its own cells; a place that gets free is used again, and events that lie there are gone with it. */
START_TEST(NL2_cells_have_a_limit_and_belong_to_their_watcher)
{
    struct listener listener[5];
    char many[1600] = "", params[1700], *at = many;
    struct refusal refusal;
    for (unsigned cell = 0; cell < 64; cell++)
        at += sprintf(at, "%s\"PLC_MEM_BACKUP[%u]\"", cell > 0 ? "," : "", cell);
    snprintf(params, sizeof params, "{\"cells\": [%s, \"PO_F\"]}", many);
    expect_no_subscription(params, REFUSED_PARAMS, "up to 64 cells");
    snprintf(params, sizeof params, "{\"cells\": [%s]}", many);
    for (unsigned i = 0; i < 4; i++)
        json_decref(subscribe(&listener[i], params, &refusal));
    expect_no_subscription("{\"cells\": [\"PO_F\"]}", REFUSED_STATE, "at most 256");
    sim_unwatch(&rig.sim, &listener[1].watcher);
    listen_to(&listener[4], "{\"cells\": [\"PO_F\"]}", "{\"t_us\":0,\"subscription\":1,\"cells\":{\"PO_F\":0}}");
    fake_rig_do(&rig, "cnc.set", "{\"cells\": {\"PLC_MEM_BACKUP[63]\": 1}}");
    do_turns(2);
    for (unsigned i = 0; i < 5; i++) {
        expect_heard(&listener[i], i == 1 || i == 4 ? "" : "1000 cell PLC_MEM_BACKUP[63] 1\n");
        if (i != 1)
            sim_unwatch(&rig.sim, &listener[i].watcher);
        end_listening(&listener[i]);
    }
}
END_TEST

START_TEST(NL2_wrong_subscriptions_are_refused)
{
    expect_no_subscription("{\"cells\": [\"PO_F\", \"PO_G\"]}", REFUSED_PARAMS, "`PO_G'");
    expect_no_subscription("{\"cells\": [\"rAxGParabAccel\"]}", REFUSED_PARAMS, "whole numbers");
    expect_no_subscription("{\"cells\": [\"CNST.1\"]}", REFUSED_PARAMS, "not a constant");
    expect_no_subscription("{\"cells\": []}", REFUSED_PARAMS, "expected a list");
    expect_no_subscription("{\"cells\": \"PO_F\"}", REFUSED_PARAMS, "expected a list");
    expect_no_subscription("{\"cells\": [1]}", REFUSED_PARAMS, "expected names");
    expect_no_subscription("{\"kinds\": [\"cell\"]}", REFUSED_PARAMS, "expected a list of cells");
    ck_assert_uint_eq(rig.sim.watch.cell_count, 0);
    end();
    fake_rig_begin_as(&rig, &rkm04_device, NULL, "1", true);
    expect_no_subscription("{\"cells\": [\"PO_F\"]}", REFUSED_PARAMS, "the device rkm04 has no cells");
}
END_TEST

/* The recording of a short story, with a listener or without; to be freed. */
static char *record_story(bool listens)
{
    struct listener listener;
    char *text;
    size_t length;
    end();
    begin();
    FILE *out = open_memstream(&text, &length);
    struct record *record = record_begin(&rig.sim, out);
    if (listens)
        listen_to(&listener, "{\"cells\": [\"SYST_TIME_INFO.TIME_HUND\"]}",
                  "{\"t_us\":0,\"subscription\":1,\"cells\":{\"SYST_TIME_INFO.TIME_HUND\":0}}");
    run_block(40000);
    sim_advance(&rig.sim, 30000000);
    ck_assert_int_eq(record_end(record), 0);
    fclose(out);
    if (listens) {
        fflush(listener.stream);
        ck_assert_ptr_nonnull(strstr(listener.text, "29990000 cell SYST_TIME_INFO.TIME_HUND 99\n"));
        sim_unwatch(&rig.sim, &listener.watcher);
        end_listening(&listener);
    }
    return text;
}

START_TEST(NL2_events_of_cells_leave_recordings_as_they_are)
{
    char *with = record_story(true), *without = record_story(false);
    ck_assert_str_eq(with, without);
    FILE *in = fmemopen(with, strlen(with), "r");
    struct replay *replay = replay_open("test.record", in);
    ck_assert_int_eq(replay_run(replay, NULL, NULL), REPLAY_SAME);
    replay_free(replay);
    fclose(in);
    free(with);
    free(without);
}
END_TEST

/* Texts stay to the end of the process: the last test of this one. */
START_TEST(NL4_so_many_texts_are_read_and_no_more)
{
    char params[80];
    for (unsigned text = 0; text < 4096; text++) {
        snprintf(params, sizeof params, "{\"text\": \"G1 X%u.5 F1000\"}", text);
        fake_rig_do(&rig, "cnc.load", params);
    }
    fake_rig_expect_refusal(&rig, "cnc.load", "{\"text\": \"G1 X1 F1000\"}", "4096 different texts have been read: start");
    fake_rig_do(&rig, "cnc.load", "{\"text\": \"G1 X7.5 F1000\"}"); /* it is there */
    fake_rig_do(&rig, "cnc.panel", "{\"start\": true}");
    sim_advance(&rig.sim, 1000000);
    fake_rig_expect_state(&rig, "motors.0.position", "7500");
}
END_TEST

static Suite *cnc872_cells_suite(void)
{
    Suite *suite = suite_create("cnc872_cells");
    TCase *tests = tcase_create("cells");
    tcase_add_checked_fixture(tests, begin, end);
    tcase_add_test(tests, NL2_events_of_cells_are_exact_to_the_T);
    tcase_add_test(tests, NL2_a_cell_that_is_set_has_its_event_in_the_next_T);
    tcase_add_test(tests, NL2_cells_have_a_limit_and_belong_to_their_watcher);
    tcase_add_test(tests, NL2_wrong_subscriptions_are_refused);
    tcase_add_test(tests, NL2_events_of_cells_leave_recordings_as_they_are);
    tcase_add_test(tests, NL4_so_many_texts_are_read_and_no_more);
    suite_add_tcase(suite, tests);
    return suite;
}

int main(void)
{
    return rig_run(cnc872_cells_suite(), "./test_cnc872_cells");
}
