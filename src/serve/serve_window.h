/* SPDX-License-Identifier: MIT */
/* serve_window.h: --window: the program rkm04-window beside the units (docs/WINDOW.md). It is started before rights are given up,
 * begins to serve when the units are ready, and ends with this process. */
#ifndef RKM04_SERVE_WINDOW_H
#define RKM04_SERVE_WINDOW_H

#include <stdbool.h>

/* Start it for the emulator with this control socket, at ADDRESS:PORT. It waits for serve_window_show(), and ends when the
 * descriptor returned is closed. Returns -1 if it cannot be started (reported). */
int serve_window_start(const char *control, const char *address);

/* Let it print its address and serve. */
void serve_window_show(int descriptor);

#endif
