/* SPDX-License-Identifier: MIT */
/* program_argument.h: the arguments [M=]FILE of those subcommands that take programs. */
#ifndef RKM04_OPTIONS_PROGRAM_ARGUMENT_H
#define RKM04_OPTIONS_PROGRAM_ARGUMENT_H

#include <stdbool.h>

/* Take an argument [M=]FILE apart; M is a motor 0..motors, 1 if it is missing. *path points into `argument`.
 * Returns false if M is a number but not a motor. */
bool program_argument_read(const char *argument, unsigned motors, unsigned *motor, const char **path);

#endif
