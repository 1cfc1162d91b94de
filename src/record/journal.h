/* SPDX-License-Identifier: MIT */
/* journal.h: what has come in, in memory, in the form of a recording, for snapshots to files. Coming back to a snapshot takes the
 * journal back, too: so it holds what led to the present state and nothing else. */
#ifndef RKM04_RECORD_JOURNAL_H
#define RKM04_RECORD_JOURNAL_H

#include <stdio.h>

#include "sim/sim.h"

struct journal;
struct journal_page; /* a piece of the past */

/* Begin with the line as it is, at tick 0. NULL: out of memory. */
struct journal *journal_begin(struct sim *sim);
void journal_free(struct journal *journal);

/* A journal in front of this one has been removed; `next` was in front of it. */
void journal_skip(struct journal *journal, const struct sim_journal *gone, const struct sim_journal *next);

/* The past up to now; to be given back. NULL: out of memory. */
struct journal_page *journal_mark(struct journal *journal);
void journal_page_free(struct journal_page *page);

/* The past is that page from now on, `later` ticks ago. page NULL: what the text of a recording contains (it is copied).
 * Returns false if out of memory: the past is unknown then. */
bool journal_turn(struct journal *journal, struct journal_page *page, const char *text, size_t length, uint64_t later);

/* Why the journal cannot be written: "…"; NULL: it can. */
const char *journal_gap(const struct journal *journal);

/* Write it all, up to the present tick. Returns false if that failed (errno). */
bool journal_write(struct journal *journal, FILE *out);

#endif
