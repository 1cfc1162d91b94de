/* record.h: a record of a session: the configuration, everything that came in from outside with its tick, and what went out:
 * answers as they are, pulses and outputs as running digests. `rkm04 replay` does it again and names the first difference.
 * docs/RECORD.md describes the file: JSON, one object a line. */
#ifndef RKM04_SIM_RECORD_H
#define RKM04_SIM_RECORD_H

#include <stdio.h>

#include "sim.h"

struct record;

/* Begin to take down what comes in and goes out, on `out`, which stays the caller's. To be called at tick 0, before anything has
 * come in. Returns NULL if memory is short. */
struct record *record_begin(struct sim *sim, FILE *out);

/* End: write the last digests, and flush. Returns 0 or the errno of the first failure. Frees the record. */
int record_end(struct record *record);

/* Everything that could not be written so far is (nothing is lost if the process is killed). */
void record_flush(struct record *record);

struct replay;

/* What became of a replay. */
enum replay_end {
    REPLAY_SAME,      /* everything went out as recorded */
    REPLAY_DIFFERENT, /* it did not: replay_text() says where and how */
    REPLAY_WRONG,     /* the file is no record or damaged: replay_text() says line, column, what was expected */
    REPLAY_NO_MEMORY
};

/* Read the head of a record and power up a sim like the one recorded. NULL: memory is short; otherwise replay_sim() is NULL if
 * the file is wrong. `in` must stay open until replay_free(). */
struct replay *replay_open(const char *name, FILE *in);
struct sim *replay_sim(struct replay *replay);

/* Do it all. Traces may have joined the sim before. `interrupted`: NULL, or looked at now and then: true ends it. */
enum replay_end replay_run(struct replay *replay, bool (*interrupted)(void *context), void *context);

/* Why: "unit 1, motor 2: …". Never NULL. */
const char *replay_text(const struct replay *replay);

void replay_free(struct replay *replay);

#endif
