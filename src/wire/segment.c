/* SPDX-License-Identifier: MIT */
#include "segment.h"

#include <stdlib.h>
#include <string.h>

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t parts_of(uint64_t tick)
{
    return tick < DEVICE_NEVER / WIRE_TICK ? tick * WIRE_TICK : DEVICE_NEVER - 1u;
}

/* The first tick at or after. */
static uint64_t tick_of(uint64_t parts)
{
    return parts == DEVICE_NEVER ? DEVICE_NEVER : parts / WIRE_TICK + (parts % WIRE_TICK != 0);
}

/* Do the ticks before `tick`. */
static void bring(struct segment *segment, uint64_t tick)
{
    if (tick <= segment->now)
        return;
    const struct device_kind *kind = segment->config.kind;
    segment->advancing = true;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        if (unit->powered)
            kind->advance(unit->unit, tick - unit->since - kind->now(unit->unit));
    }
    segment->advancing = false;
    segment->now = tick;
}

static void give_master(struct segment *segment, const uint8_t *bytes, size_t length)
{
    if (segment->config.out)
        segment->config.out(segment->config.context, bytes, length);
}

/* ---- What goes wrong ------------------------------------------------------------------------------------------------ */

static bool hears(const struct segment *segment, unsigned station, uint32_t senders)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    return !hooks || !hooks->hears || hooks->hears(segment->config.hooks_context, station, senders);
}

static bool echoes(const struct segment *segment, uint32_t senders, uint8_t byte)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (segment->config.echo)
        return true;
    return hooks && hooks->echoes && (senders & 1u) != 0 && hooks->echoes(segment->config.hooks_context, byte);
}

static void obeyed(struct segment *segment, const struct segment_unit *unit)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (hooks && hooks->obeyed)
        hooks->obeyed(segment->config.hooks_context, (unsigned)(unit - segment->unit) + 1u);
}

/* What passes on the line in the place of a byte: the first bytes of *more. */
static void change(struct segment *segment, unsigned station, uint8_t byte, struct segment_more *more)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    more->at = 0;
    more->count = 1;
    more->byte[0] = byte;
    if (hooks && hooks->send)
        more->count = (uint8_t)hooks->send(segment->config.hooks_context, station, byte, more->byte);
}

/* Has the unit an answer, now or later? */
static bool answers(const struct segment *segment, const struct segment_unit *unit)
{
    return unit->powered && segment->config.kind->has_answer(unit->unit);
}

/* Ticks until the unit can begin with its answer. */
static uint64_t wait_of(const struct segment *segment, const struct segment_unit *unit)
{
    return segment->config.kind->answer_wait(unit->unit);
}

/* How much later than now a unit begins with its answer; ticks. 0 in the middle of one. */
static uint64_t delay(struct segment *segment, struct segment_unit *unit)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (unit->begun)
        return 0;
    uint64_t wait = wait_of(segment, unit);
    if (wait > 0)
        return wait;
    unit->begun = true;
    return hooks && hooks->answer ? hooks->answer(segment->config.hooks_context, (unsigned)(unit - segment->unit) + 1u) : 0;
}

/* Fetch the next byte of a unit's answer. Returns false if there is none. */
static bool fetch(const struct segment *segment, struct segment_unit *unit, uint8_t *byte)
{
    const struct device_kind *kind = segment->config.kind;
    uint32_t answers = kind->counters(unit->unit).answers;
    bool fetched = kind->send(unit->unit, byte, 1) == 1;
    if (kind->counters(unit->unit).answers != answers)
        unit->begun = false; /* the next byte is another answer's (P10) */
    return fetched;
}

/* ---- Stations ------------------------------------------------------------------------------------------------------- */

static void tell_monitor(struct segment *segment, const struct segment_byte *byte)
{
    if (segment->config.monitor)
        segment->config.monitor(segment->config.context, byte);
}

static void give_unit(struct segment *segment, struct segment_unit *unit, uint8_t byte)
{
    const struct device_kind *kind = segment->config.kind;
    if (kind->receive(unit->unit, &byte, 1) == 0) {
        segment->overruns++;
        return;
    }
    struct device_counters counters = kind->counters(unit->unit);
    uint32_t frames = counters.requests + counters.others + counters.dropped;
    unit->in_frame = frames == unit->frames;
    unit->frames = frames;
    obeyed(segment, unit);
}

/* Take the first byte of the queue. */
static uint8_t take_first(struct segment *segment)
{
    uint8_t byte = segment->queue[segment->head].byte;
    segment->head = (segment->head + 1u) % SEGMENT_ROOM;
    segment->count--;
    return byte;
}

/* ---- Bytes that take time ------------------------------------------------------------------------------------------- */

static bool has_more(const struct segment *segment, unsigned station)
{
    return segment->more[station].at < segment->more[station].count;
}

/* When (parts) the next start bit of the master is due; DEVICE_NEVER: none. */
static uint64_t next_of_master(const struct segment *segment)
{
    if (has_more(segment, WIRE_MASTER))
        return segment->more_start;
    return segment->count > 0 ? segment->queue[segment->head].start : DEVICE_NEVER;
}

/* When (parts) the next start bit is due, and of which station; DEVICE_NEVER: none. */
static uint64_t next_start(const struct segment *segment, unsigned *station)
{
    uint64_t start = next_of_master(segment);
    *station = WIRE_MASTER;
    for (unsigned i = 0; i < segment->units; i++) {
        if (segment->unit[i].next < start) {
            start = segment->unit[i].next;
            *station = i + 1u;
        }
    }
    return start;
}

/* The master's bytes have to wait until `time`: those behind them, too, as far as there is no gap. */
static void push_queue(struct segment *segment, uint64_t time)
{
    for (size_t i = 0; i < segment->count; i++) {
        uint64_t *start = &segment->queue[(segment->head + i) % SEGMENT_ROOM].start;
        if (*start >= time)
            return;
        *start = time;
        time += WIRE_BYTE;
    }
    if (segment->master_free < time)
        segment->master_free = time;
}

static void send_more(struct segment *segment, unsigned station, uint64_t start)
{
    struct segment_more *more = &segment->more[station];
    if (has_more(segment, station))
        wire_send(&segment->wire, station, more->byte[more->at++], start);
}

static void start_of_master(struct segment *segment, uint64_t start)
{
    const struct segment_more *more = &segment->more[WIRE_MASTER];
    if (!has_more(segment, WIRE_MASTER)) {
        change(segment, WIRE_MASTER, take_first(segment), &segment->more[WIRE_MASTER]);
        push_queue(segment, start + WIRE_BYTE * (more->count > 0 ? more->count : 1u));
    }
    send_more(segment, WIRE_MASTER, start);
    segment->more_start = start + WIRE_BYTE;
}

static void start_of_unit(struct segment *segment, unsigned station, uint64_t start)
{
    struct segment_unit *unit = &segment->unit[station - 1u];
    uint8_t byte;
    if (!has_more(segment, station)) {
        uint64_t later = delay(segment, unit);
        if (later > 0) {
            unit->next = start + later * WIRE_TICK;
            return;
        }
        if (fetch(segment, unit, &byte))
            change(segment, station, byte, &segment->more[station]);
    }
    send_more(segment, station, start);
    unit->next = has_more(segment, station) || answers(segment, unit) ? start + WIRE_BYTE : DEVICE_NEVER;
    obeyed(segment, unit);
}

static void start_byte(struct segment *segment, unsigned station, uint64_t start)
{
    if (station == WIRE_MASTER)
        start_of_master(segment, start);
    else
        start_of_unit(segment, station, start);
}

static void end_byte(struct segment *segment, const struct wire_byte *heard)
{
    uint32_t senders = heard->senders & ((UINT32_C(1) << WIRE_STATIONS) - 1u);
    if (heard->ear == WIRE_MONITOR) {
        struct segment_byte byte = {
            .start = heard->start / WIRE_TICK,
            .tick = segment->now,
            .senders = senders,
            .byte = heard->byte,
            .lost = heard->lost,
        };
        if (!heard->lost && echoes(segment, senders, heard->byte) && hears(segment, WIRE_MASTER, senders))
            give_master(segment, &heard->byte, 1);
        tell_monitor(segment, &byte);
    } else if (!hears(segment, heard->ear, senders)) {
        return;
    } else if (heard->ear == WIRE_MASTER) {
        if (!segment->config.echo) /* with an echo it hears what the monitor hears */
            give_master(segment, &heard->byte, 1);
    } else {
        struct segment_unit *unit = &segment->unit[heard->ear - 1u];
        give_unit(segment, unit, heard->byte);
        if (unit->next == DEVICE_NEVER && answers(segment, unit))
            unit->next = heard->end + (segment->config.turnaround + wait_of(segment, unit)) * (uint64_t)WIRE_TICK;
    }
}

static void advance_timed(struct segment *segment, uint64_t until)
{
    for (;;) {
        unsigned station;
        uint64_t start = next_start(segment, &station), end = wire_due(&segment->wire), next = earlier(start, end);
        if (next > until)
            return;
        bring(segment, tick_of(next));
        struct wire_byte heard;
        if (end <= start) {
            if (wire_hear(&segment->wire, end, &heard))
                end_byte(segment, &heard);
        } else {
            start_byte(segment, station, start);
        }
    }
}

/* ---- Bytes that take no time ---------------------------------------------------------------------------------------- */

/* Let the byte of a station be heard by the units in `ears` (bit n: unit n), the monitor, and the master if it is a unit's. */
static void pass(struct segment *segment, unsigned station, uint32_t ears, uint8_t byte)
{
    uint32_t sender = UINT32_C(1) << station;
    segment->quiet_bytes++;
    if (!segment->disturbed && hears(segment, WIRE_MASTER, sender) &&
        (station != WIRE_MASTER || echoes(segment, sender, byte)))
        give_master(segment, &byte, 1);
    for (unsigned i = 0; i < segment->units && !segment->disturbed; i++)
        if (segment->unit[i].powered && (ears >> (i + 1u) & 1u) != 0 && hears(segment, i + 1u, sender))
            give_unit(segment, &segment->unit[i], byte);
    tell_monitor(segment, &(struct segment_byte){segment->now, segment->now, sender, byte, segment->disturbed});
}

static void pass_changed(struct segment *segment, unsigned station, uint32_t ears, uint8_t byte)
{
    struct segment_more changed;
    change(segment, station, byte, &changed);
    for (unsigned i = 0; i < changed.count; i++)
        pass(segment, station, ears, changed.byte[i]);
}

/* Units that take each other's answers for requests go on for ever, and without time there is no end to how many they are in a
 * second: drop what they have to say. */
static void cut_answers(struct segment *segment)
{
    uint8_t byte;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        unit->next = DEVICE_NEVER;
        while (answers(segment, unit)) {
            (void)fetch(segment, unit, &byte);
            obeyed(segment, unit);
        }
    }
    segment->cuts++;
    segment->cut_ticks += segment->now - segment->asked;
    segment->unasked = 0;
    segment->asked = segment->now;
}

/* Let a unit send its answer, and what it has to answer then (P10). */
static void pass_answer(struct segment *segment, unsigned station, uint32_t ears)
{
    struct segment_unit *unit = &segment->unit[station - 1u];
    uint8_t byte;
    while (answers(segment, unit)) {
        segment->unasked += !unit->begun;
        uint64_t later = delay(segment, unit);
        if (later > 0) {
            unit->next = parts_of(segment->now + later);
            return;
        }
        if (fetch(segment, unit, &byte))
            pass_changed(segment, station, ears, byte);
        obeyed(segment, unit);
    }
}

/* Let all who have an answer now send it. Units that take an answer for a request (L2 with the same address twice) go on in the
 * next tick, so that they cannot go on for ever in this one. */
static void pass_answers(struct segment *segment)
{
    uint32_t ears = 0;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        if (unit->next != DEVICE_NEVER && unit->next <= parts_of(segment->now))
            unit->next = DEVICE_NEVER; /* it has waited long enough */
        ears |= (uint32_t)(!answers(segment, unit) || unit->next != DEVICE_NEVER) << (i + 1u);
    }
    for (unsigned i = 0; i < segment->units; i++)
        if ((ears >> (i + 1u) & 1u) == 0)
            pass_answer(segment, i + 1u, ears);
    segment->again = DEVICE_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        const struct segment_unit *unit = &segment->unit[i];
        if (answers(segment, unit))
            segment->again = earlier(segment->again, unit->next == DEVICE_NEVER ? segment->now + 1u : tick_of(unit->next));
    }
}

static uint64_t untimed_due(const struct segment *segment)
{
    uint64_t byte = segment->count > 0 ? segment->queue[segment->head].start / WIRE_TICK : DEVICE_NEVER;
    return earlier(byte, segment->again);
}

static void advance_untimed(struct segment *segment, uint64_t tick)
{
    for (uint64_t due; (due = untimed_due(segment)) <= tick && due != DEVICE_NEVER;) {
        bring(segment, due);
        if (segment->again > segment->now) {
            segment->unasked = 0;
            segment->asked = segment->now;
            pass_changed(segment, WIRE_MASTER, UINT32_MAX, take_first(segment));
        }
        if (segment->unasked > SEGMENT_UNASKED_MAX)
            cut_answers(segment);
        pass_answers(segment);
    }
}

/* ---- Public --------------------------------------------------------------------------------------------------------- */

void segment_begin(struct segment *segment, const struct segment_config *config)
{
    segment->config = *config;
    if (!config->kind)
        segment->config.kind = &rkm04_device;
    segment->now = 0;
    segment->advancing = false;
    segment->units = 0;
    segment->quiet_bytes = segment->overruns = 0;
    segment->unasked = 0;
    segment->asked = segment->cuts = segment->cut_ticks = 0;
    segment->again = DEVICE_NEVER;
    segment->master_free = 0;
    segment->head = segment->count = 0;
    segment->disturbed = false;
    for (unsigned station = 0; station < WIRE_STATIONS; station++)
        segment->more[station] = (struct segment_more){0};
    wire_begin(&segment->wire);
}

void segment_end(struct segment *segment)
{
    for (unsigned i = 0; i < SEGMENT_UNITS; i++) {
        free(segment->unit[i].unit);
        segment->unit[i].unit = NULL;
    }
    segment->units = 0;
}

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
    wire_join(&segment->wire, number, parts_of(segment->now));
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
    wire_leave(&segment->wire, number, parts_of(segment->now));
    if (on)
        power_up(segment, number);
}

void segment_set_timed(struct segment *segment, bool timed)
{
    segment->config.timed = timed;
    wire_hold(&segment->wire, WIRE_NOISE, timed && segment->disturbed, parts_of(segment->now));
    wire_hold(&segment->wire, WIRE_MASTER, timed && segment->held, parts_of(segment->now));
    segment->master_free = parts_of(segment->now);
}

size_t segment_room(const struct segment *segment)
{
    return SEGMENT_ROOM - segment->count;
}

/* A byte sets out at its tick or when the one before has passed; within the tick in which that happens it follows without a gap,
 * so that no rounding adds up. */
void segment_take(struct segment *segment, const uint8_t *bytes, size_t length, uint64_t tick)
{
    if (!segment->config.timed || segment->master_free + WIRE_TICK <= parts_of(tick))
        segment->master_free = parts_of(tick);
    for (size_t i = 0; i < length; i++) {
        size_t at = (segment->head + segment->count++) % SEGMENT_ROOM;
        segment->queue[at].start = segment->master_free;
        segment->queue[at].byte = bytes[i];
        if (segment->config.timed)
            segment->master_free += WIRE_BYTE;
    }
}

size_t segment_purge(struct segment *segment)
{
    size_t count = segment->count;
    if (count > 0)
        segment->master_free = next_of_master(segment);
    segment->count = segment->more[WIRE_MASTER].count = 0;
    return count;
}

void segment_break(struct segment *segment, bool on)
{
    segment->held = on;
    if (segment->config.timed)
        wire_hold(&segment->wire, WIRE_MASTER, on, parts_of(segment->now));
}

void segment_disturb(struct segment *segment, bool on)
{
    segment->disturbed = on;
    if (segment->config.timed)
        wire_hold(&segment->wire, WIRE_NOISE, on, parts_of(segment->now));
}

uint64_t segment_now(const struct segment *segment)
{
    return segment->now;
}

void segment_advance(struct segment *segment, uint64_t tick)
{
    uint64_t goal = tick > segment->now ? tick : segment->now;
    if (segment->config.timed)
        advance_timed(segment, parts_of(goal));
    else
        advance_untimed(segment, goal);
    bring(segment, goal);
}

uint64_t segment_due(const struct segment *segment)
{
    if (!segment->config.timed)
        return untimed_due(segment);
    unsigned station;
    uint64_t start = next_start(segment, &station);
    return tick_of(earlier(wire_due(&segment->wire), start == DEVICE_NEVER ? DEVICE_NEVER : start + WIRE_BYTE));
}

static uint64_t next_of_units(const struct segment *segment, uint64_t (*next_of)(const struct device_unit *))
{
    uint64_t next = DEVICE_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        const struct segment_unit *unit = &segment->unit[i];
        uint64_t event = unit->powered ? next_of(unit->unit) : DEVICE_NEVER;
        if (event != DEVICE_NEVER)
            next = earlier(next, event + unit->since);
    }
    return next;
}

uint64_t segment_next_event(const struct segment *segment)
{
    return next_of_units(segment, segment->config.kind->next_event);
}

uint64_t segment_next_report(const struct segment *segment)
{
    return next_of_units(segment, segment->config.kind->next_report);
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
        .bytes = segment->wire.sent + segment->quiet_bytes,
        .collisions = segment->wire.collisions,
        .framing_errors = segment->wire.ear[WIRE_MONITOR].framing_errors,
        .overruns = segment->overruns,
        .cuts = segment->cuts,
        .cut_ticks = segment->cut_ticks,
    };
}
