/* SPDX-License-Identifier: MIT */
/* window_server.h: HTTP and WebSocket: who may come in, the files of the page, downloads.
 *
 * A request is served if its Host is the address served (no other name that a page elsewhere might have for it), and if it has
 * the token: in the address (/?token=…), or as the cookie that is set with the page. A WebSocket must come from this page
 * (Origin). */
#ifndef RKM04_WINDOW_SERVER_H
#define RKM04_WINDOW_SERVER_H

#include <stdbool.h>

struct window;

/* Listen at ADDRESS:PORT. Fills in token and host. Returns false if that did not work (reported). */
bool window_server_begin(struct window *window, const char *address);
void window_server_end(struct window *window);

#endif
