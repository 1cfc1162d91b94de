/* SPDX-License-Identifier: MIT */
/* fault_apply.h: what fault.c does for the files of the kinds of faults, and they for it. Private to the room. */
#ifndef RKM04_FAULT_APPLY_H
#define RKM04_FAULT_APPLY_H

#include "fault.h"

/* An opportunity: does a fault of this kind act? Counts it. `direction`, `operation`: for kinds that have one, else 0. Returns it
 * (valid until the next call), or NULL. */
struct fault *fault_apply(struct faults *faults, enum fault_kind kind, unsigned unit, unsigned direction, unsigned operation);

/* The next random number. */
uint64_t faults_random(struct faults *faults);

/* A fault has done something to unit `unit` (0: the line): report it. */
void fault_report(const struct faults *faults, const struct fault *fault, unsigned unit, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* The hooks of a bus with faults; their context is the faults. fault_line.c */
extern const struct segment_hooks faults_hooks;

#endif
