/* SPDX-License-Identifier: MIT */
/* The units of a segment: adding them, their power and address. */
#include <stdlib.h>

#include "segment.h"

static void power_up(struct segment *segment, unsigned number)
{
    struct segment_unit *unit = &segment->unit[number - 1u];
    segment->config.kind->begin(unit->unit, &unit->config, unit->port, unit->context);
    unit->since = segment->now;
    unit->powered = true;
    unit->in_frame = false;
    unit->frames = 0;
    unit->begun = false;
    unit->next = DEVICE_NEVER;
    unit->heard = 0;
    unit->lost = segment->wire.receiver[number].framing_errors;
    wire_join(&segment->wire, number, segment->now * WIRE_TICK);
}

unsigned segment_add_unit(struct segment *segment, const struct device_config *config, const struct device_port *port,
                          void *context)
{
    if (segment->units == SEGMENT_UNITS)
        return 0;
    struct segment_unit *unit = &segment->unit[segment->units];
    unit->unit = calloc(1, segment->config.kind->size);
    if (!unit->unit)
        return 0;
    unit->config = *config;
    unit->port = port;
    unit->context = context;
    power_up(segment, ++segment->units);
    return segment->units;
}

const struct device_kind *segment_kind(const struct segment *segment)
{
    return segment->config.kind;
}

struct device_unit *segment_unit(struct segment *segment, unsigned number)
{
    return segment->unit[number - 1u].unit;
}

void segment_port_changed(struct segment *segment, unsigned number)
{
    struct segment_unit *unit = &segment->unit[number - 1u];
    segment->config.kind->attach(unit->unit, &unit->config, unit->port, unit->context);
}

void segment_set_node(struct segment *segment, unsigned number, uint8_t node)
{
    segment->unit[number - 1u].config.node = node;
}

uint64_t segment_since(const struct segment *segment, unsigned number)
{
    return segment->unit[number - 1u].since;
}

void segment_power(struct segment *segment, unsigned number, bool on)
{
    struct segment_unit *unit = &segment->unit[number - 1u];
    unit->powered = unit->in_frame = false;
    unit->next = DEVICE_NEVER;
    segment->more[number].count = 0;
    wire_leave(&segment->wire, number, segment->now * WIRE_TICK);
    wire_leave(&segment->back, number, segment->now * WIRE_TICK);
    if (on)
        power_up(segment, number);
}
