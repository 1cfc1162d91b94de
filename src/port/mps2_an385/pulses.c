#include "pulses.h"

#include <rkm04/limits.h>

/* Is tick a after tick b? They lie less than 2^31 apart. */
static bool after(uint32_t a, uint32_t b)
{
    return (int32_t)(a - b) > 0;
}

bool pulses_room(const struct pulses *pulses, unsigned lane)
{
    return pulses->lane[lane].in - pulses->lane[lane].out < PULSES_ROOM;
}

void pulses_put(struct pulses *pulses, unsigned number, uint32_t tick, enum pulse_what what, uint8_t value)
{
    struct pulse_lane *lane = &pulses->lane[number];
    uint32_t in = lane->in;
    lane->item[in % PULSES_ROOM] = (struct pulse_item){.tick = tick, .what = (uint8_t)what, .value = value};
    __atomic_signal_fence(__ATOMIC_SEQ_CST); /* the interrupt sees the item whole before it sees that there is one */
    lane->in = in + 1;
}

/* Do one item; a step makes the pin busy for its width, a change of direction for as long as it takes to settle. */
static void play(struct pulse_lane *lane, unsigned number, const struct pulse_pins *pins, uint32_t now)
{
    const struct pulse_item *item = &lane->item[lane->out % PULSES_ROOM];
    if (item->what == PULSE_STEP) {
        pins->step(number, true);
        lane->high = true;
        lane->until = now + RKM04_PULSE_TICKS;
    } else if (item->what == PULSE_DIRECTION) {
        pins->direction(number, item->value != 0);
        lane->resting = true;
        lane->until = now + PULSES_SETTLE;
    } else {
        pins->outputs(item->value);
    }
    __atomic_signal_fence(__ATOMIC_SEQ_CST);
    lane->out++;
}

/* Do what is due in one lane. Returns whether something is left, with its tick in *next. */
static bool play_lane(struct pulses *pulses, unsigned number, const struct pulse_pins *pins, uint32_t now, uint32_t *next)
{
    struct pulse_lane *lane = &pulses->lane[number];
    for (;;) {
        if (lane->high) {
            *next = lane->until;
            if (after(lane->until, now))
                return true;
            pins->step(number, false);
            lane->high = false;
            lane->resting = true;
            lane->until = now + PULSES_REST;
        }
        if (lane->resting && !after(lane->until, now))
            lane->resting = false;
        if (lane->in == lane->out)
            return false;
        uint32_t due = lane->item[lane->out % PULSES_ROOM].tick;
        *next = lane->resting && after(lane->until, due) ? lane->until : due;
        if (after(*next, now))
            return true;
        if (now - due > pulses->latest)
            pulses->latest = now - due;
        play(lane, number, pins, now);
    }
}

bool pulses_play(struct pulses *pulses, const struct pulse_pins *pins, uint32_t now, uint32_t *next)
{
    bool any = false;
    for (unsigned i = 0; i < PULSES_LANES; i++) {
        uint32_t tick;
        if (play_lane(pulses, i, pins, now, &tick) && (!any || after(*next, tick))) {
            *next = tick;
            any = true;
        }
    }
    return any;
}
