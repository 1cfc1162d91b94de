/* SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "record_line.h"
#include "replay_state.h"

#define SHOWN 24u /* bytes shown in a message */

/* ---- What goes out, kept until the recording comes to it ----------------------------------------------------------------- */

/* Make room for one more item after `count`, after what has been compared (`at`) is dropped. Returns NULL: out of memory. */
static void *room_for(void *list, size_t *at, size_t *count, size_t *room, size_t size)
{
    if (*at == *count)
        *at = *count = 0;
    if (*count < *room)
        return list;
    size_t more = 2 * *room + 64u;
    void *fresh = realloc(list, more * size);
    if (fresh)
        *room = more;
    return fresh;
}

static void on_byte(void *context, const struct tally_byte *byte)
{
    struct replay *replay = context;
    struct replay_outputs *out = &replay->outputs;
    struct tally_byte *bytes =
        room_for(out->bytes, &out->bytes_at, &out->bytes_count, &out->bytes_room, sizeof *bytes);
    out->bytes_out++;
    if (!bytes) {
        replay_no_memory(replay);
        return;
    }
    out->bytes = bytes;
    bytes[out->bytes_count++] = *byte;
}

static void keep_span(struct replay *replay, uint64_t tick, unsigned unit, unsigned motor)
{
    struct replay_outputs *out = &replay->outputs;
    struct replay_span *spans =
        room_for(out->spans, &out->spans_at, &out->spans_count, &out->spans_room, sizeof *spans);
    if (!spans) {
        replay_no_memory(replay);
        return;
    }
    out->spans = spans;
    spans[out->spans_count++] = (struct replay_span){tick, unit, motor, out->tally.stream[unit][motor]};
}

static void on_span(void *context, uint64_t tick)
{
    struct replay *replay = context;
    for (unsigned unit = 0; unit < TALLY_UNITS; unit++)
        for (unsigned motor = 0; motor < TALLY_MOTORS; motor++)
            if (replay->outputs.tally.stream[unit][motor].changed)
                keep_span(replay, tick, unit, motor);
}

void replay_begin_compare(struct replay *replay)
{
    static const struct tally_calls calls = {.byte = on_byte, .span = on_span};
    replay->outputs.have_begun = replay->outputs.are_compared = true;
    tally_begin(&replay->outputs.tally, replay->head.sim, &calls, replay);
}

void replay_end_compare(struct replay *replay)
{
    if (!replay->outputs.are_compared)
        return;
    replay->outputs.are_compared = false;
    tally_end(&replay->outputs.tally);
    replay->outputs.bytes_at = replay->outputs.bytes_count = replay->outputs.spans_at = replay->outputs.spans_count = 0;
}

void replay_outputs_free(struct replay *replay)
{
    replay_end_compare(replay);
    free(replay->outputs.bytes);
    free(replay->outputs.spans);
}

void replay_collect_before_tick(struct replay *replay)
{
    tally_finish_tick(&replay->outputs.tally);
}

void replay_collect_all(struct replay *replay)
{
    tally_finish(&replay->outputs.tally);
}

/* ---- Differences ---------------------------------------------------------------------------------------------------- */

bool replay_differs(struct replay *replay, const struct replay_difference *difference)
{
    struct replay_difference first = *difference;
    if (first.unit >= 1 && first.unit <= sim_units(replay->head.sim))
        memcpy(first.name, replay->head.sim->unit[first.unit - 1u].name, sizeof first.name);
    return replay_finish_different(&replay->result, &first, replay->head.emulator);
}

static void format_bytes(char *text, size_t size, const uint8_t *bytes, size_t length)
{
    size_t at = 0;
    for (size_t i = 0; i < length && i < SHOWN; i++)
        at += (size_t)snprintf(text + at, size - at, "%02x", bytes[i]);
    if (length > SHOWN)
        snprintf(text + at, size - at, "... (%zu bytes)", length);
}

/* The bytes that have come and were not compared, up to `until`. */
static void format_arrived(const struct replay *replay, char *text, size_t size, uint64_t until)
{
    const struct replay_outputs *out = &replay->outputs;
    uint8_t bytes[SHOWN];
    size_t count = 0;
    for (size_t i = out->bytes_at; i < out->bytes_count && out->bytes[i].tick <= until; i++, count++)
        if (count < SHOWN)
            bytes[count] = out->bytes[i].byte;
    snprintf(text, size, "nothing");
    if (count > 0)
        format_bytes(text, size, bytes, count);
}

static void format_stream(char *text, size_t size, const struct tally_stream *stream, const struct tally_stream *other)
{
    if (stream->steps != other->steps || stream->position != other->position)
        snprintf(text, size, "%" PRIu64 " pulses since the beginning, the last one to %" PRId32, stream->steps, stream->position);
    else if (stream->events != other->events)
        snprintf(text, size, "%" PRIu64 " events since the beginning", stream->events);
    else
        snprintf(text, size, "%" PRIu64 " events and pulses with the digest %016" PRIx64, stream->events, stream->digest);
}

/* Streams as recorded and as they came; NULL: nothing since the last digest. */
static bool streams_differ(struct replay *replay, uint64_t tick, unsigned unit, unsigned motor,
                           const struct tally_stream *recorded, const struct tally_stream *came)
{
    struct replay_difference difference = {
        .unit = unit,
        .motor = motor,
        .what = motor > 0 ? "motor" : unit > 0 ? "unit" : "the wires",
        .from = tick > 0 ? (tick - 1u) / RECORD_SPAN * RECORD_SPAN : 0,
        .until = tick % RECORD_SPAN == 0 && tick > 0 ? tick - 1u : tick,
        .recorded = "nothing",
        .came = "nothing",
    };
    if (recorded)
        format_stream(difference.recorded, sizeof difference.recorded, recorded, came ? came : &(struct tally_stream){0});
    if (came)
        format_stream(difference.came, sizeof difference.came, came, recorded ? recorded : &(struct tally_stream){0});
    return replay_differs(replay, &difference);
}

/* ---- Comparing ------------------------------------------------------------------------------------------------------ */

static bool report_extra_byte(struct replay *replay, uint64_t tick)
{
    const struct tally_byte *first = &replay->outputs.bytes[replay->outputs.bytes_at];
    struct replay_difference difference = {
        .what = "the host",
        .from = first->tick,
        .until = first->tick,
        .recorded = "nothing",
    };
    format_arrived(replay, difference.came, sizeof difference.came, tick);
    return replay_differs(replay, &difference);
}

bool replay_expect_nothing(struct replay *replay, uint64_t tick, size_t bytes)
{
    struct replay_outputs *out = &replay->outputs;
    if (replay->result.ended)
        return false;
    if (out->spans_at < out->spans_count && out->spans[out->spans_at].tick < tick) {
        const struct replay_span *span = &out->spans[out->spans_at];
        return streams_differ(replay, span->tick, span->unit, span->motor, NULL, &span->stream);
    }
    if (out->bytes_count - out->bytes_at > bytes && out->bytes[out->bytes_at + bytes].tick < tick) {
        out->bytes_at += bytes;
        return report_extra_byte(replay, tick);
    }
    return true;
}

bool replay_compare_bytes(struct replay *replay, uint64_t from, uint64_t until, const uint8_t *bytes, size_t length)
{
    struct replay_outputs *out = &replay->outputs;
    for (size_t i = 0; i < length; i++) {
        size_t at = out->bytes_at + i;
        bool same = at < out->bytes_count && out->bytes[at].byte == bytes[i] && out->bytes[at].tick <= until &&
                    (i > 0 || out->bytes[at].tick == from) && (i + 1u < length || out->bytes[at].tick == until);
        if (same)
            continue;
        struct replay_difference difference = {.what = "the host", .from = from, .until = until};
        bool late = at < out->bytes_count && out->bytes[at].byte == bytes[i];
        snprintf(difference.recorded, sizeof difference.recorded, "as byte %zu of ", i + 1u);
        size_t used = strlen(difference.recorded);
        format_bytes(difference.recorded + used, sizeof difference.recorded - used, bytes, length);
        if (late)
            snprintf(difference.came, sizeof difference.came, "it at tick %" PRIu64, out->bytes[at].tick);
        else
            format_arrived(replay, difference.came, sizeof difference.came, until);
        return replay_differs(replay, &difference);
    }
    out->bytes_at += length;
    return true;
}

static bool is_same(const struct tally_stream *a, const struct tally_stream *b)
{
    return a->digest == b->digest && a->events == b->events && a->steps == b->steps && a->position == b->position;
}

bool replay_compare_stream(struct replay *replay, const struct replay_span *recorded, bool partial)
{
    struct replay_outputs *out = &replay->outputs;
    struct tally_stream *present = &out->tally.stream[recorded->unit][recorded->motor];
    const struct replay_span *span = out->spans_at < out->spans_count ? &out->spans[out->spans_at] : NULL;
    if (partial && !span) {
        if (!is_same(present, &recorded->stream))
            return streams_differ(replay, recorded->tick, recorded->unit, recorded->motor, &recorded->stream, present);
        present->changed = false;
        return true;
    }
    bool other = !span || span->tick != recorded->tick || span->unit != recorded->unit || span->motor != recorded->motor;
    bool earlier = span && (span->tick < recorded->tick || (span->tick == recorded->tick &&
                   (span->unit < recorded->unit || (span->unit == recorded->unit && span->motor < recorded->motor))));
    if (other && earlier)
        return streams_differ(replay, span->tick, span->unit, span->motor, NULL, &span->stream);
    if (other)
        return streams_differ(replay, recorded->tick, recorded->unit, recorded->motor, &recorded->stream, NULL);
    if (!is_same(&span->stream, &recorded->stream))
        return streams_differ(replay, recorded->tick, recorded->unit, recorded->motor, &recorded->stream, &span->stream);
    out->spans_at++;
    return true;
}

bool replay_compare_rest(struct replay *replay)
{
    if (!replay_expect_nothing(replay, DEVICE_NEVER, 0))
        return false;
    for (unsigned unit = 0; unit < TALLY_UNITS; unit++)
        for (unsigned motor = 0; motor < TALLY_MOTORS; motor++)
            if (replay->outputs.tally.stream[unit][motor].changed)
                return streams_differ(replay, sim_now(replay->head.sim), unit, motor, NULL,
                                      &replay->outputs.tally.stream[unit][motor]);
    return true;
}
