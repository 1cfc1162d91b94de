/* SPDX-License-Identifier: MIT */
/* text_rig.h: texts of a CNC872 for tests: what reading one reports, as lines "LINE:COLUMN: TEXT". */
#ifndef TESTS_CNC872_TEXT_RIG_H
#define TESTS_CNC872_TEXT_RIG_H

#include <stdbool.h>
#include <stddef.h>

#include "cnc872/config.h"
#include "cnc872/nc.h"

extern char text_reported[8192];

/* A cnc_text_report that appends to text_reported. */
void text_report(void *context, const struct cnc_text_error *error);

/* The same text where reading beyond its end crashes: without a final 0, before memory that is not there. Valid until the next
 * call. */
const char *text_before_hole(const char *text, size_t length);

/* Read a configuration; text_reported has its errors afterwards. */
bool text_read_config(const char *text, struct cnc_config *config);

/* Read an NC program for this configuration. The program lies in memory that the next call uses again. */
bool text_read_nc(const char *text, const struct cnc_config *config, struct cnc_nc_program *program);

#endif
