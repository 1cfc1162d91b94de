/* SPDX-License-Identifier: MIT */
/* event_filter.h: what a client subscribes to, from the parameters of `subscribe` (docs/CONTROL.md). */
#ifndef RKM04_TRACE_EVENT_FILTER_H
#define RKM04_TRACE_EVENT_FILTER_H

#include "command/command.h"

struct event_filter {
    uint32_t kinds;         /* WATCH_BIT()s */
    uint32_t motors, units; /* bit n: number n */
};

#define EVENT_CELLS_MAX 64u /* of a subscription */

/* Read `kinds`, `motor`, `unit`; what is left out means all, but with `cells` no other kind. Returns false: refused. */
bool event_filter_read(struct event_filter *filter, struct sim *sim, const json_t *params, struct refusal *refusal);

/* A watcher with this filter watches, also the cells of the parameters. Returns the answer, {t_us, subscription, cells: what they
 * are now}, a new reference; NULL: refused, and it does not watch. */
json_t *event_watch(struct sim *sim, struct watcher *watcher, const struct event_filter *filter, unsigned number,
                    const json_t *params, struct refusal *refusal);

/* Is this event, of one of `kinds`, wanted by `watcher`? Those of no motor or no unit always are, but cells only if it has named
 * them. */
bool event_filter_passes(const struct event_filter *filter, const struct sim *sim, const struct watcher *watcher,
                         const struct watch_event *event);

#endif
