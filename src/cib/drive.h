/* SPDX-License-Identifier: MIT */
/* drive.h: one stepper drive: its commands, its motion, MCSTAT (sections 5 and 6 of docs/CIB.md). */
#ifndef RKM04_CIB_DRIVE_H
#define RKM04_CIB_DRIVE_H

#include "cib.h"

/* Power-up or APPLY at unit->now (BU8): at rest, position 0, before row 1, the configured values. Its registers stay. */
void drive_reset(struct cib_unit *unit, struct cib_drive *drive);

/* Take the command in the registers at unit->now (BC2, BC3). */
void drive_take(struct cib_unit *unit, struct cib_drive *drive);

/* Do what waits for the slot `tick` (BK3), or stop because no request came (BC9). */
void drive_do_slot(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick);

/* The first slot at or after a tick (BK2). */
uint64_t drive_slot_from(uint64_t tick);

/* Does it brake to stop, or to turn? It has to move. */
bool drive_is_stopping(const struct cib_drive *drive);
bool drive_is_turning(const struct cib_drive *drive);

/* Send the pulses due up to and including `limit`. Returns false after one that led to something: then
 * what is due may have changed, and pulses are left. */
bool drive_run(struct cib_unit *unit, struct cib_drive *drive, uint64_t limit);

/* Tick of the next pulse, or of a change of slope; CIB_NEVER: none. */
uint64_t drive_next_pulse(const struct cib_drive *drive);

/* The same, but pulses that the port does not see do not count. */
uint64_t drive_next_report(const struct cib_unit *unit, const struct cib_drive *drive);

/* Tick at which something else is due: INVEL, outputs switched off, the slot of a command; CIB_NEVER: nothing. */
uint64_t drive_next_due(const struct cib_drive *drive);

/* Do what is due at `tick`, but for the slot. */
void drive_do_due(struct cib_unit *unit, struct cib_drive *drive, uint64_t tick);

#endif
