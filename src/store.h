/* SPDX-License-Identifier: MIT */
/* store.h: the flash slots of the four motors (U5, P6; bytes: docs/SPEC.md, "Flash"). */
#ifndef RKM04_SRC_STORE_H
#define RKM04_SRC_STORE_H

#include <rkm04/unit.h>

/* Write the whole program in memory to the slot of motor 1..4, as the new generation; the old one stays whole until the
 * new one is. The record is read back before it counts. An empty program empties the slot.
 * Returns 0, or 1 if the flash failed (the old generation then stays valid). */
int store_save(const struct rkm04_port *port, void *context, unsigned motor, const struct rkm04_program *program);

/* Read the slot of motor 1..4 into `program`, which is cleared first. Returns what was found; unless that is
 * RKM04_SLOT_LOADED the program is empty. */
enum rkm04_slot store_load(const struct rkm04_port *port, void *context, unsigned motor, struct rkm04_program *program);

#endif
