/* SPDX-License-Identifier: MIT */
#ifndef RKM04_WINDOWS_ARGP_HELP_H
#define RKM04_WINDOWS_ARGP_HELP_H

#include <argp.h>
#include <stdbool.h>

/* Print what --help prints, or --usage, for a command line of these groups of options. */
void argp_help_print(const char *name, const struct argp *const *group, unsigned groups, bool usage);

#endif
