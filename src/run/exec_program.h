/* SPDX-License-Identifier: MIT */
/* exec_program.h: the arguments [M=]FILE of `rkm04 exec`, and the texts they name. */
#ifndef RKM04_RUN_EXEC_PROGRAM_H
#define RKM04_RUN_EXEC_PROGRAM_H

#include <stdbool.h>

#include "text/text.h"

/* A file of the command line. */
struct exec_file {
    const char *name; /* for messages: as given, "<stdin>" for "-" */
    struct program_text text;
};

/* Read the file `path`, "-" for standard input. A failure is reported on stderr.
 * Returns true if it worked; program_text_free() is due in any case. `path` must stay. */
bool exec_file_read(struct exec_file *file, const char *path);

/* Take an argument [M=]FILE apart; M is a motor 0..4, 1 if it is missing. *path points into `argument`.
 * Returns false if M is a number but not a motor. */
bool exec_program_argument(const char *argument, char *motor, const char **path);

#endif
