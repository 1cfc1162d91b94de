/* SPDX-License-Identifier: MIT */
/* serve_checks.h: options of `rkm04 serve` that do not fit the device, or one another: usage errors. For serve_options.c. */
#ifndef RKM04_SERVE_CHECKS_H
#define RKM04_SERVE_CHECKS_H

#include <argp.h>

#include "bus/bus.h"

#define SERVE_NO_BAUD UINT32_MAX       /* --baud is not given */
#define SERVE_NO_TURNAROUND UINT32_MAX /* --turnaround is not given */

/* What is about a bus is refused by a device that has none. Before anything is filled in that was not given. */
void serve_check_bus(const struct bus_options *options, const struct argp_state *state);

/* --backup is --flash by the name that the flash of the device has. */
void serve_check_flash(struct bus_options *options, struct argp_state *state);

/* A file for each line needs a name for each. */
void serve_check_patterns(const struct bus_options *options, struct argp_state *state);

#endif
