/* SPDX-License-Identifier: MIT */
/* record.h: recordings, replays and snapshots of a bus; the face of the room.
 *
 *     record, record_line          a recording: the configuration, what comes in with its tick, what goes out
 *     tally                        what goes out, as bytes and running digests
 *     replay                       a recording done again; names the first difference; replay_state.h has its parts
 *     snapshot, snapshot_store     the present state of a bus, to come back to; those with names
 *     snapshot_command, restore    the commands `snapshot` and `restore`
 *     journal                      what has come in, in memory, for snapshots to files
 *
 * docs/RECORD.md describes the file: JSON, one object a line. */
#ifndef RKM04_RECORD_H
#define RKM04_RECORD_H

#include <stdio.h>

#include "sim/sim.h"

struct record;

/* Begin to record what comes in and goes out, on `out`, which stays the caller's. To be called at tick 0, when the plant is
 * there and before anything has come in. Every line is flushed as it is written. Returns NULL if out of memory or a flash image
 * cannot be read. */
struct record *record_begin(struct sim *sim, FILE *out);

/* End: write the last digests, and flush. Returns 0 or the errno of the first failure. Frees the record. */
int record_end(struct record *record);

/* 0, or the errno with which writing has failed. Nothing is written after the first failure. */
int record_failed(const struct record *record);

struct replay;

/* What became of a replay. */
enum replay_end {
    REPLAY_SAME,        /* everything went out as recorded */
    REPLAY_DIFFERENT,   /* it did not: replay_text() says where and how */
    REPLAY_WRONG,       /* the file is no recording or damaged: replay_text() says line, column, what was expected */
    REPLAY_INTERRUPTED,
    REPLAY_NO_MEMORY
};

/* The first difference. */
struct replay_difference {
    unsigned unit, motor; /* 0: see `what`; the unit */
    char name[NODE_NAME_SIZE]; /* of the unit */
    const char *what;     /* "the host": bytes that reach it, "the wires", "the control", "unit", "motor" */
    uint64_t from, until; /* ticks: where it may lie, both included */
    char recorded[200], came[200];
};

struct replay_counts {
    uint64_t lines;               /* of the file, read so far */
    uint64_t inputs;              /* bytes and commands, lines with */
    uint64_t bytes_in, bytes_out; /* of the host */
    uint64_t steps;
    bool whole;                   /* the recording has been brought to its end */
};

/* Read the head of a recording and power up a sim like the one recorded. NULL: out of memory; otherwise replay_sim() is NULL if
 * the file is wrong. `name` is for messages; it and `in` must stay until replay_free(). */
struct replay *replay_open(const char *name, FILE *in);
struct sim *replay_sim(struct replay *replay);

/* Last tick to be done; DEVICE_NEVER, without this: to the end of the record. */
void replay_until(struct replay *replay, uint64_t tick);

/* Do it all. Traces may have joined the sim before. `interrupted`: NULL, or asked before each line, and after each tenth of a
 * second or less of virtual time in which something happens: true makes the replay pause (REPLAY_INTERRUPTED); it continues with
 * the next call. No file is read or written on behalf of a recording. */
enum replay_end replay_run(struct replay *replay, bool (*interrupted)(void *context), void *context);

/* Check all lines without obeying them, as far as they can be judged so. Likewise; a replay that was checked cannot be run. */
enum replay_end replay_check(struct replay *replay, bool (*interrupted)(void *context), void *context);

/* Why: "unit 1, motor 2: …". Never NULL. */
const char *replay_text(const struct replay *replay);

/* What was strange about the file without being wrong: its last line is incomplete, …; NULL: nothing. */
const char *replay_note(const struct replay *replay);

/* NULL: there is none. */
const struct replay_difference *replay_difference(const struct replay *replay);
struct replay_counts replay_counts(const struct replay *replay);

void replay_free(struct replay *replay);

/* The other parts that rooms above use. */
#include "snapshot.h"

#endif
