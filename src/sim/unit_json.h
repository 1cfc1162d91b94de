/* SPDX-License-Identifier: MIT */
/* unit_json.h: everything that a unit knows of itself, as JSON: what state_json() gives, and more (docs/CONTROL.md, `state`). */
#ifndef RKM04_SIM_UNIT_JSON_H
#define RKM04_SIM_UNIT_JSON_H

#include <jansson.h>
#include <stdint.h>

#include <rkm04/unit.h>

/* Everything that a unit itself knows, at `tick` of the bus: state_json(), more of each motor (with `true_position` null, a place
 * for what the plant knows), node, simulation, counters. Returns a new reference, or NULL if memory is short. */
json_t *unit_json(const struct rkm04_unit *unit, uint64_t tick);

/* What motor 1..4 of `unit` waits for, in words. Returns a new reference: a string, or JSON null if it waits for nothing; NULL:
 * memory is short. */
json_t *waits_for_json(const struct rkm04_unit *unit, unsigned motor);

/* The label 1..80 that a jump or call of a motor waits for (C7); 0: it does not. */
unsigned unit_awaited_label(const struct rkm04_motor *motor);

#endif
