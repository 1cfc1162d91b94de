/* SPDX-License-Identifier: MIT */
/* cib.c: the digest of the CIB module's core, a program of its own with the main_*.c of the RKM04's. */
#include "cib_story.h"
#include "digest.h"

#define LINE_MAX 100

void digest_run(void (*say)(const char *line))
{
    static struct cib_digest story;
    uint64_t all = 0, pulses = 0;
    for (unsigned number = 1; number <= CIB_STORIES; number++) {
        uint64_t digest = 0;
        char name[LINE_MAX] = "cib-";
        cib_story(number, CIB_CUT_NONE, (enum cib_seen)(number % 3), &story);
        const uint64_t lanes[] = {story.drive[0], story.drive[1], story.unit, story.outputs, story.end, story.edges};
        for (unsigned i = 0; i < sizeof lanes / sizeof *lanes; i++)
            mix(&digest, lanes[i]);
        mix(&all, digest);
        pulses += story.pulses;
        append_number(name, sizeof name, number);
        digest_line(say, name, digest, story.pulses);
    }
    digest_line(say, "all", all, pulses);
}
