/* SPDX-License-Identifier: MIT */
/* cib_story.h: random sessions with a CIB module, and digests of what it does. The number of a story makes it, the same on every
 * machine. Needs nothing but the cores and a compiler. */
#ifndef RKM04_TESTS_DIGEST_CIB_STORY_H
#define RKM04_TESTS_DIGEST_CIB_STORY_H

#include "cib/cib.h"

/* How time passes between two acts of a story. It makes no difference. */
enum cib_cut { CIB_CUT_NONE, CIB_CUT_EVENTS, CIB_CUT_RANDOM };

/* What the port takes. */
enum cib_seen { CIB_SEEN_ALL, CIB_SEEN_STEPS, CIB_SEEN_REPORTS };

/* What a story did. */
struct cib_digest {
    uint64_t drive[CIB_DRIVES]; /* pulses and events of each, with their ticks */
    uint64_t unit;              /* other events */
    uint64_t outputs;           /* 0 unless all is seen */
    uint64_t end;               /* every register and what is due at the end */
    uint32_t pulses, edges;
};

void cib_story(unsigned number, enum cib_cut cut, enum cib_seen seen, struct cib_digest *digest);

#define CIB_STORIES 300

#endif
