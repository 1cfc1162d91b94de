/* SPDX-License-Identifier: MIT */
/* serve_process.h: what `rkm04 serve' asks of the system for its process. */
#ifndef RKM04_SERVE_PROCESS_H
#define RKM04_SERVE_PROCESS_H

#include <stdbool.h>

#include "bus/bus.h"

#define SERVE_SIGNALS 3u

/* Signals that end the emulator. */
extern const int serve_signals[SERVE_SIGNALS];

/* Does it end the emulator here? Not SIGHUP under nohup. */
bool serve_signal_ends(int number);

/* What it is called in the log. */
const char *serve_signal_name(int number);

/* Has the system what an option of `rkm04 serve' needs? `name`: without the dashes. */
bool serve_has_option(const char *name);

/* See that there are descriptors for all that the options ask for, and for clients. Nothing has been opened yet. Returns false
 * if there are too few (reported). */
bool serve_allow_files(const struct bus_options *options);

#endif
