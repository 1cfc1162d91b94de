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

/* What --help says of an option: `text`, or what is so on this system. NULL: it has nothing for the option. `name`: without the
 * dashes. */
const char *serve_option_text(const char *name, const char *text);

/* For --help: what ends the emulator; examples, a line each. */
extern const char serve_ended_by[], serve_examples[];

/* See that there are descriptors for all that the options ask for, and for clients. Nothing has been opened yet. Returns false
 * if there are too few (reported). */
bool serve_allow_files(const struct bus_options *options);

#endif
