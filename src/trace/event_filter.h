/* SPDX-License-Identifier: MIT */
/* event_filter.h: which events a client wants, from the parameters of `subscribe` (docs/CONTROL.md). */
#ifndef RKM04_TRACE_EVENT_FILTER_H
#define RKM04_TRACE_EVENT_FILTER_H

#include "command/command.h"

struct event_filter {
    uint32_t kinds;         /* WATCH_BIT()s */
    uint32_t motors, units; /* bit n: number n */
};

/* Read `kinds`, `motor`, `unit`; what is left out means all. Returns false: refused. */
bool event_filter_read(struct event_filter *filter, struct sim *sim, const json_t *params, struct refusal *refusal);

/* Is this event, of one of `kinds`, wanted? Those of no motor or no unit always are. */
bool event_filter_passes(const struct event_filter *filter, const struct watch_event *event);

#endif
