/* SPDX-License-Identifier: MIT */
/* check_mutator.c: are mutants of recordings recordings? Mutates the files given and replays the mutants: more than half must be
 * executed to their end or to a refusal by a command, and there must be some of each kind. */
#include <string.h>

#include "fuzz.h"
#include "record/record.h"

#define MUTANTS 300
#define MOST 4000u

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);

/* libFuzzer's, which this program is without: flips a bit. */
size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most)
{
    if (size > 0)
        data[most % size] ^= 1u;
    return size;
}

static bool is_enough(void *context)
{
    unsigned *looks = context;
    return ++*looks > 100;
}

int main(int count, char **paths)
{
    static const char *const names[] = {"same", "different", "wrong", "interrupted", "no memory"};
    unsigned ends[5] = {0}, all = 0;
    for (int i = 1; i < count; i++) {
        uint8_t first[MOST], data[MOST];
        FILE *in = fopen(paths[i], "rb");
        FUZZ_CHECK(in, "%s", paths[i]);
        size_t length = fread(first, 1, sizeof first, in), size = 0;
        fclose(in);
        for (unsigned seed = 0; seed < MUTANTS; seed++, all++) {
            unsigned looks = 0;
            memcpy(data, first, size = length);
            size = LLVMFuzzerCustomMutator(data, size, sizeof data, seed + 1000u * (unsigned)i);
            FUZZ_CHECK(size <= sizeof data && size > 0, "%zu bytes", size);
            in = fmemopen(data, size, "r");
            struct replay *replay = replay_open("mutant", in);
            FUZZ_CHECK(replay, "no memory");
            ends[replay_run(replay, is_enough, &looks)]++;
            replay_free(replay);
            fclose(in);
        }
    }
    for (unsigned i = 0; i < 5; i++)
        printf("%s: %u of %u\n", names[i], ends[i], all);
    unsigned obeyed = ends[REPLAY_SAME] + ends[REPLAY_INTERRUPTED] + ends[REPLAY_DIFFERENT];
    return obeyed > all / 2u && ends[REPLAY_SAME] > all / 4u && ends[REPLAY_WRONG] > 0 && ends[REPLAY_DIFFERENT] > 0 &&
           ends[REPLAY_NO_MEMORY] == 0 ? 0 : 1;
}
