/* SPDX-License-Identifier: MIT */
/* serve_report.h: what `rkm04 serve` reports at its beginning and end. */
#ifndef RKM04_SERVE_REPORT_H
#define RKM04_SERVE_REPORT_H

#include "bus/bus.h"
#include "control/control.h"

/* Which unit has which address, and what was found in flash, for the log. */
void serve_report_start(const struct bus_options *options, struct bus *const *buses);

/* What READY says, as it is now. Returns a new reference; NULL: out of memory. */
json_t *serve_report_json(const struct bus_options *options, struct bus *const *buses, const struct control *control);

/* The READY line on stdout, on --ready-fd and to the service manager. Returns false if it could not be written (reported). */
bool serve_report_ready(const struct bus_options *options, struct bus *const *buses, const struct control *control);

/* Counters of a line, for the log. */
void serve_report_end(struct bus *bus);

#endif
