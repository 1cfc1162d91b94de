/* SPDX-License-Identifier: MIT */
/* snapshot_store.h: the named snapshots of a sim, and what commands and records have to know of one another. Inside. */
#ifndef RKM04_SIM_SNAPSHOT_STORE_H
#define RKM04_SIM_SNAPSHOT_STORE_H

#include "command.h"
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
    char *text;              /* the file that the restore being obeyed has read, for records; NULL: none */
    size_t length;
};

/* Make sim like the end of a record. `name` is for messages. Returns the result of the command; NULL: refused. */
json_t *restore_text(struct sim *sim, const char *name, const char *text, size_t length, unsigned depth, struct refusal *refusal);

#endif
