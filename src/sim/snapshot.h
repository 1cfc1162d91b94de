/* snapshot.h: the line as it stands, to come back to: units, bytes under way, inputs, flash, plant, faults.
 *
 * Coming back does not turn the line's time back: ticks go on, and everything that has a time is moved along, so that what
 * follows is what followed then, later by the difference. */
#ifndef RKM04_SIM_SNAPSHOT_H
#define RKM04_SIM_SNAPSHOT_H

#include "sim.h"

struct snapshot;

/* Returns NULL if memory is short, or a flash image cannot be read. */
struct snapshot *snapshot_take(struct sim *sim);

/* Make `sim` as it was. It must have the same units (snapshot_fits()). Returns false if memory is short or a flash image cannot
 * be written: then nothing is changed but what flash shows. */
bool snapshot_put(struct sim *sim, const struct snapshot *snapshot);

/* Has `sim` the same units, framing and timing as the one that it was taken of? */
bool snapshot_fits(const struct sim *sim, const struct snapshot *snapshot);

void snapshot_free(struct snapshot *snapshot);

/* The named ones of a sim. */
void snapshots_free(struct sim_snapshots *snapshots);

#endif
