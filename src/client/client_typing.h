/* SPDX-License-Identifier: MIT */
/* client_typing.h: lines that a person types, and commands in processes of their own. src/windows has another one. */
#ifndef RKM04_CLIENT_TYPING_H
#define RKM04_CLIENT_TYPING_H

#include "options/options.h"

/* Begin to read lines; Ctrl-C ends a command and not this program. name(line, start, i), from i = 0 until NULL: the names with
 * which Tab completes the word of the line that begins at `start`; if there are none, Tab takes those of files. */
void client_typing_begin(const char *(*name)(const char *line, int start, unsigned i));

/* Read a line, without its end. Returns a string to be freed; NULL: there are no more. */
char *client_typing_read(const char *prompt);

/* Keep the history. */
void client_typing_end(void);

/* Do a command line of rkmctl, argv[0] its name, by `run` in a process of its own. Returns its exit status. */
enum exit_status client_typing_run(int (*run)(int argc, char **argv), int argc, char **argv);

#endif
