/* SPDX-License-Identifier: MIT */
/* process.h: what a program must not inherit from its starter. */
#ifndef RKM04_OPTIONS_PROCESS_H
#define RKM04_OPTIONS_PROCESS_H

#include <limits.h>
#include <stdbool.h>

/* The first thing in main(): standard streams that are closed become /dev/null, so that no file or device of ours takes their
 * numbers, and messages for people do not go there; SIGINT, SIGTERM and SIGHUP are let through, whatever the parent had blocked.
 * Ends the program with status 1 if there is no /dev/null. `argv`: what main() has, NULL after the last; on Windows, paths in it
 * have / instead of \ afterwards. */
void process_begin(char **argv);

/* Does the path begin at the root of the files, or of a drive? */
bool process_path_is_absolute(const char *path);

/* The program rkm04-window, which `rkmctl window' and `rkm04 serve --window' start: next to this one, or in libexec/rkm04 of the
 * place where it was installed. Returns false if it is in neither. */
bool process_find_window(char path[PATH_MAX]);

#endif
