/* SPDX-License-Identifier: MIT */
#include "tally.h"

#include <stdlib.h>

#include "record_line.h"

static uint64_t mix_hash(uint64_t x)
{
    x = (x ^ x >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    x = (x ^ x >> 27) * UINT64_C(0x94d049bb133111eb);
    return x ^ x >> 31;
}

/* Two numbers and a tick as one. Sums of these do not depend on the order within a tick. */
static uint64_t hash(uint64_t tick, uint64_t a, uint64_t b)
{
    return mix_hash(mix_hash(mix_hash(tick) + a) + b);
}

void tally_clear_changed(struct tally *tally)
{
    for (unsigned unit = 0; unit < TALLY_UNITS; unit++)
        for (unsigned motor = 0; motor < TALLY_MOTORS; motor++)
            tally->stream[unit][motor].changed = false;
    tally->changed = false;
}

static void close_span(struct tally *tally, uint64_t tick)
{
    if (tick < tally->span_end)
        return;
    if (tally->changed) {
        tally->calls->span(tally->context, tally->span_end);
        tally_clear_changed(tally);
    }
    tally->span_end = (tick / RECORD_SPAN + 1u) * RECORD_SPAN;
}

/* Everything up to and with `tick` is known. */
static void pass_time(struct tally *tally, uint64_t tick)
{
    while (tally->told < tally->count && tally->heard[tally->told].tick <= tick) {
        const struct tally_byte *byte = &tally->heard[tally->told++];
        close_span(tally, byte->tick);
        tally->calls->byte(tally->context, byte);
    }
    if (tally->told == tally->count)
        tally->told = tally->count = 0;
    close_span(tally, tick);
}

static uint64_t hash_service(const struct watch_service *service)
{
    uint64_t all = hash(service->length, service->act, 0);
    for (size_t i = 0; i < service->length; i++)
        all = mix_hash(all + service->bytes[i]);
    return all;
}

static void on_event(void *context, const struct watch_event *event)
{
    struct tally *tally = context;
    if (tally->count > 0 || event->tick >= tally->span_end)
        pass_time(tally, event->tick);
    struct tally_stream *stream = &tally->stream[event->unit][event->motor];
    uint64_t what = (uint64_t)event->kind << 32 | (uint32_t)event->value;
    uint64_t more = watch_ns(event) + ((uint64_t)event->number << 10);
    if (event->kind == WATCH_BYTE)
        more = event->byte.start << 20 ^ event->byte.senders << 1 ^ event->byte.lost;
    if (event->kind == WATCH_SERVICE)
        more = hash_service(event->service);
    stream->digest += hash(event->tick, what, more);
    stream->events++;
    stream->changed = tally->changed = true;
    if (event->kind == WATCH_STEP) {
        stream->steps++;
        stream->position = event->value;
    }
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

static bool make_room(struct tally *tally, size_t more)
{
    if (tally->room - tally->count >= more)
        return true;
    size_t room = 2 * tally->room + more;
    struct tally_byte *heard = realloc(tally->heard, room * sizeof *heard);
    if (!heard)
        return false;
    tally->heard = heard;
    tally->room = room;
    return true;
}

static void on_out(void *context, const uint8_t *bytes, size_t length)
{
    struct tally *tally = context;
    if (make_room(tally, length)) {
        for (size_t i = 0; i < length; i++)
            tally->heard[tally->count++] = (struct tally_byte){sim_now(tally->sim), bytes[i]};
    } else {
        tally->short_of_memory = true;
    }
    if (tally->config.out)
        tally->config.out(tally->config.context, bytes, length);
}

static void on_service_out(void *context, unsigned client, const uint8_t *bytes, size_t length)
{
    struct tally *tally = context;
    if (tally->config.service_out)
        tally->config.service_out(tally->config.context, client, bytes, length);
}

static void on_adapter(void *context, bool plugged)
{
    struct tally *tally = context;
    if (tally->config.adapter)
        tally->config.adapter(tally->config.context, plugged);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

void tally_begin(struct tally *tally, struct sim *sim, const struct tally_calls *calls, void *context)
{
    tally->sim = sim;
    tally->calls = calls;
    tally->context = context;
    tally->span_end = (sim_now(sim) / RECORD_SPAN + 1u) * RECORD_SPAN;
    tally->watcher.kinds = WATCH_ALL & ~WATCH_BIT(WATCH_MESSAGE); /* these follow from the bytes */
    tally->watcher.on_event = on_event;
    tally->watcher.context = tally;
    tally->config = sim->config;
    sim->config.out = on_out;
    sim->config.adapter = on_adapter;
    sim->config.service_out = on_service_out;
    sim->config.context = tally;
    sim_watch(sim, &tally->watcher);
}

void tally_finish_tick(struct tally *tally)
{
    pass_time(tally, sim_now(tally->sim));
}

void tally_finish(struct tally *tally)
{
    watch_deliver(&tally->sim->watch, sim_now(tally->sim) + 1u);
    tally_finish_tick(tally);
}

void tally_end(struct tally *tally)
{
    sim_unwatch(tally->sim, &tally->watcher);
    tally->sim->config.out = tally->config.out;
    tally->sim->config.adapter = tally->config.adapter;
    tally->sim->config.service_out = tally->config.service_out;
    tally->sim->config.context = tally->config.context;
    free(tally->heard);
}
