/* SPDX-License-Identifier: MIT */
/* window_folder.h: the folder of the files that an emulator writes for a window. It lies beside the control socket: there the
 * emulator may write (docs/SECURITY.md). */
#ifndef RKM04_WINDOW_FOLDER_H
#define RKM04_WINDOW_FOLDER_H

#include <limits.h>
#include <stdbool.h>

/* Make it unless that has been done: `folder` is empty before. Returns false if that does not work. */
bool window_folder_make(char folder[PATH_MAX], const char *control);

/* Remove it with its files, if there is one. */
void window_folder_remove(char folder[PATH_MAX]);

#endif
