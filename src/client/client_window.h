/* SPDX-License-Identifier: MIT */
/* client_window.h: `rkmctl window': becomes the program rkm04-window (docs/WINDOW.md). */
#ifndef RKM04_CLIENT_WINDOW_H
#define RKM04_CLIENT_WINDOW_H

#include "text/text.h"

/* Run it with the arguments after the word `window', argv[1]. Returns only if that does not work (reported). */
enum exit_status client_window(char **argv);

#endif
