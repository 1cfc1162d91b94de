/* SPDX-License-Identifier: MIT */
#include "levels.h"

#include <string.h>

#define BITS 10u                       /* of a byte: start bit, eight of data, stop bit */
#define STOP_BIT (BITS - 1u)
#define TICKS_PER_SECOND 1000000u
#define HELD_END (DEVICE_NEVER - 1u)    /* of a break that continues; DEVICE_NEVER stands for none */

static uint32_t bit_of(unsigned station)
{
    return UINT32_C(1) << station;
}

uint64_t wire_byte_parts(const struct wire *wire)
{
    return (uint64_t)BITS * wire->bit;
}

/* From the begin of a bit to its middle. */
static uint64_t middle(const struct wire *wire)
{
    return wire->bit / 2u;
}

/* From the start of a byte to the sample of its stop bit. */
static uint64_t decided(const struct wire *wire)
{
    return (uint64_t)STOP_BIT * wire->bit + middle(wire);
}

/* The number of the bit that a signal sends at `time`. */
static unsigned bit_at(const struct wire *wire, const struct wire_signal *signal, uint64_t time)
{
    return signal->held ? 0 : (unsigned)((time - signal->start) / wire->bit);
}

static bool is_high(const struct wire *wire, uint64_t time)
{
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->start <= time && time < signal->end && (signal->bits >> bit_at(wire, signal, time) & 1u) == 0)
            return false;
    }
    return true;
}

/* ---- Where the line falls ------------------------------------------------------------------------------------------- */

/* The first time after `after` and before `before` at which a signal goes to 0 by itself and finds the line at 1. */
static uint64_t is_signal_falling(const struct wire *wire, const struct wire_signal *signal, uint64_t after, uint64_t before)
{
    unsigned bit = after < signal->start ? 0 : bit_at(wire, signal, after) + 1u;
    for (; bit < (signal->held ? 1u : STOP_BIT); bit++) {
        uint64_t time = signal->start + (uint64_t)bit * wire->bit;
        bool falls = (signal->bits >> bit & 1u) == 0 && (bit == 0 || (signal->bits >> (bit - 1u) & 1u) != 0);
        if (time >= before || time >= signal->end)
            break;
        if (falls && time > after && (time == 0 || is_high(wire, time - 1u)))
            return time;
    }
    return DEVICE_NEVER;
}

/* The first time from `from` on at which the line falls. `high`: whatever went before, it was at 1. */
static uint64_t line_falls(const struct wire *wire, uint64_t from, bool high)
{
    if ((high || from == 0 || is_high(wire, from - 1u)) && !is_high(wire, from))
        return from;
    uint64_t first = DEVICE_NEVER;
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->end <= from)
            continue;
        uint64_t time = is_signal_falling(wire, signal, from, first);
        if (time < first)
            first = time;
    }
    return first;
}

/* The end of what a unit sends itself at some time from `from` to before `before`; DEVICE_NEVER: it sends nothing then. */
static uint64_t end_of_own_signal(const struct wire *wire, unsigned station, uint64_t from, uint64_t before)
{
    for (unsigned i = 0; i < wire->count; i++) {
        const struct wire_signal *signal = &wire->signal[i];
        if (signal->station == station && signal->start < before && signal->end > from)
            return signal->end;
    }
    return DEVICE_NEVER;
}

/* As line_falls(), which most receivers ask for the same. */
static uint64_t find_fall(struct wire *wire, uint64_t from, bool high)
{
    if (wire->found.from != from || wire->found.high != high) {
        wire->found.fall = line_falls(wire, from, high);
        wire->found.from = from;
        wire->found.high = high;
    }
    return wire->found.fall;
}

/* The signals are others, or later. */
static void forget_findings(struct wire *wire)
{
    wire->found.from = wire->sampled.start = DEVICE_NEVER;
}

/* Find the beginning of the next byte that a receiver in use receives: one during which it does not send itself. */
static void find_next_byte(struct wire *wire, unsigned receiver)
{
    uint64_t from = wire->receiver[receiver].from, fall, end;
    bool high = false; /* its receiver is off while it sends and gives a 1 */
    do {
        while ((end = end_of_own_signal(wire, receiver, from, from + 1u)) != DEVICE_NEVER) {
            from = end;
            high = true;
        }
        fall = find_fall(wire, from, high);
        end = end_of_own_signal(wire, receiver, from, fall == DEVICE_NEVER ? DEVICE_NEVER : fall + decided(wire) + 1u);
        from = end;
        high = true;
    } while (end != DEVICE_NEVER);
    wire->receiver[receiver].fall = fall;
}

/* Find the receiver that receives a byte next; of several with the same time the first one. */
static void find_first_receiver(struct wire *wire)
{
    unsigned first = 0;
    for (unsigned receiver = 1; receiver < WIRE_RECEIVERS; receiver++)
        if (wire->receiver[receiver].fall < wire->receiver[first].fall)
            first = receiver;
    wire->first = first;
}

/* After a change of the signals. */
static void find_next_bytes(struct wire *wire)
{
    forget_findings(wire);
    for (unsigned receiver = 0; receiver < WIRE_RECEIVERS; receiver++) {
        if ((wire->stations & bit_of(receiver)) != 0)
            find_next_byte(wire, receiver);
        else
            wire->receiver[receiver].fall = DEVICE_NEVER;
    }
    find_first_receiver(wire);
}

/* ---- Signals -------------------------------------------------------------------------------------------------------- */

static void drop_signal(struct wire *wire, unsigned at)
{
    wire->count--;
    memmove(&wire->signal[at], &wire->signal[at + 1u], (wire->count - at) * sizeof wire->signal[0]);
}

/* Forget signals that ended before `time` and before anything that is being received. Nothing fell until they ended, so the
 * receivers need not look there again. */
static void drop_old_signals(struct wire *wire, uint64_t time)
{
    if (wire->receiver[wire->first].fall < time)
        time = wire->receiver[wire->first].fall;
    for (unsigned i = 0; i < wire->count;) {
        uint64_t end = wire->signal[i].end;
        if (end + 1u >= time) {
            i++;
            continue;
        }
        for (unsigned receiver = 0; receiver < WIRE_RECEIVERS; receiver++)
            if (wire->receiver[receiver].from <= end)
                wire->receiver[receiver].from = end + 1u;
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
    drop_old_signals(wire, added.start < WIRE_TICK ? 0 : added.start - WIRE_TICK);
    if (wire->count == WIRE_SIGNALS) /* only breaks can be that short */
        drop_signal(wire, 0);
    count_collisions(wire, &added);
    unsigned at = wire->count;
    while (at > 0 && wire->signal[at - 1u].start > added.start)
        at--;
    memmove(&wire->signal[at + 1u], &wire->signal[at], (wire->count - at) * sizeof wire->signal[0]);
    wire->signal[at] = added;
    wire->count++;
    find_next_bytes(wire);
}

/* End what a unit sends. */
static void cut_signals(struct wire *wire, unsigned station, uint64_t time)
{
    for (unsigned i = 0; i < wire->count; i++) {
        struct wire_signal *signal = &wire->signal[i];
        if (signal->station == station && signal->end > time)
            signal->end = time > signal->start ? time : signal->start;
    }
}

void wire_begin(struct wire *wire, unsigned baud)
{
    *wire = (struct wire){.bit = WIRE_TICK * TICKS_PER_SECOND / baud, .stations = bit_of(WIRE_HOST) | bit_of(WIRE_MONITOR)};
    find_next_bytes(wire);
}

void wire_join(struct wire *wire, unsigned station, uint64_t time)
{
    cut_signals(wire, station, time);
    wire->stations |= bit_of(station);
    wire->receiver[station].from = time;
    find_next_bytes(wire);
}

void wire_leave(struct wire *wire, unsigned station, uint64_t time)
{
    cut_signals(wire, station, time);
    wire->stations &= ~bit_of(station);
    find_next_bytes(wire);
}

void wire_send(struct wire *wire, unsigned station, uint8_t byte, uint64_t start)
{
    struct wire_signal signal = {
        .start = start,
        .end = start + wire_byte_parts(wire),
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
        find_next_bytes(wire);
}

void wire_shift(struct wire *wire, uint64_t parts)
{
    forget_findings(wire);
    for (unsigned i = 0; i < wire->count; i++) {
        wire->signal[i].start += parts;
        if (wire->signal[i].end != HELD_END)
            wire->signal[i].end += parts;
    }
    for (unsigned receiver = 0; receiver < WIRE_RECEIVERS; receiver++) {
        wire->receiver[receiver].from += parts;
        if (wire->receiver[receiver].fall != DEVICE_NEVER)
            wire->receiver[receiver].fall += parts;
    }
}

/* ---- Hearing -------------------------------------------------------------------------------------------------------- */

uint64_t wire_due(const struct wire *wire)
{
    uint64_t fall = wire->receiver[wire->first].fall;
    return fall == DEVICE_NEVER ? DEVICE_NEVER : fall + wire_byte_parts(wire);
}

static uint32_t senders(const struct wire *wire, uint64_t start, uint64_t end)
{
    uint32_t mask = 0;
    for (unsigned i = 0; i < wire->count; i++)
        if (wire->signal[i].start < end && wire->signal[i].end > start)
            mask |= bit_of(wire->signal[i].station);
    return mask;
}

/* What a receiver makes of the line from its fall at `start` on. Returns false if that was no start bit. */
static bool sample(struct wire *wire, uint64_t start)
{
    if (wire->sampled.start == start)
        return true;
    if (is_high(wire, start + middle(wire)))
        return false;
    unsigned byte = 0;
    for (unsigned bit = 1; bit < STOP_BIT; bit++)
        byte |= (unsigned)is_high(wire, start + (uint64_t)bit * wire->bit + middle(wire)) << (bit - 1u);
    wire->sampled = (struct wire_byte){
        .start = start,
        .end = start + wire_byte_parts(wire),
        .senders = senders(wire, start, start + wire_byte_parts(wire)),
        .byte = (uint8_t)byte,
        .lost = !is_high(wire, start + decided(wire)),
    };
    return true;
}

bool wire_receive(struct wire *wire, uint64_t until, struct wire_byte *byte)
{
    for (uint64_t due; (due = wire_due(wire)) <= until && due != DEVICE_NEVER;) {
        unsigned number = wire->first;
        struct wire_receiver *receiver = &wire->receiver[number];
        bool received = sample(wire, receiver->fall);
        receiver->from = receiver->fall + (received ? decided(wire) : middle(wire)) + 1u;
        find_next_byte(wire, number);
        find_first_receiver(wire);
        if (!received)
            continue;
        *byte = wire->sampled;
        byte->receiver = number;
        if (byte->lost)
            receiver->framing_errors++;
        else
            receiver->received++;
        if (!byte->lost || number == WIRE_MONITOR)
            return true;
    }
    return false;
}
