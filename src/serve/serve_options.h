/* SPDX-License-Identifier: MIT */
/* serve_options.h: the options of `rkm04 serve`, read from the command line. */
#ifndef RKM04_SERVE_OPTIONS_H
#define RKM04_SERVE_OPTIONS_H

#include "bus/bus.h"

/* Read the command line. The strings of *options point into argv. Ends the program itself after --help, --version (status 0)
 * and wrong usage (status 2, with what was expected on stderr). */
void serve_options_read(struct bus_options *options, int argc, char **argv);

#endif
