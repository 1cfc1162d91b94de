/* SPDX-License-Identifier: MIT */
/* fuzz_record.c: any bytes as a record: wrong with a reason, or a replay that comes to an end. A record that is the same once
 * is the same again. */
#include <string.h>

#include "fuzz.h"
#include "record/record.h"

#define LOOKS_MAX 300 /* tenths of a second, at most, in which something happens */

static bool is_enough(void *context)
{
    unsigned *looks = context;
    return ++*looks > LOOKS_MAX;
}

static enum replay_end replay(const uint8_t *data, size_t size)
{
    unsigned looks = 0;
    FILE *in = fmemopen((void *)data, size, "r");
    struct replay *replay = replay_open("file.record", in);
    FUZZ_CHECK(replay != NULL, "no memory");
    enum replay_end end = replay_run(replay, is_enough, &looks);
    FUZZ_CHECK(end != REPLAY_NO_MEMORY, "no memory");
    FUZZ_CHECK(end == REPLAY_SAME || strlen(replay_text(replay)) > 0, "no reason");
    FUZZ_CHECK((end == REPLAY_DIFFERENT) == (replay_difference(replay) != NULL), "a difference");
    replay_free(replay);
    fclose(in);
    return end;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    if (size == 0)
        return 0;
    enum replay_end end = replay(data, size);
    FUZZ_CHECK(end != REPLAY_SAME || replay(data, size) == REPLAY_SAME, "not the same again");
    return 0;
}
