/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "session_rig.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record/record.h"
#include "text/readings.h"
#include "wire/wire_monitor.h"

static const char axis[] =
    "motors:\n"
    "  1: {offset: 20, stops: {low: -5, high: 400}}\n"
    "  2:\n"
    "switches:\n"
    "  - {input: 1, motor: 1, at_most: 0, hysteresis: 3, bounce: 30ms}\n"
    "  - {input: 2, motor: 2, at_least: 50}\n";

/* Every reading otherwise. */
static const char others[] = "label=fault,fault-exit=new,hold-exit=latch,x-after=once,guard-start=step,v-alone=first,"
                             "y-eleventh=y,reset-t41=clear,negative-position=no,"
                             "speed-change=40,planning=3,input-filter=2,store-time=20";

const struct session_kind session_kinds[] = {
    {"1", true, false, NULL, NULL}, {"1", false, false, NULL, NULL}, {"1,2,7", true, false, NULL, NULL},
    {"3,3", true, false, NULL, NULL}, {"4", true, false, axis, NULL}, {"2", false, true, axis, NULL},
    {"6", true, false, axis, others},
};
const size_t session_kind_count = sizeof session_kinds / sizeof session_kinds[0];

/* ---- What is seen --------------------------------------------------------------------------------------------------- */

static void on_event(void *context, const struct watch_event *event)
{
    struct session *session = context;
    fprintf(session->stream, "%" PRIu64 " unit %u motor %u %s %" PRId32, event->tick - session->zero, event->unit, event->motor,
            watch_kind_name((enum watch_kind)event->kind), event->value);
    if (event->kind == WATCH_BYTE)
        fprintf(session->stream, " from %" PRIu64 " by %x%s", event->byte.start - session->zero, event->byte.senders,
                event->byte.lost ? " lost" : "");
    if (event->kind == WATCH_MESSAGE) {
        fprintf(session->stream, " from %" PRIu64 " by %x: %s ", event->message->start - session->zero, event->message->senders,
                event->message->dropped ? event->message->dropped : "whole");
        for (size_t i = 0; i < event->message->raw_length; i++)
            fprintf(session->stream, "%02x", event->message->raw[i]);
    }
    if (event->kind == WATCH_PLANT || event->kind == WATCH_INJECTED)
        fprintf(session->stream, " %s", event->text);
    putc('\n', session->stream);
}

static void hear(void *context, const uint8_t *bytes, size_t length)
{
    struct session *session = context;
    for (size_t i = 0; i < length; i++)
        fprintf(session->stream, "%" PRIu64 " heard %02x\n", sim_now(&session->sim) - session->zero, bytes[i]);
}

void session_forget(struct session *session)
{
    if (session->stream)
        fclose(session->stream);
    free(session->text);
    session->text = NULL;
    session->stream = open_memstream(&session->text, &session->length);
    ck_assert_ptr_nonnull(session->stream);
    session->zero = sim_now(&session->sim);
}

const char *session_seen(struct session *session)
{
    ck_assert_int_eq(fflush(session->stream), 0);
    return session->text;
}

/* Take out what has a time of its own. */
static void drop_times(json_t *value)
{
    static const char *const names[] = {"t_us", "since_us", "powered_us"};
    const char *key;
    json_t *inner;
    size_t i;
    for (i = 0; i < sizeof names / sizeof names[0]; i++)
        json_object_del(value, names[i]);
    json_object_foreach(value, key, inner)
        drop_times(inner);
    json_array_foreach(value, i, inner)
        drop_times(inner);
}

char *session_state(struct session *session)
{
    json_t *all = json_array();
    struct refusal refusal;
    for (unsigned number = 1; number <= sim_units(&session->sim); number++) {
        json_t *params = json_pack("{s:s}", "unit", session->sim.unit[number - 1u].name);
        json_t *state = sim_command(&session->sim, "state", params, &refusal);
        ck_assert_msg(state != NULL, "state: %s", refusal.text);
        json_decref(params);
        drop_times(state);
        json_array_append_new(all, state);
    }
    char *text = json_dumps(all, JSON_INDENT(1) | JSON_SORT_KEYS);
    json_decref(all);
    return text;
}

/* ---- What comes in -------------------------------------------------------------------------------------------------- */

uint64_t session_draw(struct session *session, uint64_t below)
{
    session->dice ^= session->dice << 13;
    session->dice ^= session->dice >> 7;
    session->dice ^= session->dice << 17;
    return (session->dice >> 11) % below;
}

const char *session_refusal(struct session *session, const char *method, const char *params)
{
    static char text[sizeof(((struct refusal *)0)->text)];
    struct refusal refusal;
    json_error_t error;
    json_t *json = json_loads(params, 0, &error);
    ck_assert_msg(json != NULL, "%s: %s", params, error.text);
    json_t *result = sim_command(&session->sim, method, json, &refusal);
    json_decref(json);
    text[0] = '\0';
    if (!result)
        snprintf(text, sizeof text, "%s", refusal.text);
    json_decref(result);
    return text;
}

void session_command(struct session *session, const char *method, const char *params)
{
    const char *refusal = session_refusal(session, method, params);
    ck_assert_msg(*refusal == '\0', "%s %s: %s", method, params, refusal);
}

static void take(struct session *session, const uint8_t *bytes, size_t length)
{
    if (length > sim_room(&session->sim))
        return;
    if (session->taken < sim_now(&session->sim))
        session->taken = sim_now(&session->sim);
    sim_queue_bytes(&session->sim, bytes, length, session->taken);
}

void session_ask(struct session *session, uint8_t node, const void *message, size_t length)
{
    const struct rkm04_framing *framing = sim_device(&session->sim)->framing(&session->sim.config.unit)->link;
    uint8_t frame[1024];
    struct rkm04_sender sender = {0};
    ck_assert_uint_lt(length, 400);
    size_t n = framing->begin(&sender, node, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        n += framing->put(&sender, ((const uint8_t *)message)[i], frame + n);
    n += framing->end(&sender, frame + n);
    take(session, frame, n);
}

void session_set(struct session *session, uint8_t node, char motor, const char *text)
{
    uint8_t message[400] = {2, (uint8_t)motor};
    size_t length = strlen(text);
    ck_assert_uint_lt(length, sizeof message - 2);
    memcpy(message + 2, text, length);
    session_ask(session, node, message, 2 + length);
}

static void act_program(struct session *session, uint8_t node)
{
    static const char *const texts[] = {
        "\\S50 V900 A3000 F90 R B40 R", "V3000 F300 R", "L5 T03 W2 C03 W3 E", "G-", "G+", "K", "C75", "V700", "[F10 R", "] D R",
        "M01 F200 R U", "(01 C100 F30 R", "T80 O81 F3 R", "T81 Z80 B3 R", "Y F20 Y B50 V400 Y R", "\\", "T41 F500 R",
        "@1 F2 R D J1",
        "I01H1 J2", "X02 G+", "F100 V100 R W5 H", ")02 =7 H",
    };
    char motor = (char)('0' + session_draw(session, 5));
    session_set(session, node, motor, texts[session_draw(session, sizeof texts / sizeof *texts)]);
}

static void act_fault(struct session *session)
{
    static const char *const faults[] = {
        "{\"kind\":\"drop\",\"probability\":0.02,\"for\":\"200ms\"}",
        "{\"kind\":\"flip\",\"mask\":4,\"probability\":0.05,\"count\":3}",
        "{\"kind\":\"duplicate\",\"count\":2}", "{\"kind\":\"delay\",\"delay\":\"7ms\",\"count\":1}",
        "{\"kind\":\"no_answer\",\"count\":1,\"after\":\"20ms\"}", "{\"kind\":\"cut\",\"bytes\":3,\"count\":1}",
        "{\"kind\":\"break\",\"duration\":\"3ms\",\"after\":\"5ms\"}", "{\"kind\":\"cable\",\"duration\":\"30ms\"}",
        "{\"kind\":\"echo\",\"for\":\"100ms\"}",
        "{\"kind\":\"input\",\"input\":2,\"level\":1,\"duration\":\"40ms\",\"every\":\"90ms\",\"count\":4}",
    };
    session_refusal(session, "fault.inject", faults[session_draw(session, sizeof faults / sizeof *faults)]);
}

static void act_command(struct session *session, unsigned number)
{
    char params[120];
    const char *name = session->sim.unit[number - 1u].name;
    switch (session_draw(session, 10)) {
    case 0:
        snprintf(params, sizeof params, "{\"unit\":\"%s\",\"on\":%s}", name, session_draw(session, 3) > 0 ? "true" : "false");
        session_command(session, "power", params);
        break;
    case 1:
    case 2:
    case 3:
    case 4:
        act_fault(session);
        break;
    case 5:
        session_refusal(session, "fault.clear", "{}");
        break;
    default:
        snprintf(params, sizeof params, "{\"unit\":\"%s\",\"mask\":%u}", name, (unsigned)session_draw(session, 256));
        session_command(session, "di.set", params);
        break;
    }
}

void session_act(struct session *session)
{
    unsigned number = 1u + (unsigned)session_draw(session, sim_units(&session->sim));
    uint8_t node = rkm04_of(sim_core(&session->sim, number))->config.node;
    uint8_t message[2] = {(uint8_t)(1 + session_draw(session, 8)), (uint8_t)('0' + session_draw(session, 5))};
    switch (session_draw(session, 8)) {
    case 0:
    case 1:
    case 2:
        act_program(session, session_draw(session, 8) > 0 ? node : 0);
        break;
    case 3:
    case 4:
        session_ask(session, node, message, 2);
        break;
    case 5:
        take(session, message, 2); /* noise */
        break;
    case 6:
        if (session_draw(session, 6) == 0)
            sim_purge(&session->sim);
        else if (session_draw(session, 3) == 0)
            sim_break(&session->sim, session_draw(session, 2) == 0);
        break;
    default:
        act_command(session, number);
        break;
    }
}

/* Acts come in pairs, one in the middle of the other, and some at one tick. */
static uint64_t time_of_act(uint64_t begin, unsigned acts, uint64_t ticks, unsigned i)
{
    uint64_t even = begin + ticks * (i - i % 2) / acts;
    return i % 2 == 0 ? even : i % 4 == 1 ? even + 3000 : even;
}

void session_live(struct session *session, unsigned acts, uint64_t ticks, uint64_t piece)
{
    uint64_t begin = sim_now(&session->sim);
    for (unsigned i = 0; i < acts; i++) {
        uint64_t end = time_of_act(begin, acts, ticks, i);
        while (piece > 0 && sim_now(&session->sim) + piece < end)
            sim_advance(&session->sim, sim_now(&session->sim) + 1u + sim_now(&session->sim) % piece);
        if (sim_now(&session->sim) < end)
            sim_advance(&session->sim, end);
        session_act(session);
    }
    uint64_t last = begin + ticks > sim_now(&session->sim) ? begin + ticks : sim_now(&session->sim);
    sim_advance(&session->sim, last);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

void session_begin(struct session *session, const struct session_kind *kind)
{
    struct rkm04_config settings = {.framing = kind->plain ? &rkm04_plain : &rkm04_hdlc};
    struct sim_config config = {
        .timed = kind->timed,
        .turnaround = kind->timed ? SEGMENT_TURNAROUND : 0,
        .seed = 1,
        .out = hear,
        .context = session,
    };
    char error[READINGS_ERROR_SIZE];
    readings_set named = 0;
    ck_assert(!kind->readings || readings_read(&settings.readings, &named, kind->readings, error));
    rkm04_settings_put(&config.unit, &settings);
    *session = (struct session){.dice = 88172645463325252u};
    ck_assert(node_list_read(&config.nodes, kind->nodes));
    ck_assert(sim_begin(&session->sim, &config));
    ck_assert(snapshots_attach(&session->sim));
    ck_assert(!kind->plant || sim_configure_plants(&session->sim, "plant", kind->plant, strlen(kind->plant), stderr));
    session_forget(session);
    session->watcher = (struct watcher){.kinds = WATCH_ALL, .on_event = on_event, .context = session};
    sim_watch(&session->sim, &session->watcher);
}

void session_end(struct session *session)
{
    sim_end(&session->sim);
    fclose(session->stream);
    free(session->text);
}

void session_same(const char *wanted, const char *got, const char *what)
{
    size_t at = 0;
    while (wanted[at] != '\0' && wanted[at] == got[at])
        at++;
    if (wanted[at] == got[at])
        return;
    while (at > 0 && wanted[at - 1u] != '\n')
        at--;
    ck_abort_msg("%s: wanted\n%.300s\ngot\n%.300s", what, wanted + at, got + at);
}
