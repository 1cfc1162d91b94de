/* SPDX-License-Identifier: MIT */
/* segment_look.c: what can be seen of a segment from outside. */
#include "segment.h"

static uint64_t next_unit_time(const struct segment *segment, uint64_t (*next_of)(const struct device_unit *))
{
    uint64_t next = DEVICE_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        const struct segment_unit *unit = &segment->unit[i];
        uint64_t event = unit->powered ? next_of(unit->unit) : DEVICE_NEVER;
        if (event != DEVICE_NEVER)
            next = event + unit->since < next ? event + unit->since : next;
    }
    return next;
}

uint64_t segment_next_event(const struct segment *segment)
{
    return next_unit_time(segment, segment->config.kind->next_event);
}

uint64_t segment_next_report(const struct segment *segment)
{
    return next_unit_time(segment, segment->config.kind->next_report);
}

bool segment_in_frame(const struct segment *segment)
{
    for (unsigned i = 0; i < segment->units; i++)
        if (segment->unit[i].in_frame)
            return true;
    return false;
}

bool segment_idle(const struct segment *segment)
{
    return segment_due(segment) == DEVICE_NEVER;
}

struct segment_counters segment_counters(const struct segment *segment)
{
    return (struct segment_counters){
        .bytes = segment->wire.sent + segment->back.sent + segment->quiet_bytes,
        .collisions = segment->wire.collisions + segment->back.collisions,
        .framing_errors =
            segment->wire.receiver[WIRE_MONITOR].framing_errors + segment->back.receiver[WIRE_MONITOR].framing_errors,
        .overruns = segment->overruns,
        .cuts = segment->cuts,
        .cut_ticks = segment->cut_ticks,
    };
}
