/* SPDX-License-Identifier: MIT */
/* fuzz_record.c: any bytes as a record: wrong with a reason, or a replay that comes to an end. A record that is the same once
 * is the same again, and so is the record of its replay, in which all that went out is reported. */
#include <string.h>

#include "fuzz.h"
#include "record/record.h"

#define LOOKS_MAX 300 /* tenths of a second, at most, in which something happens */

static bool is_enough(void *context)
{
    unsigned *looks = context;
    return ++*looks > LOOKS_MAX;
}

/* Replay it; *copy, unless NULL: record what happens, too. */
static enum replay_end replay(const uint8_t *data, size_t size, FILE *copy)
{
    unsigned looks = 0;
    FILE *in = fmemopen((void *)data, size, "r");
    struct replay *replay = replay_open("file.record", in);
    FUZZ_CHECK(replay != NULL, "no memory");
    struct record *record = copy && replay_sim(replay) ? record_begin(replay_sim(replay), copy) : NULL;
    enum replay_end end = replay_run(replay, is_enough, &looks);
    FUZZ_CHECK(end != REPLAY_NO_MEMORY, "no memory");
    FUZZ_CHECK(end == REPLAY_SAME || strlen(replay_text(replay)) > 0, "no reason");
    FUZZ_CHECK((end == REPLAY_DIFFERENT) == (replay_difference(replay) != NULL), "a difference");
    if (record)
        FUZZ_CHECK(record_end(record) == 0, "no memory");
    replay_free(replay);
    fclose(in);
    return end;
}

/* A record cannot take down the content of snapshots only, and has no files. */
static bool can_be_copied(const uint8_t *data, size_t size)
{
    return !memmem(data, size, "moved", 5) && !memmem(data, size, "file", 4) && !memmem(data, size, "embedded", 8);
}

static void replay_copy(const uint8_t *data, size_t size)
{
    char *text = NULL;
    size_t length;
    FILE *copy = open_memstream(&text, &length);
    FUZZ_CHECK(copy, "no memory");
    enum replay_end end = replay(data, size, copy);
    fclose(copy);
    FUZZ_CHECK(end == REPLAY_SAME, "not the same again");
    end = replay((const uint8_t *)text, length, NULL);
    FUZZ_CHECK(end == REPLAY_SAME || end == REPLAY_INTERRUPTED, "the copy is not the same:\n%s", text);
    free(text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0 || replay(data, size, NULL) != REPLAY_SAME)
        return 0;
    if (can_be_copied(data, size))
        replay_copy(data, size);
    else
        FUZZ_CHECK(replay(data, size, NULL) == REPLAY_SAME, "not the same again");
    return 0;
}
