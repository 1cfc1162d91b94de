/* SPDX-License-Identifier: MIT */
/* feed.h: for boards where hardware plays the lanes of `board_pulses` by itself: it has a queue of words a lane, each with the
 * distance in ticks from the change of the pins before. feed() keeps these queues filled with what is due within a millisecond.
 * Where nothing is due it gives words that only wait: hardware that never runs dry never loses its time. */
#ifndef FEED_H
#define FEED_H

#include <stdbool.h>
#include <stdint.h>

#define FEED_WINDOW 1000 /* us */

/* How the hardware plays a lane. */
struct feed_timing {
    uint8_t apart; /* us between two changes of the pins, at least, if something is late; in time the unit sees to it */
    uint8_t rest;  /* us from the change of the pins to the end of a word */
};

/* The lane begins: its pins change last at `end`. */
void feed_start(unsigned lane, uint32_t end);

/* Interrupt, often enough for the queues: hand over what is due. */
void feed(unsigned lane, const struct feed_timing *timing, uint32_t now);

/* DO and, from bit 8 on, LEDs: `mask` replaces those under `of`, from the next word of lane 0 on. */
void feed_levels(uint32_t of, uint32_t mask);
uint32_t feed_level(void);

/* Of the board: how many words has the queue room for? A word for it: the pins change `after` ticks after they did last, to these
 * levels: lane 0: DO and LEDs; motors: bit 1 direction, bit 0: there is a pulse. */
unsigned board_feed_room(unsigned lane);
void board_feed_give(unsigned lane, uint32_t after, uint32_t levels);

#endif
