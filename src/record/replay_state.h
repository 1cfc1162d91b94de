/* SPDX-License-Identifier: MIT */
/* replay_state.h: a replay: its parts, into each of which one file writes, and how far it is, which replay.c keeps. */
#ifndef RKM04_RECORD_REPLAY_STATE_H
#define RKM04_RECORD_REPLAY_STATE_H

#include "record.h"
#include "replay_head.h"
#include "replay_lines.h"
#include "replay_outputs.h"
#include "replay_result.h"

#define REPLAY_DEPTH_MAX 8u /* recordings within recordings */

struct replay {
    struct replay_lines lines;     /* replay_read.c */
    struct replay_head head;       /* replay_head.c */
    struct replay_outputs outputs; /* replay_compare.c */
    struct replay_result result;   /* replay_result.c */

    unsigned depth;             /* recordings around this one */
    bool begun;                 /* the head is right: the bus is powered up */
    uint64_t until;
    bool (*interrupted)(void *context);
    void *context;
    bool paused;                /* interrupted() has returned true: the present line is executed again when the replay goes on */
    uint64_t checked;           /* tick of the last line that was checked */
    struct restore *inner;      /* the restore of an embedded recording, while it goes on */
    struct replay_counts counts; /* without lines and bytes_out */
};

/* As replay_open(), for a recording within `depth` others. */
struct replay *replay_open_within(const char *name, FILE *in, unsigned depth);

#endif
