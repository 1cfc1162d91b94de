/* SPDX-License-Identifier: MIT */
/* event_json.h: an event of a line (watch.h) as members of a JSON object, for traces and for clients of the control socket:
 *
 *     "t_us":14000,"kind":"step","unit":"3","motor":1,"value":1
 *
 * docs/CONTROL.md lists the kinds, their values and further members. */
#ifndef RKM04_TRACE_EVENT_JSON_H
#define RKM04_TRACE_EVENT_JSON_H

#include <stddef.h>

#include "sim/sim.h"

/* Characters that event_json() may write at most for this event. */
size_t event_json_room(const struct watch_event *event);

/* Write the members at `at`, where there are event_json_room() characters. No braces around them, no terminating zero. Returns
 * where they end. */
char *event_json(char *at, const struct sim *sim, const struct watch_event *event);

/* The time of an event in us, with three decimals if the device counts finer. Writes at most EVENT_TIME_MAX characters at `at`;
 * returns their end. */
#define EVENT_TIME_MAX 24u
char *event_time(char *at, const struct sim *sim, const struct watch_event *event);

#endif
