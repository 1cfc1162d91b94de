/* SPDX-License-Identifier: MIT */
/* fuzz_stimulus.c: any bytes as a stimulus file of `rkm04 exec`: refused with as many lines as there are errors, or entries in
 * the order of time. */
#include <string.h>

#include "fuzz.h"
#include "run/stimulus.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct stimuli stimuli = {0};
    char *said = NULL;
    size_t length, lines = 0;
    FILE *errors = open_memstream(&said, &length);
    int count = stimuli_read(&stimuli, &rkm04_device, "file", (const char *)data, size, errors);
    fclose(errors);
    for (size_t i = 0; i < length; i++)
        lines += said[i] == '\n';
    FUZZ_CHECK(count >= 0 && lines == (size_t)count, "%d errors, %zu lines: %s", count, lines, said);
    for (size_t i = 0; count == 0 && i < stimuli.count; i++)
        FUZZ_CHECK(i == 0 || stimuli.list[i].tick >= stimuli.list[i - 1].tick, "entry %zu", i);
    stimuli_free(&stimuli);
    free(said);
    return 0;
}
