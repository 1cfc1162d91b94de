/* SPDX-License-Identifier: MIT */
/* pmc.c: the digest of the PMC's core, a program of its own with the main_*.c of the RKM04's. */
#include "digest.h"
#include "pmc_story.h"

#define LINE_MAX 100

void digest_run(void (*say)(const char *line))
{
    static struct pmc_digest story;
    uint64_t all = 0, pulses = 0;
    for (unsigned number = 1; number <= PMC_STORIES; number++) {
        uint64_t digest = 0;
        char name[LINE_MAX] = "pmc-";
        pmc_story(number, (enum pmc_way)(number % PMC_WAYS), &story);
        const uint64_t lanes[] = {story.axis[0], story.axis[1], story.outputs, story.flash, story.end};
        for (unsigned i = 0; i < sizeof lanes / sizeof *lanes; i++)
            mix(&digest, lanes[i]);
        mix(&all, digest);
        pulses += story.pulses;
        append_number(name, sizeof name, number);
        digest_line(say, name, digest, story.pulses);
    }
    digest_line(say, "all", all, pulses);
}
