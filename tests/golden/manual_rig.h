/* SPDX-License-Identifier: MIT */
/* manual_rig.h: what the tests of the manual's example programs share: one unit, and its motions accounted for one by one. */
#ifndef RKM04_TESTS_MANUAL_RIG_H
#define RKM04_TESTS_MANUAL_RIG_H

#include "core/rig.h"

extern struct rig rig;
extern size_t seen; /* motions of motor 1 that a test has accounted for */

/* Fixture: a unit just powered up; nothing left behind. */
void setup(void);
void teardown(void);

/* The next motion of motor 1 began in this slot, at S100 A2000. Returns the slot of the command after it. */
uint64_t moved(uint64_t slot, uint64_t v, size_t steps, bool forward);

/* The program is at its end, there were no other motions, and the counter shows this. */
void expect_rest(int32_t position);

#endif
