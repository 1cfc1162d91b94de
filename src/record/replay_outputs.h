/* SPDX-License-Identifier: MIT */
/* replay_outputs.h: what goes out of the bus of a replay, compared with the recording. Only replay_compare.c writes into it. */
#ifndef RKM04_RECORD_REPLAY_OUTPUTS_H
#define RKM04_RECORD_REPLAY_OUTPUTS_H

#include "record.h"
#include "tally.h"

struct replay;

struct replay_span {
    uint64_t tick;
    unsigned unit, motor;
    struct tally_stream stream;
};

/* What has gone out and was not compared yet, in the order of time. */
struct replay_outputs {
    bool have_begun, are_compared;
    struct tally tally;
    uint64_t bytes_out; /* that have reached the host */
    size_t bytes_at, bytes_count, bytes_room, spans_at, spans_count, spans_room;
    struct tally_byte *bytes;
    struct replay_span *spans;
};

void replay_begin_compare(struct replay *replay);
void replay_end_compare(struct replay *replay);

/* End the comparison, too. Before replay_head_free(). */
void replay_outputs_free(struct replay *replay);

/* Collect what has gone out before the present tick; at it, too. */
void replay_collect_before_tick(struct replay *replay);
void replay_collect_all(struct replay *replay);

/* Is there anything before `tick` that the recording does not have? `bytes`: so many bytes may come. Returns false if there is: a
 * difference. */
bool replay_expect_nothing(struct replay *replay, uint64_t tick, size_t bytes);

/* Compare. Return false: a difference. */
bool replay_compare_bytes(struct replay *replay, uint64_t from, uint64_t until, const uint8_t *bytes, size_t length);
bool replay_compare_stream(struct replay *replay, const struct replay_span *recorded, bool partial);

/* At the end: streams that have changed since the last digest. */
bool replay_compare_rest(struct replay *replay);

/* A difference of another kind. Always returns false. */
bool replay_differs(struct replay *replay, const struct replay_difference *difference);

#endif
