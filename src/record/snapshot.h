/* SPDX-License-Identifier: MIT */
/* snapshot.h: the line as it is, to come back to: units, bytes under way, inputs, flash, plant, faults.
 *
 * Coming back does not turn the time of the bus back: ticks continue, and everything that has a time is moved along, so that what
 * follows is what followed then, later by the difference. Only what was taken of another line at a later tick takes the time
 * along: the time of the bus leaps to that tick. */
#ifndef RKM04_RECORD_SNAPSHOT_H
#define RKM04_RECORD_SNAPSHOT_H

#include "sim/sim.h"

struct snapshot;

/* Returns NULL if out of memory, or a flash image cannot be read. */
struct snapshot *snapshot_take(struct sim *sim);

/* Make `sim` as it was. It must be like the one it was taken of (snapshot_misfit()). Returns false if out of memory or a flash
 * image cannot be written: then nothing is changed but what flash shows. */
bool snapshot_restore(struct sim *sim, const struct snapshot *snapshot);

/* Move everything that has a time along by `ticks`: the time of the bus leaps ahead, and nothing happens meanwhile. Returns
 * false if out of memory. */
bool snapshot_move(struct sim *sim, uint64_t ticks);

/* In what is `sim` unlike another, but for what a command may change: "the framing", …; NULL: in nothing that matters. */
const char *snapshot_difference(const struct sim *sim, const struct sim *other);

/* In what is `sim` unlike the one that it was taken of: "the framing", …; NULL: in nothing that matters. */
const char *snapshot_misfit(const struct sim *sim, const struct snapshot *snapshot);

/* The tick at which it was taken. */
uint64_t snapshot_tick(const struct snapshot *snapshot);

void snapshot_free(struct snapshot *snapshot);

/* ---- The command `restore` with a file, in pieces ---------------------------------------------------------------------- */

#define RESTORE_SECONDS 60u /* of real time: what restoring a file may take unless `timeout` says otherwise */

struct restore;
struct refusal; /* command.h */

/* Read the file, and check that it fits. params: as of the command `restore`, with `file`. The sim may continue and change until
 * the end. Returns NULL: refused. */
struct restore *restore_begin(struct sim *sim, const json_t *params, struct refusal *refusal);

/* Check and replay the file until `interrupted` says so, which is checked as in replay_run(). Returns false if it is to go
 * on. */
bool restore_go_on(struct restore *restore, bool (*interrupted)(void *context), void *context);

/* What it may take, us of real time; it took longer: restore_end() will refuse it. */
uint64_t restore_timeout(const struct restore *restore);
void restore_is_late(struct restore *restore);

/* It has come to its end: execute the command at the present tick. Returns its result; NULL: refused. Frees it. */
json_t *restore_end(struct restore *restore, struct refusal *refusal);

/* Give it up: nothing has changed. NULL: nothing. */
void restore_cancel(struct restore *restore);

/* ---- What a sim has ------------------------------------------------------------------------------------------------------ */

/* Attach the commands snapshot and restore. After sim_begin(). Its snapshots are freed at sim_end(). Returns false if
 * there is no place for the table (command_attach()). */
bool snapshots_attach(struct sim *sim);

/* Keep in memory all that comes in, so that commands can write snapshots to files. To be called at tick 0, when the plant is
 * there and before anything has come in. Returns false if out of memory. */
bool snapshots_keep_journal(struct sim *sim);

#endif
