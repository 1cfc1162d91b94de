/* SPDX-License-Identifier: MIT */
/* snapshot_store.h: the named snapshots of a sim, and what commands and records have to know of one another. Inside. */
#ifndef RKM04_RECORD_SNAPSHOT_STORE_H
#define RKM04_RECORD_SNAPSHOT_STORE_H

#include "command/command.h"
#include "journal.h"
#include "snapshot.h"

#define SNAPSHOTS_MAX 64u
#define SNAPSHOT_NAME_MAX 64u

struct named_snapshot {
    char *name;
    struct snapshot *snapshot;
    struct journal_page *page; /* the journal up to there; NULL: none was kept */
};

struct sim_snapshots {
    struct sim *sim;
    struct journal *journal; /* NULL: none is kept */
    size_t count;
    struct named_snapshot named[SNAPSHOTS_MAX];
    char *text;              /* the file that the restore being executed has read, for records; NULL: none */
    size_t length;
};

/* The snapshots of a sim. NULL: out of memory. */
struct sim_snapshots *snapshots_of(struct sim *sim);

/* Keep the text, from malloc(), as the file of the present restore; NULL: there is none. */
void snapshots_keep_text(struct sim_snapshots *store, char *text, size_t length);

/* Put a snapshot, and turn the journal with it. Returns the result of the command; NULL: refused. */
json_t *snapshots_put(struct sim_snapshots *store, const struct snapshot *snapshot, struct journal_page *page,
                      struct refusal *refusal);

/* ---- restore.c: restoring a file ---------------------------------------------------------------------------------------- */

/* Begin to make a sim like the end of a record. `name` is for messages; it and the text stay the caller's. `depth`: records
 * around it. Returns NULL: refused. */
struct restore *restore_open(struct sim *sim, const char *name, const char *text, size_t length, unsigned depth,
                             struct refusal *refusal);

/* It has come to its end: put the sim into its state, if it is valid. Returns the result of the command; NULL: refused. Frees
 * it. */
json_t *restore_put(struct restore *restore, struct refusal *refusal);

/* All of it, as far as the timeout and the sim's interrupted() let it. Likewise. */
json_t *restore_at_once(struct restore *restore, struct refusal *refusal);

#endif
