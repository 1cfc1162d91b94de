/* SPDX-License-Identifier: MIT */
/* readings_option.h: the option --readings, for those subcommands that have units. */
#ifndef RKM04_OPTIONS_READINGS_OPTION_H
#define RKM04_OPTIONS_READINGS_OPTION_H

#include <argp.h>

#include "text/text.h"

/* Read a value of --readings into *readings; *named are those that were given before. `list' prints the table and ends the
 * program with status 0; what is wrong ends it with a usage error. */
void readings_option_read(struct rkm04_readings *readings, readings_set *named, const char *text, struct argp_state *state);

#endif
