/* SPDX-License-Identifier: MIT */
/* replay_inside.h: what the parts of a replay share. replay_read.c reads lines, replay_head.c powers the line up, replay.c does
 * what they say, replay_compare.c compares what goes out. */
#ifndef RKM04_RECORD_REPLAY_INSIDE_H
#define RKM04_RECORD_REPLAY_INSIDE_H

#include "record.h"
#include "tally.h"

#define REPLAY_DEPTH_MAX 8u /* records within records */

struct replay_span {
    uint64_t tick;
    unsigned unit, motor;
    struct tally_stream stream;
};

struct replay {
    const char *name;
    FILE *in;
    unsigned depth;             /* records around this one */
    struct sim *sim;
    bool begun;                 /* the head is right: sim is powered up */
    uint8_t *flash;             /* of all units, inverted */
    const struct device_kind *device; /* of the head */
    json_t *settings;           /* of the units, as the head has them */
    char *program;
    uint64_t until;
    bool (*interrupted)(void *context);
    void *context;
    bool paused;                /* interrupted() returned true: the present line is executed again when the replay continues */
    uint64_t checked;           /* tick of the last line that was checked */

    /* The present line. */
    char *line;
    size_t length, room;
    bool again;                 /* it is to be read once more */
    json_t *json;
    uint8_t *hex;               /* bytes of a value of it */
    char *embedded;             /* the recording for the restore that follows; NULL: none */
    size_t embedded_length;
    struct restore *inner;      /* that restore, while it continues */

    /* What has gone out and was not compared yet, in the order of time. */
    bool outputs;               /* it is compared at all */
    struct tally tally;
    size_t bytes_at, bytes_count, bytes_room, spans_at, spans_count, spans_room;
    struct tally_byte *bytes;
    struct replay_span *spans;

    enum replay_end end;
    bool ended;                 /* for whatever reason */
    bool differs;
    struct replay_difference difference;
    struct replay_counts counts;
    char text[800], note[200];
};

/* As replay_open(), for a recording within `depth` others. */
struct replay *replay_open_within(const char *name, FILE *in, unsigned depth);

/* ---- replay_read.c ---------------------------------------------------------------------------------------------------- */

/* Read the next line into replay->json. Returns false at the end of the file, or if it is wrong (replay->ended). */
bool replay_next_line(struct replay *replay);

/* Read so many lines as they are into replay->embedded. */
bool replay_read_embedded(struct replay *replay, uint64_t lines);

/* The file is wrong, at the value of `key` in the present line (NULL: at its beginning). Always returns false. */
bool replay_wrong(struct replay *replay, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Memory is short. Always returns false. */
bool replay_no_memory(struct replay *replay);

/* Values of the present line. Returns false: wrong. `missing`: what stands for one that is not there; DEVICE_NEVER: it must
 * be. */
bool replay_number(struct replay *replay, const char *key, uint64_t low, uint64_t high, uint64_t missing, uint64_t *value);
bool replay_flag(struct replay *replay, const char *key, bool missing, bool *value);
const char *replay_string(struct replay *replay, const char *key); /* NULL: wrong */

/* Read "hex" into a buffer that lives until the next call; at least one byte. Returns NULL: wrong. */
const uint8_t *replay_bytes(struct replay *replay, const char *key, size_t most, size_t *length);

/* "name", or "name_hex" if that is there, as a string to be freed. *text is NULL if neither is. Returns false: wrong. */
bool replay_text_of(struct replay *replay, const char *name, size_t most, char **text);

/* Are all keys of the present line among these (ends with NULL)? */
bool replay_keys(struct replay *replay, const char *const *names);

/* ---- replay_head.c ---------------------------------------------------------------------------------------------------- */

/* Read the head and the flash images, and power the line up. */
bool replay_begin(struct replay *replay);

/* ---- replay_compare.c ------------------------------------------------------------------------------------------------- */

void replay_begin_compare(struct replay *replay);
void replay_end_compare(struct replay *replay);

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
