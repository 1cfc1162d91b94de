/* SPDX-License-Identifier: MIT */
#include "pulses.h"

#include <rkm04/limits.h>

/* Is tick a after tick b? They lie less than 2^31 apart. */
static inline bool after(uint32_t a, uint32_t b)
{
    return (int32_t)(a - b) > 0;
}

void pulses_start(struct pulses *pulses, uint32_t now)
{
    *pulses = (struct pulses){.latest = 0};
    for (unsigned i = 0; i < PULSES_LANES; i++) {
        pulses->lane[i].next = now + PULSES_FAR;
        pulses->lane[i].free = now;
        pulses->lane[i].idle = true;
    }
}

void pulses_put(struct pulses *pulses, unsigned number, uint32_t tick, uint8_t item)
{
    struct pulse_lane *lane = &pulses->lane[number];
    uint32_t in = lane->in;
    lane->tick[in % PULSES_ROOM] = tick;
    lane->item[in % PULSES_ROOM] = item;
    __atomic_signal_fence(__ATOMIC_SEQ_CST); /* the interrupt sees the item whole before it sees that there is one */
    lane->in = in + 1;
}

size_t pulses_put_steps(struct pulses *pulses, unsigned number, const uint64_t *tick, size_t count)
{
    struct pulse_lane *lane = &pulses->lane[number];
    uint32_t in = lane->in, room = PULSES_ROOM - (in - lane->out);
    if (count > room)
        count = room;
    for (size_t i = 0; i < count; i++, in++) {
        const uint32_t at = in % PULSES_ROOM;
        lane->tick[at] = (uint32_t)tick[i];
        lane->item[at] = PULSE_STEP;
    }
    __atomic_signal_fence(__ATOMIC_SEQ_CST);
    lane->in = in;
    return count;
}

/* When does the lane continue? The pin is at 0. */
static inline void set_next(struct pulse_lane *lane, uint32_t now)
{
    lane->idle = lane->in == lane->out;
    if (lane->idle) {
        lane->next = now + PULSES_FAR;
        return;
    }
    uint32_t due = lane->tick[lane->out % PULSES_ROOM];
    lane->next = after(lane->free, due) ? lane->free : due;
}

void pulses_refresh(struct pulses *pulses)
{
    for (unsigned i = 0; i < PULSES_LANES; i++)
        if (pulses->lane[i].idle && pulses->lane[i].in != pulses->lane[i].out)
            set_next(&pulses->lane[i], 0);
}

/* Do what is due in a lane. */
static void play(struct pulses *pulses, unsigned number, const struct pulse_pins *pins, uint32_t now)
{
    struct pulse_lane *lane = &pulses->lane[number];
    if (lane->high) {
        pins->step(number, false);
        lane->high = false;
        lane->free = now + PULSES_REST;
    } else if (lane->idle) {
        lane->free = now; /* or it would seem to lie ahead one day */
    } else {
        uint32_t at = lane->out % PULSES_ROOM, late = now - lane->tick[at];
        uint8_t item = lane->item[at];
        __atomic_signal_fence(__ATOMIC_SEQ_CST);
        lane->out++;
        if (late > pulses->latest)
            pulses->latest = late;
        if (number == 0) {
            pins->outputs(item);
        } else if (item == PULSE_STEP) {
            pins->step(number, true);
            lane->high = true;
            lane->next = now + RKM04_PULSE_TICKS;
            return;
        } else {
            pins->direction(number, item == PULSE_FORWARD);
            lane->free = now + PULSES_SETTLE;
        }
    }
    set_next(lane, now);
}

uint32_t pulses_play(struct pulses *pulses, const struct pulse_pins *pins, uint32_t now, uint32_t latest)
{
    for (unsigned i = 0; i < PULSES_LANES; i++) {
        const struct pulse_lane *lane = &pulses->lane[i];
        if (!after(lane->next, now))
            play(pulses, i, pins, now);
        if (after(latest, lane->next))
            latest = lane->next;
    }
    return latest;
}
