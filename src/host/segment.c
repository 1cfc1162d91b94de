#include "segment.h"

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t parts_of(uint64_t tick)
{
    return tick < RKM04_NEVER / WIRE_TICK ? tick * WIRE_TICK : RKM04_NEVER - 1u;
}

/* The first tick at or after. */
static uint64_t tick_of(uint64_t parts)
{
    return parts == RKM04_NEVER ? RKM04_NEVER : parts / WIRE_TICK + (parts % WIRE_TICK != 0);
}

/* Do the ticks before `tick`. */
static void bring(struct segment *segment, uint64_t tick)
{
    if (tick <= segment->now)
        return;
    for (unsigned i = 0; i < segment->units; i++) {
        struct segment_unit *unit = &segment->unit[i];
        if (unit->powered)
            rkm04_advance(&unit->unit, tick - unit->since - rkm04_now(&unit->unit));
    }
    segment->now = tick;
}

static void give_master(struct segment *segment, const uint8_t *bytes, size_t length)
{
    if (segment->config.out)
        segment->config.out(segment->config.context, bytes, length);
}

static void tell_monitor(struct segment *segment, const struct segment_byte *byte)
{
    if (segment->config.monitor)
        segment->config.monitor(segment->config.context, byte);
}

static void give_unit(struct segment *segment, struct segment_unit *unit, uint8_t byte)
{
    if (rkm04_receive(&unit->unit, &byte, 1) == 0) {
        segment->overruns++;
        return;
    }
    struct rkm04_counters counters = rkm04_counters(&unit->unit);
    uint32_t frames = counters.requests + counters.others + counters.dropped;
    unit->in_frame = frames == unit->frames;
    unit->frames = frames;
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

/* When (parts) the next start bit is due, and of which station; RKM04_NEVER: none. */
static uint64_t next_start(const struct segment *segment, unsigned *station)
{
    uint64_t start = segment->count > 0 ? segment->queue[segment->head].start : RKM04_NEVER;
    *station = WIRE_MASTER;
    for (unsigned i = 0; i < segment->units; i++) {
        if (segment->unit[i].next < start) {
            start = segment->unit[i].next;
            *station = i + 1u;
        }
    }
    return start;
}

static void start_byte(struct segment *segment, unsigned station, uint64_t start)
{
    if (station == WIRE_MASTER) {
        wire_send(&segment->wire, station, take_first(segment), start);
        return;
    }
    struct segment_unit *unit = &segment->unit[station - 1u];
    uint8_t byte;
    if (rkm04_send(&unit->unit, &byte, 1) == 1)
        wire_send(&segment->wire, station, byte, start);
    unit->next = rkm04_sending(&unit->unit) ? start + WIRE_BYTE : RKM04_NEVER;
}

static void end_byte(struct segment *segment, const struct wire_byte *heard)
{
    if (heard->ear == WIRE_MONITOR) {
        struct segment_byte byte = {
            .start = heard->start / WIRE_TICK,
            .tick = segment->now,
            .senders = heard->senders,
            .byte = heard->byte,
            .lost = heard->lost,
        };
        if (segment->config.echo && !heard->lost)
            give_master(segment, &heard->byte, 1);
        tell_monitor(segment, &byte);
    } else if (heard->ear == WIRE_MASTER) {
        if (!segment->config.echo) /* with an echo it hears what the monitor hears */
            give_master(segment, &heard->byte, 1);
    } else {
        struct segment_unit *unit = &segment->unit[heard->ear - 1u];
        give_unit(segment, unit, heard->byte);
        if (unit->next == RKM04_NEVER && rkm04_sending(&unit->unit))
            unit->next = heard->end + segment->config.turnaround * (uint64_t)WIRE_TICK;
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

static bool answers(const struct segment_unit *unit)
{
    return unit->powered && rkm04_sending(&unit->unit);
}

/* Let the byte of a station be heard by the units in `ears` (bit n: unit n) and the monitor. */
static void pass(struct segment *segment, unsigned station, uint32_t ears, uint8_t byte)
{
    for (unsigned i = 0; i < segment->units; i++)
        if (segment->unit[i].powered && (ears >> (i + 1u) & 1u) != 0)
            give_unit(segment, &segment->unit[i], byte);
    segment->quiet_bytes++;
    tell_monitor(segment, &(struct segment_byte){segment->now, segment->now, UINT32_C(1) << station, byte, false});
}

/* Let all who have an answer now send it. Units that take an answer for a request (L2 with the same address twice) go on in the
 * next tick, so that they cannot go on for ever in this one. */
static void pass_answers(struct segment *segment)
{
    uint32_t ears = 0;
    uint8_t bytes[256];
    size_t length;
    for (unsigned i = 0; i < segment->units; i++)
        ears |= (uint32_t)!answers(&segment->unit[i]) << (i + 1u);
    for (unsigned i = 0; i < segment->units; i++) {
        if ((ears >> (i + 1u) & 1u) != 0)
            continue;
        while ((length = rkm04_send(&segment->unit[i].unit, bytes, sizeof bytes)) > 0) {
            give_master(segment, bytes, length);
            for (size_t at = 0; at < length; at++)
                pass(segment, i + 1u, ears, bytes[at]);
        }
    }
    segment->again = RKM04_NEVER;
    for (unsigned i = 0; i < segment->units; i++)
        if (answers(&segment->unit[i]))
            segment->again = segment->now + 1u;
}

static uint64_t untimed_due(const struct segment *segment)
{
    uint64_t byte = segment->count > 0 ? segment->queue[segment->head].start / WIRE_TICK : RKM04_NEVER;
    return earlier(byte, segment->again);
}

static void advance_untimed(struct segment *segment, uint64_t tick)
{
    for (uint64_t due; (due = untimed_due(segment)) <= tick && due != RKM04_NEVER;) {
        bring(segment, due);
        if (segment->again > segment->now) {
            uint8_t byte = take_first(segment);
            if (segment->config.echo)
                give_master(segment, &byte, 1);
            pass(segment, WIRE_MASTER, UINT32_MAX, byte);
        }
        pass_answers(segment);
    }
}

/* ---- Public --------------------------------------------------------------------------------------------------------- */

void segment_begin(struct segment *segment, const struct segment_config *config)
{
    segment->config = *config;
    segment->now = 0;
    segment->units = 0;
    segment->quiet_bytes = segment->overruns = 0;
    segment->again = RKM04_NEVER;
    segment->master_free = 0;
    segment->head = segment->count = 0;
    wire_begin(&segment->wire);
}

static void power_up(struct segment *segment, unsigned number, const struct rkm04_config *config, const struct rkm04_port *port,
                     void *context)
{
    struct segment_unit *unit = &segment->unit[number - 1u];
    rkm04_init(&unit->unit, config, port, context);
    unit->since = segment->now;
    unit->powered = true;
    unit->in_frame = false;
    unit->frames = 0;
    unit->next = RKM04_NEVER;
    wire_join(&segment->wire, number, parts_of(segment->now));
}

unsigned segment_add_unit(struct segment *segment, const struct rkm04_config *config, const struct rkm04_port *port,
                          void *context)
{
    if (segment->units == SEGMENT_UNITS)
        return 0;
    power_up(segment, ++segment->units, config, port, context);
    return segment->units;
}

struct rkm04_unit *segment_unit(struct segment *segment, unsigned number)
{
    return &segment->unit[number - 1u].unit;
}

uint64_t segment_since(const struct segment *segment, unsigned number)
{
    return segment->unit[number - 1u].since;
}

void segment_power(struct segment *segment, unsigned number, bool on)
{
    struct segment_unit *unit = &segment->unit[number - 1u];
    unit->powered = unit->in_frame = false;
    unit->next = RKM04_NEVER;
    wire_leave(&segment->wire, number, parts_of(segment->now));
    if (!on)
        return;
    struct rkm04_config config = unit->unit.config;
    power_up(segment, number, &config, unit->unit.port, unit->unit.context);
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
        segment->master_free = segment->queue[segment->head].start;
    segment->count = 0;
    return count;
}

void segment_break(struct segment *segment, bool on)
{
    if (segment->config.timed)
        wire_hold(&segment->wire, WIRE_MASTER, on, parts_of(segment->now));
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
    return tick_of(earlier(wire_due(&segment->wire), start == RKM04_NEVER ? RKM04_NEVER : start + WIRE_BYTE));
}

uint64_t segment_next_event(const struct segment *segment)
{
    uint64_t next = RKM04_NEVER;
    for (unsigned i = 0; i < segment->units; i++) {
        const struct segment_unit *unit = &segment->unit[i];
        uint64_t event = unit->powered ? rkm04_next_event(&unit->unit) : RKM04_NEVER;
        if (event != RKM04_NEVER)
            next = earlier(next, event + unit->since);
    }
    return next;
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
    return segment_due(segment) == RKM04_NEVER;
}

struct segment_counters segment_counters(const struct segment *segment)
{
    return (struct segment_counters){
        .bytes = segment->wire.sent + segment->quiet_bytes,
        .collisions = segment->wire.collisions,
        .framing_errors = segment->wire.ear[WIRE_MONITOR].framing_errors,
        .overruns = segment->overruns,
    };
}
