/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "fault_rig.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "record/record.h"

struct fault_rig rig;

static uint8_t last_answer[RKM04_MESSAGE_MAX];

static void keep(struct heard *heard, uint8_t byte, uint64_t tick)
{
    ck_assert_uint_lt(heard->count, RIG_BYTES);
    heard->byte[heard->count] = byte;
    heard->tick[heard->count++] = tick;
}

static void on_out(void *context, const uint8_t *bytes, size_t length)
{
    (void)context;
    for (size_t i = 0; i < length; i++)
        keep(&rig.host, bytes[i], sim_now(&rig.sim));
}

static void on_adapter(void *context, bool plugged)
{
    (void)context;
    ck_assert_uint_lt(rig.plugs, 64);
    rig.plug[rig.plugs].tick = sim_now(&rig.sim);
    rig.plug[rig.plugs++].plugged = plugged;
}

static void on_event(void *context, const struct watch_event *event)
{
    (void)context;
    if (event->kind == WATCH_BYTE) {
        keep(&rig.line, event->byte.byte, event->byte.tick);
        rig.lost += event->byte.lost;
        return;
    }
    ck_assert_uint_lt(rig.news, RIG_NEWS);
    rig.told[rig.news].tick = event->tick;
    rig.told[rig.news].unit = event->unit;
    snprintf(rig.told[rig.news++].text, sizeof rig.told[0].text, "%d %s", (int)event->value, event->text);
}

void rig_begin_with(bool timed, unsigned units, uint64_t seed, const struct rkm04_framing *framing)
{
    struct sim_config config = {
        .unit = rkm04_device_config(&(struct rkm04_config){.framing = framing}),
        .nodes = {.count = units},
        .timed = timed,
        .turnaround = timed ? SEGMENT_TURNAROUND : 0,
        .seed = seed,
        .out = on_out,
        .adapter = on_adapter,
    };
    for (unsigned at = 0; at < units; at++)
        config.nodes.node[at] = (uint8_t)(at + 1u);
    memset(&rig, 0, sizeof rig);
    ck_assert(sim_begin(&rig.sim, &config));
    ck_assert(snapshots_attach(&rig.sim));
    rig.watcher = (struct watcher){.kinds = WATCH_BIT(WATCH_INJECTED) | WATCH_BIT(WATCH_BYTE), .on_event = on_event};
    sim_watch(&rig.sim, &rig.watcher);
}

void rig_begin(bool timed, unsigned units)
{
    rig_begin_with(timed, units, 1, NULL);
}

void rig_end(void)
{
    sim_end(&rig.sim);
}

/* JSON in which ' stands for ". */
static json_t *read_json(const char *text)
{
    char json[400];
    json_error_t error;
    ck_assert_uint_lt(strlen(text), sizeof json);
    strcpy(json, text);
    for (char *at = json; (at = strchr(at, '\'')); *at = '"')
        continue;
    json_t *read = json_loads(json, 0, &error);
    ck_assert_msg(read, "%s: %s", json, error.text);
    return read;
}

json_t *run_command(const char *method, const char *params)
{
    struct refusal refusal = {0, ""};
    json_t *read = read_json(params), *result = sim_command(&rig.sim, method, read, &refusal);
    json_decref(read);
    ck_assert_msg(result, "%s %s: %s", method, params, refusal.text);
    return result;
}

const char *refused(const char *method, const char *params)
{
    struct refusal refusal = {0, ""};
    json_t *read = read_json(params), *result = sim_command(&rig.sim, method, read, &refusal);
    json_decref(read);
    ck_assert_msg(!result, "%s %s was obeyed", method, params);
    snprintf(rig.refusal, sizeof rig.refusal, "%d %s", refusal.code, refusal.text);
    return rig.refusal;
}

uint32_t inject(const char *format, ...)
{
    char params[400];
    va_list list;
    va_start(list, format);
    vsnprintf(params, sizeof params, format, list);
    va_end(list);
    json_t *result = run_command("fault.inject", params);
    uint32_t id = (uint32_t)json_integer_value(json_object_get(result, "id"));
    json_decref(result);
    ck_assert_uint_gt(id, 0);
    return id;
}

static const struct rkm04_framing *framing(void)
{
    return sim_device(&rig.sim)->framing(&rig.sim.config.unit)->link;
}

size_t ask(uint8_t dnode, const void *message, size_t length)
{
    const uint8_t *bytes = message;
    struct rkm04_sender sender = {0};
    uint8_t frame[1024];
    size_t n = framing()->begin(&sender, dnode, 0, length, false, frame);
    for (size_t i = 0; i < length; i++)
        n += framing()->put(&sender, bytes[i], frame + n);
    n += framing()->end(&sender, frame + n);
    sim_queue_bytes(&rig.sim, frame, n, sim_now(&rig.sim));
    return n;
}

size_t set(uint8_t dnode, const char *text)
{
    uint8_t message[300] = {2, '1'};
    ck_assert_uint_lt(strlen(text), sizeof message - 2);
    memcpy(message + 2, text, strlen(text));
    return ask(dnode, message, 2 + strlen(text));
}

void settle(void)
{
    sim_advance(&rig.sim, sim_now(&rig.sim));
    for (uint64_t due; (due = sim_due(&rig.sim)) != RKM04_NEVER;)
        sim_advance(&rig.sim, due);
}

void forget(void)
{
    rig.host.count = rig.line.count = rig.lost = rig.news = 0;
}

static unsigned answers(void)
{
    struct rkm04_receiver receiver = {0};
    uint8_t message[RKM04_MESSAGE_MAX];
    unsigned number = 0;
    for (size_t i = 0; i < rig.host.count; i++) {
        if (!framing()->receive(&receiver, rig.host.byte[i], rig.host.tick[i], message, sizeof message))
            continue;
        memcpy(last_answer, message, receiver.length);
        number++;
    }
    return number;
}

unsigned answers_to(uint8_t dnode, const void *message, size_t length)
{
    forget();
    ask(dnode, message, length);
    settle();
    return answers();
}

uint8_t answer_byte(size_t at)
{
    return last_answer[at];
}

void run(uint64_t ticks)
{
    sim_advance(&rig.sim, sim_now(&rig.sim) + ticks);
}

struct rkm04_counters counters(unsigned number)
{
    return rkm04_counters(rkm04_of(sim_core(&rig.sim, number)));
}
