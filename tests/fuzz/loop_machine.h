/* SPDX-License-Identifier: MIT */
/* loop_machine.h: the machine under the event loop of `rkm04 serve`, as far as it could make a run depend on the moment: its
 * time, which continues when the caller says so and a little with every look at it; its timers, which are due by that time; its
 * files, which all lie in one temporary folder whatever their names; and the log, which is not read.
 *
 * It is in for uv_hrtime(), timerfd_*(), uv_timer_*(), for what opens files by names that clients give (linked with --wrap),
 * and for log.c. */
#ifndef RKM04_TESTS_LOOP_MACHINE_H
#define RKM04_TESTS_LOOP_MACHINE_H

#include <limits.h>
#include <stdbool.h>
#include <stdint.h>

/* Time begins; every look at it takes `look` ns. */
void machine_begin(uint64_t look);

/* No timer is left. Files that were made are gone. */
void machine_end(void);

uint64_t machine_now(void);
void machine_pass(uint64_t ns);
unsigned machine_looks(void); /* since the beginning */

/* Let timers that are due go off. Returns true if one did. */
bool machine_ring(void);

/* `name` in the temporary folder. */
void machine_path(char path[PATH_MAX], const char *name);

#endif
