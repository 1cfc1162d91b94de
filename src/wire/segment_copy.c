/* SPDX-License-Identifier: MIT */
/* For snapshots: a segment like another one, and everything later. */
#include <stdlib.h>
#include <string.h>

#include "segment.h"

/* Memory for units like those of `from` where there is none. */
static bool make_units(struct segment *to, const struct segment *from)
{
    for (unsigned i = 0; i < from->units; i++) {
        if (!to->unit[i].unit)
            to->unit[i].unit = calloc(1, from->config.kind->size);
        if (!to->unit[i].unit)
            return false;
    }
    return true;
}

bool segment_copy(struct segment *to, const struct segment *from)
{
    struct segment_config config = to->config;
    struct segment_unit own[SEGMENT_UNITS];
    if (!make_units(to, from))
        return false;
    memcpy(own, to->unit, sizeof own);
    memcpy(to, from, sizeof *to);
    if (config.kind) {
        config.echo = from->config.echo;
        config.hooks = from->config.hooks;
        to->config = config;
    }
    for (unsigned i = 0; i < from->units; i++) {
        struct segment_unit *unit = &to->unit[i];
        unit->unit = own[i].unit;
        memcpy(unit->unit, from->unit[i].unit, from->config.kind->size);
        if (!config.kind)
            continue;
        unit->config = own[i].config;
        unit->config.node = from->unit[i].config.node;
        unit->port = own[i].port;
        unit->context = own[i].context;
        segment_port_changed(to, i + 1u);
    }
    return true;
}

/* A time later by `by`; DEVICE_NEVER stays. */
static void postpone(uint64_t *time, uint64_t by)
{
    if (*time != DEVICE_NEVER)
        *time += by;
}

void segment_shift(struct segment *segment, uint64_t ticks)
{
    uint64_t parts = ticks * WIRE_TICK;
    segment->now += ticks;
    segment->asked += ticks;
    postpone(&segment->again, ticks);
    segment->host_free += parts;
    segment->more_start += parts;
    for (size_t i = 0; i < segment->count; i++)
        segment->queue[(segment->head + i) % SEGMENT_ROOM].start += parts;
    for (unsigned i = 0; i < segment->units; i++) {
        segment->unit[i].since += ticks;
        segment->unit[i].heard += parts;
        postpone(&segment->unit[i].next, parts);
    }
    wire_shift(&segment->wire, parts);
    wire_shift(&segment->back, parts);
}
