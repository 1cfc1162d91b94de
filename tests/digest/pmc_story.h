/* SPDX-License-Identifier: MIT */
/* pmc_story.h: random sessions with a PMC, and digests of what it does. The number of a story makes it, the same on every
 * machine. Needs nothing but the cores and a compiler. */
#ifndef RKM04_TESTS_DIGEST_PMC_STORY_H
#define RKM04_TESTS_DIGEST_PMC_STORY_H

#include "pmc/pmc.h"

/* How time passes between two acts of a story, and whether pulses are seen. It makes no difference to what can be seen. */
enum pmc_way {
    PMC_WAY_AT_ONCE,
    PMC_WAY_IN_PIECES,
    PMC_WAY_BY_EVENTS, /* up to each next event, then a tick; reports before the event are counted as early */
    PMC_WAY_COPIED,    /* the unit is copied away and back all the time */
    PMC_WAY_UNSEEN,    /* the port takes no pulses */
    PMC_WAYS
};

/* What a story did. */
struct pmc_digest {
    uint64_t axis[PMC_AXES]; /* pulses, directions and events of each, with their ticks */
    uint64_t outputs, flash;
    uint64_t end;            /* what can be seen of the unit at its end, and what is due */
    uint32_t pulses, reports, early;
};

void pmc_story(unsigned number, enum pmc_way way, struct pmc_digest *digest);

#define PMC_STORIES 300

#endif
