/* SPDX-License-Identifier: MIT */
/* story.h: random programs with random inputs, texts and frames, run at different paces, for K3: time may be cut into any
 * pieces. A failure names the seed of its story. */
#ifndef RKM04_TESTS_STORY_H
#define RKM04_TESTS_STORY_H

#include <rkm04/unit.h>

#include "recorder.h"

#define STORY_ACTIONS_MAX 64
#define STORY_TEXT_MAX 400
#define STORY_WIRE_MAX 16384

/* What comes from outside, and when. */
struct action {
    uint64_t tick;
    enum { ACT_INPUTS, ACT_TEXT, ACT_FRAME, ACT_DRAIN } kind;
    char motor;
    uint8_t inputs;
    unsigned bytes; /* ACT_DRAIN: how many */
    uint16_t length;
    uint8_t text[STORY_TEXT_MAX]; /* a program, or the bytes of a frame */
};

struct story {
    unsigned seed;
    uint64_t end;
    struct rkm04_readings readings; /* others than the defaults in every second story */
    unsigned count;
    struct action action[STORY_ACTIONS_MAX];
};

/* One unit living through a story. */
struct run {
    struct rkm04_unit unit;
    struct recorder record;
    uint8_t wire[STORY_WIRE_MAX]; /* what it has sent */
    size_t wired;
    unsigned next; /* action */
    uint64_t dice;
};

enum pace {
    PACE_TICK,   /* one tick at a time */
    PACE_MS,     /* 1000 */
    PACE_LEAPS,  /* any number */
    PACE_EVENTS, /* from rkm04_next_event to rkm04_next_event */
    PACE_WHOLE   /* from action to action */
};

/* Make the story of a seed, `end` ticks long. slow: motions of seconds and dwells of up to 0.3 s, otherwise of milliseconds. */
void story_tell(struct story *story, unsigned seed, uint64_t end, bool slow);

/* A number below `below` from the dice of the last story. */
uint64_t story_draw(uint64_t below);

/* Power a unit up for it. The record begins again. */
void run_begin(struct run *run, const struct story *story);

/* Do one action at the present tick. */
void run_act(struct run *run, const struct action *action);

/* Continue until a tick, which is not yet done then. */
void run_until(struct run *run, const struct story *story, uint64_t until, enum pace pace);

/* Every pulse, output, event and answer, the state and what the unit would answer to questions are the same. Sorts the
 * records. `what` names the two that were compared. */
void run_compare(struct run *wanted, struct run *got, unsigned seed, const char *what);

#endif
