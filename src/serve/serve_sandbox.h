/* SPDX-License-Identifier: MIT */
/* serve_sandbox.h: what `rkm04 serve` keeps for itself when it is ready (sandbox.h). */
#ifndef RKM04_SERVE_SANDBOX_H
#define RKM04_SERVE_SANDBOX_H

#include "bus/bus.h"

/* Keep the folders of all files that are named on the command line, those of --allow-folder, and the working directory unless it
 * is / or the user's home; of other files those that are open. To be called before threads are started: they inherit it.
 * control: path of the control socket; NULL: none. */
void serve_sandbox_files(const struct bus_options *options, struct bus *const *buses, const char *control);

/* Keep the system calls of a running emulator. To be called when all threads are there. */
void serve_sandbox_calls(const struct bus_options *options);

#endif
