/* SPDX-License-Identifier: MIT */
#include "segment.h"

/* The tick at which the silence is over that a unit waits for; DEVICE_NEVER: it waits for none. */
static uint64_t silence_end_of(const struct segment *segment, const struct segment_unit *unit)
{
    uint64_t us = unit->powered ? segment->config.kind->silence_end(unit->unit) : DEVICE_NEVER;
    return us == DEVICE_NEVER ? DEVICE_NEVER : us + unit->since;
}

uint64_t segment_silence_end(const struct segment *segment)
{
    uint64_t first = DEVICE_NEVER;
    if (!segment->config.kind->silence_end)
        return DEVICE_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        uint64_t end = silence_end_of(segment, &segment->unit[i]);
        first = end < first ? end : first;
    }
    return first;
}

void segment_note_frames(const struct segment *segment, struct segment_unit *unit)
{
    struct device_counters counters = segment->config.kind->counters(unit->unit);
    uint32_t frames = counters.requests + counters.others + counters.dropped;
    unit->in_frame = frames == unit->frames;
    unit->frames = frames;
}

/* When (parts) the answer to a request may begin that the silence has ended. */
static uint64_t answer_start(const struct segment *segment, const struct segment_unit *unit)
{
    uint64_t now = segment->now * WIRE_TICK, rest = unit->heard + segment->config.turnaround * (uint64_t)WIRE_TICK;
    return (rest > now ? rest : now) + segment->config.kind->answer_wait(unit->unit) * WIRE_TICK;
}

unsigned segment_pass_silence(struct segment *segment)
{
    const struct device_kind *kind = segment->config.kind;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        if (silence_end_of(segment, unit) > segment->now)
            continue;
        kind->receive(unit->unit, NULL, 0);
        segment_note_frames(segment, unit);
        if (segment->config.timed && unit->next == DEVICE_NEVER && kind->has_answer(unit->unit))
            unit->next = answer_start(segment, unit);
        return i + 1u;
    }
    return 0;
}
