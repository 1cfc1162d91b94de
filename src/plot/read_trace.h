/* SPDX-License-Identifier: MIT */
/* read_trace.h: fills curves from a trace as CSV (docs/TRACES.md): of one unit. */
#ifndef RKM04_PLOT_READ_TRACE_H
#define RKM04_PLOT_READ_TRACE_H

#include <stdbool.h>
#include <stdio.h>

#include "curves.h"

/* Read the trace `in`; errors are reported on `errors` as NAME:LINE:COLUMN: error: expected …. `unit`: the name of the unit that
 * is meant, as in "3"; NULL: the only one. Returns false if it is wrong. */
bool plot_read_trace(struct plot_curves *curves, const char *name, FILE *in, const char *unit, FILE *errors);

#endif
