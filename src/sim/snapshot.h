/* SPDX-License-Identifier: MIT */
/* snapshot.h: the line as it stands, to come back to: units, bytes under way, inputs, flash, plant, faults.
 *
 * Coming back does not turn the line's time back: ticks go on, and everything that has a time is moved along, so that what
 * follows is what followed then, later by the difference. Only what was taken of another line at a later tick takes the time
 * along: the line's time leaps to that tick. */
#ifndef RKM04_SIM_SNAPSHOT_H
#define RKM04_SIM_SNAPSHOT_H

#include "sim.h"

struct snapshot;

/* Returns NULL if memory is short, or a flash image cannot be read. */
struct snapshot *snapshot_take(struct sim *sim);

/* Make `sim` as it was. It must be like the one it was taken of (snapshot_misfit()). Returns false if memory is short or a flash
 * image cannot be written: then nothing is changed but what flash shows. */
bool snapshot_put(struct sim *sim, const struct snapshot *snapshot);

/* Move everything that has a time along by `ticks`: the line's time leaps ahead, and nothing happens meanwhile. Returns false if
 * memory is short. */
bool snapshot_move(struct sim *sim, uint64_t ticks);

/* In what is `sim` unlike the one that it was taken of: "the framing", …; NULL: in nothing that matters. */
const char *snapshot_misfit(const struct sim *sim, const struct snapshot *snapshot);

/* The tick at which it was taken. */
uint64_t snapshot_tick(const struct snapshot *snapshot);

void snapshot_free(struct snapshot *snapshot);

/* The named ones of a sim, and its journal. */
void snapshots_free(struct sim_snapshots *snapshots);

/* Keep in memory all that comes in, so that commands can write snapshots to files. To be called at tick 0, when the plant is
 * there and before anything has come in. Returns false if memory is short. */
bool snapshots_keep_journal(struct sim *sim);

#endif
