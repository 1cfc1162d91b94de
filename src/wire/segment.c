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
static void advance_units(struct segment *segment, uint64_t tick)
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

static void deliver_to_host(struct segment *segment, const uint8_t *bytes, size_t length)
{
    if (segment->config.out)
        segment->config.out(segment->config.context, bytes, length);
}

/* ---- What goes wrong ------------------------------------------------------------------------------------------------ */

static bool is_receiving(const struct segment *segment, unsigned station, uint32_t senders)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    return !hooks || !hooks->is_receiving || hooks->is_receiving(segment->config.hooks_context, station, senders);
}

static bool has_echo(const struct segment *segment, uint32_t senders, uint8_t byte)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (segment->config.echo)
        return true;
    return hooks && hooks->has_echo && (senders & 1u) != 0 && hooks->has_echo(segment->config.hooks_context, byte);
}

static void report_processed(struct segment *segment, const struct segment_unit *unit)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (hooks && hooks->processed)
        hooks->processed(segment->config.hooks_context, (unsigned)(unit - segment->unit) + 1u);
}

/* What passes on the line in the place of a byte: the first bytes of *more. */
static void alter_byte(struct segment *segment, unsigned station, uint8_t byte, struct segment_more *more)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    more->at = 0;
    more->count = 1;
    more->byte[0] = byte;
    if (hooks && hooks->send)
        more->count = (uint8_t)hooks->send(segment->config.hooks_context, station, byte, more->byte);
}

/* Has the unit an answer, now or later? */
static bool has_answer(const struct segment *segment, const struct segment_unit *unit)
{
    return unit->powered && segment->config.kind->receive && segment->config.kind->has_answer(unit->unit);
}

/* Ticks until the unit can begin with its answer. */
static uint64_t answer_wait(const struct segment *segment, const struct segment_unit *unit)
{
    return segment->config.kind->answer_wait(unit->unit);
}

/* How much later than now a unit begins with its answer; ticks. 0 in the middle of one. */
static uint64_t answer_delay(struct segment *segment, struct segment_unit *unit)
{
    const struct segment_hooks *hooks = segment->config.hooks;
    if (unit->begun)
        return 0;
    uint64_t wait = answer_wait(segment, unit);
    if (wait > 0)
        return wait;
    unit->begun = true;
    return hooks && hooks->answer ? hooks->answer(segment->config.hooks_context, (unsigned)(unit - segment->unit) + 1u) : 0;
}

/* Fetch the next byte of a unit's answer. Returns false if there is none. */
static bool fetch_byte(const struct segment *segment, struct segment_unit *unit, uint8_t *byte)
{
    const struct device_kind *kind = segment->config.kind;
    uint32_t answers = kind->counters(unit->unit).answers;
    bool fetched = kind->send(unit->unit, byte, 1) == 1;
    if (kind->counters(unit->unit).answers != answers)
        unit->begun = false; /* the next byte is another answer's (P10) */
    return fetched;
}

/* ---- Stations ------------------------------------------------------------------------------------------------------- */

static void report_to_monitor(struct segment *segment, const struct segment_byte *byte)
{
    if (segment->config.monitor)
        segment->config.monitor(segment->config.context, byte);
}

static void deliver_to_unit(struct segment *segment, struct segment_unit *unit, uint8_t byte)
{
    const struct device_kind *kind = segment->config.kind;
    if (!kind->receive)
        return;
    if (kind->receive(unit->unit, &byte, 1) == 0) {
        segment->overruns++;
        return;
    }
    segment_note_frames(segment, unit);
    report_processed(segment, unit);
}

/* Take the first byte of the queue. */
static uint8_t pop_queue(struct segment *segment)
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

/* Does a station send on the wires on which the host alone listens? */
static bool is_on_back(const struct segment *segment, unsigned station)
{
    return segment->config.is_full_duplex && station != WIRE_HOST;
}

/* When (parts) the next byte will have been received; DEVICE_NEVER: none is under way. */
static uint64_t wires_due(const struct segment *segment)
{
    const uint64_t due = wire_due(&segment->wire);
    return segment->config.is_full_duplex ? earlier(due, wire_due(&segment->back)) : due;
}

static bool receive_byte(struct segment *segment, uint64_t until, struct wire_byte *received)
{
    return wire_receive(&segment->wire, until, received) ||
           (segment->config.is_full_duplex && wire_receive(&segment->back, until, received));
}

/* When (parts) the next start bit of the host is due; DEVICE_NEVER: none. */
static uint64_t next_host_time(const struct segment *segment)
{
    if (has_more(segment, WIRE_HOST))
        return segment->more_start;
    return segment->count > 0 ? segment->queue[segment->head].start : DEVICE_NEVER;
}

/* When (parts) the next start bit is due, and of which station; DEVICE_NEVER: none. */
static uint64_t next_start(const struct segment *segment, unsigned *station)
{
    uint64_t start = next_host_time(segment);
    *station = WIRE_HOST;
    for (unsigned i = 0; i < segment->units; i++) {
        if (segment->unit[i].next < start) {
            start = segment->unit[i].next;
            *station = i + 1u;
        }
    }
    return start;
}

/* The host's bytes have to wait until `time`: those after them, too, as far as there is no gap. */
static void push_queue(struct segment *segment, uint64_t time)
{
    for (size_t i = 0; i < segment->count; i++) {
        uint64_t *start = &segment->queue[(segment->head + i) % SEGMENT_ROOM].start;
        if (*start >= time)
            return;
        *start = time;
        time += wire_byte_parts(&segment->wire);
    }
    if (segment->host_free < time)
        segment->host_free = time;
}

static void send_more(struct segment *segment, unsigned station, uint64_t start)
{
    struct segment_more *more = &segment->more[station];
    if (has_more(segment, station))
        wire_send(is_on_back(segment, station) ? &segment->back : &segment->wire, station, more->byte[more->at++], start);
}

static void host_start(struct segment *segment, uint64_t start)
{
    const struct segment_more *more = &segment->more[WIRE_HOST];
    if (!has_more(segment, WIRE_HOST)) {
        alter_byte(segment, WIRE_HOST, pop_queue(segment), &segment->more[WIRE_HOST]);
        push_queue(segment, start + wire_byte_parts(&segment->wire) * (more->count > 0 ? more->count : 1u));
    }
    send_more(segment, WIRE_HOST, start);
    segment->more_start = start + wire_byte_parts(&segment->wire);
}

static void unit_start(struct segment *segment, unsigned station, uint64_t start)
{
    struct segment_unit *unit = &segment->unit[station - 1u];
    uint8_t byte;
    if (!has_more(segment, station)) {
        uint64_t later = answer_delay(segment, unit);
        if (later > 0) {
            unit->next = start + later * WIRE_TICK;
            return;
        }
        if (fetch_byte(segment, unit, &byte))
            alter_byte(segment, station, byte, &segment->more[station]);
    }
    send_more(segment, station, start);
    unit->next = has_more(segment, station) || has_answer(segment, unit) ? start + wire_byte_parts(&segment->wire) : DEVICE_NEVER;
    report_processed(segment, unit);
}

static void start_byte(struct segment *segment, unsigned station, uint64_t start)
{
    if (station == WIRE_HOST)
        host_start(segment, start);
    else
        unit_start(segment, station, start);
}

static void end_byte(struct segment *segment, const struct wire_byte *received)
{
    uint32_t senders = received->senders & ((UINT32_C(1) << WIRE_STATIONS) - 1u);
    if (received->receiver == WIRE_MONITOR) {
        struct segment_byte byte = {
            .start = received->start / WIRE_TICK,
            .tick = segment->now,
            .senders = senders,
            .byte = received->byte,
            .lost = received->lost,
        };
        if (!received->lost && has_echo(segment, senders, received->byte) && is_receiving(segment, WIRE_HOST, senders))
            deliver_to_host(segment, &received->byte, 1);
        report_to_monitor(segment, &byte);
    } else if (!is_receiving(segment, received->receiver, senders)) {
        return;
    } else if (received->receiver == WIRE_HOST) {
        if (!segment->config.echo) /* with an echo it receives what the monitor receives */
            deliver_to_host(segment, &received->byte, 1);
    } else {
        struct segment_unit *unit = &segment->unit[received->receiver - 1u];
        deliver_to_unit(segment, unit, received->byte);
        unit->heard = received->end;
        if (unit->next == DEVICE_NEVER && has_answer(segment, unit))
            unit->next = received->end + (segment->config.turnaround + answer_wait(segment, unit)) * (uint64_t)WIRE_TICK;
    }
}

/* Tell the units of the bytes that have come to them since without a stop bit. */
static void report_lost_bytes(struct segment *segment)
{
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        const uint64_t lost = segment->wire.receiver[i + 1u].framing_errors;
        if (unit->lost != lost && unit->powered && is_receiving(segment, i + 1u, UINT32_C(1) << WIRE_HOST))
            segment->config.kind->lose_byte(unit->unit);
        unit->lost = lost;
    }
}

/* Do what the silence leads to that is over before anything else happens, at `tick` at the latest. Returns false if none is. */
static bool end_silence(struct segment *segment, uint64_t tick)
{
    if (!segment->config.kind->silence_end)
        return false;
    uint64_t silence = segment_silence_end(segment);
    if (silence == DEVICE_NEVER || silence > tick)
        return false;
    advance_units(segment, silence);
    for (unsigned number; (number = segment_pass_silence(segment)) > 0;)
        report_processed(segment, &segment->unit[number - 1u]);
    return true;
}

/* Advance to `until` (parts). is_plain is known to the compiler: most kinds of devices pay nothing for what others need. */
static inline __attribute__((always_inline)) void advance_wires(struct segment *segment, uint64_t until, bool is_plain)
{
    for (;;) {
        unsigned station;
        uint64_t start = next_start(segment, &station), end = is_plain ? wire_due(&segment->wire) : wires_due(segment);
        uint64_t next = earlier(start, end);
        if (end_silence(segment, earlier(tick_of(next), until / WIRE_TICK)))
            continue;
        if (next > until)
            return;
        advance_units(segment, tick_of(next));
        struct wire_byte received;
        if (end <= start) {
            const bool is_byte =
                is_plain ? wire_receive(&segment->wire, end, &received) : receive_byte(segment, end, &received);
            if (!is_plain && segment->config.kind->lose_byte)
                report_lost_bytes(segment);
            if (is_byte)
                end_byte(segment, &received);
        } else {
            start_byte(segment, station, start);
        }
    }
}

static void advance_timed(struct segment *segment, uint64_t until)
{
    if (segment->is_plain)
        advance_wires(segment, until, true);
    else
        advance_wires(segment, until, false);
}

/* ---- Bytes that take no time ---------------------------------------------------------------------------------------- */

/* The line is disturbed: the byte has no stop bit. */
static void lose_at_units(struct segment *segment, uint32_t receivers, uint32_t sender)
{
    for (unsigned i = 0; i < segment->units && segment->config.kind->lose_byte; i++)
        if (segment->unit[i].powered && (receivers >> (i + 1u) & 1u) != 0 && is_receiving(segment, i + 1u, sender))
            segment->config.kind->lose_byte(segment->unit[i].unit);
}

/* Let the byte of a unit be received by the units in `receivers` (bit n: unit n), the monitor, and the host if it is a
 * unit's. */
static void pass_byte(struct segment *segment, unsigned station, uint32_t receivers, uint8_t byte)
{
    uint32_t sender = UINT32_C(1) << station;
    segment->quiet_bytes++;
    if (!segment->disturbed && is_receiving(segment, WIRE_HOST, sender) &&
        (station != WIRE_HOST || has_echo(segment, sender, byte)))
        deliver_to_host(segment, &byte, 1);
    for (unsigned i = 0; i < segment->units && !segment->disturbed; i++)
        if (segment->unit[i].powered && (receivers >> (i + 1u) & 1u) != 0 && is_receiving(segment, i + 1u, sender))
            deliver_to_unit(segment, &segment->unit[i], byte);
    if (segment->disturbed)
        lose_at_units(segment, receivers, sender);
    report_to_monitor(segment, &(struct segment_byte){segment->now, segment->now, sender, byte, segment->disturbed});
}

static void pass_altered(struct segment *segment, unsigned station, uint32_t receivers, uint8_t byte)
{
    struct segment_more changed;
    alter_byte(segment, station, byte, &changed);
    for (unsigned i = 0; i < changed.count; i++)
        pass_byte(segment, station, receivers, changed.byte[i]);
}

/* Units that take each other's answers for requests continue without end, and without time there is no end to how many they are
 * in a second: drop what they have to say. */
static void cut_answers(struct segment *segment)
{
    uint8_t byte;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        unit->next = DEVICE_NEVER;
        while (has_answer(segment, unit)) {
            (void)fetch_byte(segment, unit, &byte);
            report_processed(segment, unit);
        }
    }
    segment->cuts++;
    segment->cut_ticks += segment->now - segment->asked;
    segment->unasked = 0;
    segment->asked = segment->now;
}

/* Let a unit send its answer, and what it has to answer then (P10). */
static void pass_answer(struct segment *segment, unsigned station, uint32_t receivers)
{
    struct segment_unit *unit = &segment->unit[station - 1u];
    uint8_t byte;
    while (has_answer(segment, unit)) {
        segment->unasked += !unit->begun;
        uint64_t later = answer_delay(segment, unit);
        if (later > 0) {
            unit->next = parts_of(segment->now + later);
            return;
        }
        if (fetch_byte(segment, unit, &byte))
            pass_altered(segment, station, receivers, byte);
        report_processed(segment, unit);
    }
}

/* Let all who have an answer now send it. Units that take an answer for a request (L2 with the same address twice) continue in
 * the next tick, so that they cannot continue without end in this one. */
static void pass_answers(struct segment *segment)
{
    uint32_t receivers = 0;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        if (unit->next != DEVICE_NEVER && unit->next <= parts_of(segment->now))
            unit->next = DEVICE_NEVER; /* it has waited long enough */
        receivers |= (uint32_t)(!has_answer(segment, unit) || unit->next != DEVICE_NEVER) << (i + 1u);
    }
    for (unsigned i = 0; i < segment->units; i++)
        if ((receivers >> (i + 1u) & 1u) == 0)
            pass_answer(segment, i + 1u, segment->config.kind->deaf_to_answers ? 0 : receivers);
    segment->again = DEVICE_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        const struct segment_unit *unit = &segment->unit[i];
        if (has_answer(segment, unit))
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
    for (uint64_t due;;) {
        due = untimed_due(segment);
        if (end_silence(segment, earlier(due, tick))) {
            pass_answers(segment);
            continue;
        }
        if (due > tick || due == DEVICE_NEVER)
            return;
        advance_units(segment, due);
        if (segment->again > segment->now) {
            segment->unasked = 0;
            segment->asked = segment->now;
            pass_altered(segment, WIRE_HOST, UINT32_MAX, pop_queue(segment));
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
        segment->config.kind = device_kind_at(0);
    segment->now = 0;
    segment->advancing = false;
    segment->units = 0;
    segment->quiet_bytes = segment->overruns = 0;
    segment->unasked = 0;
    segment->asked = segment->cuts = segment->cut_ticks = 0;
    segment->again = DEVICE_NEVER;
    segment->host_free = 0;
    segment->head = segment->count = 0;
    segment->disturbed = false;
    for (unsigned station = 0; station < WIRE_STATIONS; station++)
        segment->more[station] = (struct segment_more){0};
    wire_begin(&segment->wire, config->baud > 0 ? config->baud : DEVICE_BAUD);
    segment->back = segment->wire;
    segment->is_plain = !config->is_full_duplex && !segment->config.kind->lose_byte;
    if (config->is_full_duplex)
        wire_leave(&segment->wire, WIRE_HOST, 0);
}

void segment_end(struct segment *segment)
{
    for (unsigned i = 0; i < SEGMENT_UNITS; i++) {
        free(segment->unit[i].unit);
        segment->unit[i].unit = NULL;
    }
    segment->units = 0;
}

/* Hold all wires at 0, or let them go. */
static void hold_all(struct segment *segment, bool on)
{
    wire_hold(&segment->wire, WIRE_NOISE, on, parts_of(segment->now));
    if (segment->config.is_full_duplex)
        wire_hold(&segment->back, WIRE_NOISE, on, parts_of(segment->now));
}

void segment_set_timed(struct segment *segment, bool timed)
{
    segment->config.timed = timed;
    hold_all(segment, timed && segment->disturbed);
    wire_hold(&segment->wire, WIRE_HOST, timed && segment->held, parts_of(segment->now));
    segment->host_free = parts_of(segment->now);
}

size_t segment_room(const struct segment *segment)
{
    return SEGMENT_ROOM - segment->count;
}

/* A byte sets out at its tick or when the one before has passed; within the tick in which that happens it follows without a gap,
 * so that no rounding adds up. */
void segment_queue_bytes(struct segment *segment, const uint8_t *bytes, size_t length, uint64_t tick)
{
    if (!segment->config.timed || segment->host_free + WIRE_TICK <= parts_of(tick))
        segment->host_free = parts_of(tick);
    for (size_t i = 0; i < length; i++) {
        size_t at = (segment->head + segment->count++) % SEGMENT_ROOM;
        segment->queue[at].start = segment->host_free;
        segment->queue[at].byte = bytes[i];
        if (segment->config.timed)
            segment->host_free += wire_byte_parts(&segment->wire);
    }
}

size_t segment_purge(struct segment *segment)
{
    size_t count = segment->count;
    if (count > 0)
        segment->host_free = next_host_time(segment);
    segment->count = segment->more[WIRE_HOST].count = 0;
    return count;
}

void segment_break(struct segment *segment, bool on)
{
    segment->held = on;
    if (segment->config.timed)
        wire_hold(&segment->wire, WIRE_HOST, on, parts_of(segment->now));
}

void segment_disturb(struct segment *segment, bool on)
{
    segment->disturbed = on;
    if (segment->config.timed)
        hold_all(segment, on);
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
    advance_units(segment, goal);
}

uint64_t segment_due(const struct segment *segment)
{
    const uint64_t silence = segment_silence_end(segment);
    if (!segment->config.timed)
        return earlier(untimed_due(segment), silence);
    unsigned station;
    uint64_t start = next_start(segment, &station);
    uint64_t sent = start == DEVICE_NEVER ? DEVICE_NEVER : start + wire_byte_parts(&segment->wire);
    return earlier(silence, tick_of(earlier(wires_due(segment), sent)));
}
