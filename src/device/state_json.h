/* SPDX-License-Identifier: MIT */
/* state_json.h: the state of a unit as JSON. */
#ifndef RKM04_HOST_STATE_JSON_H
#define RKM04_HOST_STATE_JSON_H

#include <jansson.h>
#include <stdint.h>

#include <rkm04/unit.h>

/* The state as an object:
 *
 *     t_us      `tick`
 *     motors    a list of {motor, position, state, index, led, fault}; fault is null where there is none
 *     di do var masks, the first input, output, variable in bit 0
 *
 * Returns a new reference, or NULL if memory is short. */
json_t *state_json(const struct rkm04_unit *unit, uint64_t tick);

#endif
