/* SPDX-License-Identifier: MIT */
#include "levels.h"

#include <string.h>

#define BITS 10u                       /* of a byte: start bit, eight of data, stop bit */
#define STOP_BIT (BITS - 1u)
#define MIDDLE (WIRE_BIT / 2u)         /* of a bit */
#define DECIDED (STOP_BIT * WIRE_BIT + MIDDLE) /* from the start of a byte to the sample of its stop bit */
#define HELD_END (DEVICE_NEVER - 1u)    /* of a break that goes on; DEVICE_NEVER stands for none */

static uint32_t bit_of(unsigned station)
{
    return UINT32_C(1) << station;
}

/* The number of the bit that a signal sends `time` parts after its start. */
static unsigned bit_at(const struct wire_signal *signal, uint64_t time)
{
    return signal->held ? 0 : (unsigned)((time - signal->start) / WIRE_BIT);
}

static bool level(const struct wire *wire, uint64_t time)
{
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->start <= time && time < signal->end && (signal->bits >> bit_at(signal, time) & 1u) == 0)
            return false;
    }
    return true;
}

/* ---- Where the line falls ------------------------------------------------------------------------------------------- */

/* The first time after `after` and before `before` at which a signal goes to 0 by itself and finds the line at 1. */
static uint64_t signal_falls(const struct wire *wire, const struct wire_signal *signal, uint64_t after, uint64_t before)
{
    unsigned bit = after < signal->start ? 0 : bit_at(signal, after) + 1u;
    for (; bit < (signal->held ? 1u : STOP_BIT); bit++) {
        uint64_t time = signal->start + bit * WIRE_BIT;
        bool falls = (signal->bits >> bit & 1u) == 0 && (bit == 0 || (signal->bits >> (bit - 1u) & 1u) != 0);
        if (time >= before || time >= signal->end)
            break;
        if (falls && time > after && (time == 0 || level(wire, time - 1u)))
            return time;
    }
    return DEVICE_NEVER;
}

/* The first time from `from` on at which the line falls. `high`: whatever went before, it was at 1. */
static uint64_t line_falls(const struct wire *wire, uint64_t from, bool high)
{
    if ((high || from == 0 || level(wire, from - 1u)) && !level(wire, from))
        return from;
    uint64_t first = DEVICE_NEVER;
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->end <= from)
            continue;
        uint64_t time = signal_falls(wire, signal, from, first);
        if (time < first)
            first = time;
    }
    return first;
}

/* The end of what a station sends itself at some time from `from` to before `before`; DEVICE_NEVER: it sends nothing then. */
static uint64_t own_end(const struct wire *wire, unsigned station, uint64_t from, uint64_t before)
{
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->station == station && signal->start < before && signal->end > from)
            return signal->end;
    }
    return DEVICE_NEVER;
}

/* Find the beginning of the next byte that an ear hears: one during which it does not send itself. */
static void listen(struct wire *wire, unsigned ear)
{
    uint64_t from = wire->ear[ear].from, fall = DEVICE_NEVER, end;
    bool high = false; /* its receiver is off while it sends and gives a 1 */
    if ((wire->stations & bit_of(ear)) != 0) {
        do {
            while ((end = own_end(wire, ear, from, from + 1u)) != DEVICE_NEVER) {
                from = end;
                high = true;
            }
            fall = line_falls(wire, from, high);
            end = own_end(wire, ear, from, fall == DEVICE_NEVER ? DEVICE_NEVER : fall + DECIDED + 1u);
            from = end;
            high = true;
        } while (end != DEVICE_NEVER);
    }
    wire->ear[ear].fall = fall;
}

static void listen_all(struct wire *wire)
{
    for (unsigned ear = 0; ear < WIRE_EARS; ear++)
        listen(wire, ear);
}

/* ---- Signals -------------------------------------------------------------------------------------------------------- */

static void drop_signal(struct wire *wire, unsigned at)
{
    wire->count--;
    memmove(&wire->signal[at], &wire->signal[at + 1u], (wire->count - at) * sizeof wire->signal[0]);
}

/* Forget signals that ended before `time` and before anything that is being heard. Nothing fell until they ended, so the ears
 * need not look there again. */
static void forget(struct wire *wire, uint64_t time)
{
    for (unsigned ear = 0; ear < WIRE_EARS; ear++)
        if (wire->ear[ear].fall < time)
            time = wire->ear[ear].fall;
    for (unsigned i = 0; i < wire->count;) {
        uint64_t end = wire->signal[i].end;
        if (end + 1u >= time) {
            i++;
            continue;
        }
        for (unsigned ear = 0; ear < WIRE_EARS; ear++)
            if (wire->ear[ear].from <= end)
                wire->ear[ear].from = end + 1u;
        drop_signal(wire, i);
    }
}

static void count_collisions(struct wire *wire, struct wire_signal *added)
{
    for (unsigned i = 0; i < wire->count; i++) {
        struct wire_signal *signal = &wire->signal[i];
        if (signal->station == added->station || signal->end <= added->start)
            continue;
        wire->collisions += !signal->collided && !signal->held;
        wire->collisions += !added->collided && !added->held;
        signal->collided = added->collided = true;
    }
}

/* Put a signal on the wire. Returns it. */
static void add_signal(struct wire *wire, struct wire_signal added)
{
    forget(wire, added.start < WIRE_TICK ? 0 : added.start - WIRE_TICK);
    if (wire->count == WIRE_SIGNALS) /* only breaks can be that short */
        drop_signal(wire, 0);
    count_collisions(wire, &added);
    unsigned at = wire->count;
    while (at > 0 && wire->signal[at - 1u].start > added.start)
        at--;
    memmove(&wire->signal[at + 1u], &wire->signal[at], (wire->count - at) * sizeof wire->signal[0]);
    wire->signal[at] = added;
    wire->count++;
    listen_all(wire);
}

/* End what a station sends. */
static void cut(struct wire *wire, unsigned station, uint64_t time)
{
    for (unsigned i = 0; i < wire->count; i++) {
        struct wire_signal *signal = &wire->signal[i];
        if (signal->station == station && signal->end > time)
            signal->end = time > signal->start ? time : signal->start;
    }
}

void wire_begin(struct wire *wire)
{
    *wire = (struct wire){.stations = bit_of(WIRE_MASTER) | bit_of(WIRE_MONITOR)};
    listen_all(wire);
}

void wire_join(struct wire *wire, unsigned station, uint64_t time)
{
    cut(wire, station, time);
    wire->stations |= bit_of(station);
    wire->ear[station].from = time;
    listen_all(wire);
}

void wire_leave(struct wire *wire, unsigned station, uint64_t time)
{
    cut(wire, station, time);
    wire->stations &= ~bit_of(station);
    listen_all(wire);
}

void wire_send(struct wire *wire, unsigned station, uint8_t byte, uint64_t start)
{
    struct wire_signal signal = {
        .start = start,
        .end = start + WIRE_BYTE,
        .bits = (uint16_t)(1u << STOP_BIT | (unsigned)byte << 1),
        .station = (uint8_t)station,
    };
    wire->sent++;
    add_signal(wire, signal);
}

void wire_hold(struct wire *wire, unsigned station, bool on, uint64_t time)
{
    bool held = false;
    for (unsigned i = 0; i < wire->count; i++) {
        struct wire_signal *signal = &wire->signal[i];
        if (signal->station != station || !signal->held || signal->end != HELD_END)
            continue;
        held = true;
        if (!on)
            signal->end = time;
    }
    if (on && !held)
        add_signal(wire, (struct wire_signal){.start = time, .end = HELD_END, .station = (uint8_t)station, .held = true});
    else
        listen_all(wire);
}

void wire_shift(struct wire *wire, uint64_t parts)
{
    for (unsigned i = 0; i < wire->count; i++) {
        wire->signal[i].start += parts;
        if (wire->signal[i].end != HELD_END)
            wire->signal[i].end += parts;
    }
    for (unsigned ear = 0; ear < WIRE_EARS; ear++) {
        wire->ear[ear].from += parts;
        if (wire->ear[ear].fall != DEVICE_NEVER)
            wire->ear[ear].fall += parts;
    }
}

/* ---- Hearing -------------------------------------------------------------------------------------------------------- */

/* The ear that hears a byte next. */
static unsigned next_ear(const struct wire *wire)
{
    unsigned next = 0;
    for (unsigned ear = 1; ear < WIRE_EARS; ear++)
        if (wire->ear[ear].fall < wire->ear[next].fall)
            next = ear;
    return next;
}

uint64_t wire_due(const struct wire *wire)
{
    uint64_t fall = wire->ear[next_ear(wire)].fall;
    return fall == DEVICE_NEVER ? DEVICE_NEVER : fall + WIRE_BYTE;
}

static uint32_t senders(const struct wire *wire, uint64_t start, uint64_t end)
{
    uint32_t mask = 0;
    for (unsigned i = 0; i < wire->count; i++)
        if (wire->signal[i].start < end && wire->signal[i].end > start)
            mask |= bit_of(wire->signal[i].station);
    return mask;
}

/* What an ear makes of the line from its fall on. Returns false if that was no start bit. */
static bool sample(const struct wire *wire, unsigned ear, struct wire_byte *heard)
{
    uint64_t start = wire->ear[ear].fall;
    if (level(wire, start + MIDDLE))
        return false;
    unsigned byte = 0;
    for (unsigned bit = 1; bit < STOP_BIT; bit++)
        byte |= (unsigned)level(wire, start + bit * WIRE_BIT + MIDDLE) << (bit - 1u);
    *heard = (struct wire_byte){
        .start = start,
        .end = start + WIRE_BYTE,
        .ear = ear,
        .senders = senders(wire, start, start + WIRE_BYTE),
        .byte = (uint8_t)byte,
        .lost = !level(wire, start + DECIDED),
    };
    return true;
}

bool wire_hear(struct wire *wire, uint64_t until, struct wire_byte *byte)
{
    while (wire_due(wire) <= until && wire_due(wire) != DEVICE_NEVER) {
        unsigned number = next_ear(wire);
        struct wire_ear *ear = &wire->ear[number];
        bool heard = sample(wire, number, byte);
        ear->from = ear->fall + (heard ? DECIDED : MIDDLE) + 1u;
        listen(wire, number);
        if (!heard)
            continue;
        if (byte->lost)
            ear->framing_errors++;
        else
            ear->heard++;
        if (!byte->lost || number == WIRE_MONITOR)
            return true;
    }
    return false;
}
