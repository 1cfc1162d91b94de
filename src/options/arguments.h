/* SPDX-License-Identifier: MIT */
/* arguments.h: reading a command line, with an end for --help and --version that reports whether they could be printed. */
#ifndef RKM04_OPTIONS_ARGUMENTS_H
#define RKM04_OPTIONS_ARGUMENTS_H

#include <argp.h>

/* argp_parse() without flags. Where it ends the program after printing on stdout (--help, --usage, --version), the exit status is
 * 1, and the reason is on stderr, if that could not be written. Where it ends the program because of a wrong command line,
 * characters in it that cannot be seen are named, and for an option that there is not the nearest one is proposed. */
void arguments_parse(const struct argp *argp, int argc, char **argv, void *input);

/* What is wrong with the command line has been reported, with the characters in it that cannot be seen: arguments_parse() adds
 * nothing. */
void arguments_reported(void);

/* Write out what was printed on stdout. Returns 0, or 1 if that did not work (reported). */
int arguments_printed(void);

#endif
