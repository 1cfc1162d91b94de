/* pulses.h: the unit runs ahead of the clock; what it wants done at which tick waits here until a timer's interrupt does it.
 * So pulses are exact to the tick, whatever the main loop is busy with. Knows no board: it calls the struct pulse_pins.
 *
 *     main loop                                 timer interrupt
 *     rkm04_advance -> on_step -> pulses_step   pulses_play -> pins.step; arm the timer for the tick returned
 *
 * One lane a motor, one for the outputs: a lane is filled in the order of its ticks, lanes are merged when played. Ticks here
 * have 32 bits: what waits lies far less than 2^31 us ahead. */
#ifndef PULSES_H
#define PULSES_H

#include <stdbool.h>
#include <stdint.h>

#define PULSES_LANES 5u  /* motors 1..4, and 0: DO */
#define PULSES_ROOM 64u  /* a lane: 3 ms at 16 000 steps/s are 48; a power of 2 */
#define PULSES_REST 10u  /* us a step pin rests at 0 after a pulse, if what follows is late; also R7's 10 us of the direction */
#define PULSES_SETTLE 20u /* us between direction and step (R7), if they are late; in time the unit sees to it */

/* How a port moves its pins; called from pulses_play. */
struct pulse_pins {
    void (*step)(unsigned motor, bool on);
    void (*direction)(unsigned motor, bool forward);
    void (*outputs)(uint8_t mask);
};

enum pulse_what { PULSE_STEP, PULSE_DIRECTION, PULSE_OUTPUTS };

struct pulse_item {
    uint32_t tick;
    uint8_t what; /* enum pulse_what */
    uint8_t value;
};

struct pulse_lane {
    volatile uint32_t in;  /* items ever put in: only the main loop writes it */
    volatile uint32_t out; /* items ever played: only the interrupt writes it */
    uint32_t until;        /* high: tick at which the pin goes to 0; resting: tick before which nothing else may be done */
    bool high, resting;
    struct pulse_item item[PULSES_ROOM];
};

struct pulses {
    struct pulse_lane lane[PULSES_LANES]; /* 0: DO */
    uint32_t latest;                      /* us: the most by which anything was late; for the one who tries a clock rate */
};

/* Is there room for one more item of this lane (0..4)? */
bool pulses_room(const struct pulses *pulses, unsigned lane);

/* Main loop: put an item in, for lane 0 (DO) or motor 1..4, in the order of ticks. There must be room. */
void pulses_put(struct pulses *pulses, unsigned lane, uint32_t tick, enum pulse_what what, uint8_t value);

/* Interrupt: do what is due at `now`. Returns whether anything is left to do, and then in *next the tick of it (> now). */
bool pulses_play(struct pulses *pulses, const struct pulse_pins *pins, uint32_t now, uint32_t *next);

#endif
