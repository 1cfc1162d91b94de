/* SPDX-License-Identifier: MIT */
/* replay_lines.h: the lines of a recording that is replayed, and their values. Only replay_read.c writes into it. */
#ifndef RKM04_RECORD_REPLAY_LINES_H
#define RKM04_RECORD_REPLAY_LINES_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

struct replay;

/* The present line. */
struct replay_lines {
    const char *name;           /* of the file, for messages */
    FILE *in;
    uint64_t count;             /* lines read so far */
    char *line;
    size_t length, room;
    bool again;                 /* it is to be read once more */
    json_t *json;
    uint8_t *hex;               /* bytes of a value of it */
    char *embedded;             /* the recording for the restore that follows; NULL: none */
    size_t embedded_length;
};

void replay_lines_begin(struct replay *replay, const char *name, FILE *in);
void replay_lines_free(struct replay *replay);

/* The next replay_next_line() returns the present line once more. */
void replay_return_line(struct replay *replay);

/* The embedded recording has been used. */
void replay_drop_embedded(struct replay *replay);

/* Read the next line into replay->lines.json. Returns false at the end of the file, or if it is wrong (replay->result.ended). */
bool replay_next_line(struct replay *replay);

/* Read so many lines as they are into replay->lines.embedded. */
bool replay_read_embedded(struct replay *replay, uint64_t lines);

/* The file is wrong, at the value of `key` in the present line (NULL: at its beginning). Always returns false. */
bool replay_wrong(struct replay *replay, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Memory is short. Always returns false. */
bool replay_no_memory(struct replay *replay);

/* Values of the present line. Returns false: wrong. `missing`: the value of one that is not there; DEVICE_NEVER: it must
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

#endif
