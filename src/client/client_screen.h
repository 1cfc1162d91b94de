/* SPDX-License-Identifier: MIT */
/* client_screen.h: the terminal of `rkmctl watch`. src/windows has another one. */
#ifndef RKM04_CLIENT_SCREEN_H
#define RKM04_CLIENT_SCREEN_H

#include <stdbool.h>

#include "client_panel.h"

enum client_key { CLIENT_KEY_NONE, CLIENT_KEY_QUIT, CLIENT_KEY_NEXT, CLIENT_KEY_BEFORE, CLIENT_KEY_REDRAW };

/* Take the terminal over. Returns false if it cannot be used (reported). */
bool client_screen_open(void);
void client_screen_close(void);

/* Does it show nothing but ASCII? */
bool client_screen_is_plain(void);

/* Read its size in characters. Returns true if it has changed, or all has to be drawn again. */
bool client_screen_size(int *rows, int *columns);

void client_screen_draw(const struct panel *panel);

/* Wait up to `timeout_ms` for a key, or for bytes of the connection `fd`. Returns false if the terminal has gone, or the program
 * is to end. */
bool client_screen_wait(int fd, int timeout_ms);

/* The next key that has been pressed. */
enum client_key client_screen_key(void);

/* After the terminal is closed: end by the signal that has ended the program, if that was another one than SIGINT. */
void client_screen_raise(void);

#endif
