/* SPDX-License-Identifier: MIT */
/* tally.h: what goes out of a line, in a form that can be compared: every byte that reaches the host, and of all else, for each
 * motor and each unit, a digest at the end of every span of time in which something happened. It does not depend on how time was
 * cut into pieces. */
#ifndef RKM04_RECORD_TALLY_H
#define RKM04_RECORD_TALLY_H

#include "sim/sim.h"

#define TALLY_UNITS (SEGMENT_UNITS + 1u) /* unit 0: the bytes on the wires */
#define TALLY_MOTORS (DEVICE_AXES_MAX + 1u) /* motor 0: the unit */

/* Of one motor, of one unit, or of the wires, since the beginning. */
struct tally_stream {
    uint64_t digest; /* sum of a hash of each event */
    uint64_t events;
    uint64_t steps;  /* events that are pulses */
    int32_t position; /* of the counter after the last pulse */
    bool changed;    /* in the present span */
};

struct tally_byte {
    uint64_t tick;
    uint8_t byte;
};

struct tally_calls {
    /* A byte has reached the host. */
    void (*byte)(void *context, const struct tally_byte *byte);
    /* A span is over at `tick`: take in the streams that have changed. */
    void (*span)(void *context, uint64_t tick);
};

struct tally {
    struct sim *sim;
    const struct tally_calls *calls;
    void *context;
    uint64_t span_end; /* of the present one */
    bool changed;      /* any stream, in the present span */
    bool short_of_memory;
    struct tally_stream stream[TALLY_UNITS][TALLY_MOTORS];
    struct watcher watcher;
    size_t told, count, room; /* bytes: those that have been reported */
    struct tally_byte *heard;
    struct sim_config config; /* of the sim, before we listened */
};

/* Begin to count what a sim does at its present tick: as a watcher, and between it and its config.out. *tally must be zero. */
void tally_begin(struct tally *tally, struct sim *sim, const struct tally_calls *calls, void *context);

/* Tell everything before the present tick of the sim. */
void tally_finish_tick(struct tally *tally);

/* Tell also what has happened at the present tick; the present span need not be over for that. */
void tally_finish(struct tally *tally);

/* The streams that have changed are taken note of: a new span begins. */
void tally_clear_changed(struct tally *tally);

void tally_end(struct tally *tally);

#endif
