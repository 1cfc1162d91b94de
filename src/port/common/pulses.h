/* SPDX-License-Identifier: MIT */
/* pulses.h: for ports whose pulses are to be exact: the unit runs ahead of the clock, and what it wants done at which tick waits
 * here until a timer's interrupt does it, whatever the main loop is busy with. Knows no board: it calls the struct pulse_pins.
 *
 *     main loop                                 timer interrupt
 *     rkm04_advance -> on_steps -> pulses_put    pulses_play -> pins.step; arm the timer for the tick returned
 *
 * One lane a motor, one for the outputs: a lane is filled in the order of its ticks, lanes are merged when played. Ticks here
 * have 32 bits: what waits lies far less than 2^31 us ahead. */
#ifndef PULSES_H
#define PULSES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PULSES_LANES 5u  /* motors 1..4, and 0: DO */
#define PULSES_ROOM 128u /* of a lane; a power of 2. 7 ms at 16 000 steps/s are 112. */
#define PULSES_FAR 0x40000000u /* us: a lane without anything is checked again so late */
#define PULSES_REST 10u  /* us a step pin rests at 0 after a pulse, if what follows is late; also R7's 10 us of the direction */
#define PULSES_SETTLE 20u /* us between direction and step (R7), if they are late; in time the unit sees to it */

/* How a port moves its pins; called from pulses_play. */
struct pulse_pins {
    void (*step)(unsigned motor, bool on);
    void (*direction)(unsigned motor, bool forward);
    void (*outputs)(uint8_t mask);
};

enum pulse_what { PULSE_STEP, PULSE_BACK, PULSE_FORWARD };

struct pulse_lane {
    uint32_t next;         /* tick at which there is something to do */
    uint32_t free;         /* tick before which no item may be played: rest after a pulse, settling of the direction */
    bool high, idle;       /* the step pin is at 1; there was nothing more to play */
    volatile uint32_t in;  /* items ever put in: only the main loop writes it */
    volatile uint32_t out; /* items ever played: only the interrupt writes it */
    uint32_t tick[PULSES_ROOM];
    uint8_t item[PULSES_ROOM]; /* enum pulse_what; in lane 0 the mask of DO */
};

struct pulses {
    struct pulse_lane lane[PULSES_LANES]; /* 0: DO */
    uint32_t latest;                      /* us: the most by which anything was late; for who tries a clock rate */
};

/* Everything empty, at tick `now`. */
void pulses_start(struct pulses *pulses, uint32_t now);

/* Is there room for one more item of this lane (0..4)? */
static inline bool pulses_room(const struct pulses *pulses, unsigned lane)
{
    return pulses->lane[lane].in - pulses->lane[lane].out < PULSES_ROOM;
}

/* Main loop: put an item in, for lane 0 (DO: item is the mask) or motor 1..4 (item: enum pulse_what), in the order of ticks.
 * There must be room. */
void pulses_put(struct pulses *pulses, unsigned lane, uint32_t tick, uint8_t item);

/* The same for steps of a motor: as many of them as there is room for. Returns their number. */
size_t pulses_put_steps(struct pulses *pulses, unsigned lane, const uint64_t *tick, size_t count);

/* Interrupt of a board that plays the lanes itself: the next item of a lane, if there is one; it is done. */
static inline bool pulses_peek(const struct pulses *pulses, unsigned number, uint32_t *tick, uint8_t *item)
{
    const struct pulse_lane *lane = &pulses->lane[number];
    if (lane->in == lane->out)
        return false;
    *tick = lane->tick[lane->out % PULSES_ROOM];
    *item = lane->item[lane->out % PULSES_ROOM];
    return true;
}

static inline void pulses_drop(struct pulses *pulses, unsigned number)
{
    __atomic_signal_fence(__ATOMIC_SEQ_CST);
    pulses->lane[number].out++;
}

/* Main loop, with the timer's interrupt off: lanes that were empty learn of what has been put there. Then have it play. */
void pulses_refresh(struct pulses *pulses);

/* Interrupt: do what is due at `now`. Returns the tick at which to come again, or `latest`, whichever is first; it may have come
 * already. Has to be called at least once in 2^30 us. */
uint32_t pulses_play(struct pulses *pulses, const struct pulse_pins *pins, uint32_t now, uint32_t latest);

#endif
