/* SPDX-License-Identifier: MIT */
/* unit_state.h: all that is known of a unit on a bus, as JSON (docs/CONTROL.md, `state`). Private. */
#ifndef RKM04_COMMAND_UNIT_STATE_H
#define RKM04_COMMAND_UNIT_STATE_H

#include <jansson.h>

struct sim;

/* Of unit `number`, at the present tick. Returns a new reference, or NULL if out of memory. */
json_t *unit_state(struct sim *sim, unsigned number);

#endif
