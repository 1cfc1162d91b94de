/* SPDX-License-Identifier: MIT */
/* window_control.h: a connection to the control socket of an emulator, in the event loop (docs/CONTROL.md). */
#ifndef RKM04_WINDOW_CONTROL_H
#define RKM04_WINDOW_CONTROL_H

#include <stdbool.h>
#include <stddef.h>
#include <uv.h>

struct window_control;

struct window_control_calls {
    void (*line)(void *context, char *line, size_t length); /* a line has come, without its end, ended by 0 */
    void (*ended)(void *context);                           /* the emulator has gone; close the connection */
    void *context;
};

/* Connect. Returns NULL if that does not work: `trouble` says why. */
struct window_control *window_control_open(uv_loop_t *loop, const char *path, const struct window_control_calls *calls,
                                           char trouble[256]);

/* No call comes after that. NULL: nothing. */
void window_control_close(struct window_control *control);

/* Send a line; its end is added. */
void window_control_send(struct window_control *control, const char *text, size_t length);

#endif
