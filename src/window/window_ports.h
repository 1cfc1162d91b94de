/* SPDX-License-Identifier: MIT */
/* window_ports.h: the ports that can be chosen: serial devices of this machine, running emulators of this user. */
#ifndef RKM04_WINDOW_PORTS_H
#define RKM04_WINDOW_PORTS_H

#include <jansson.h>

struct page;

/* Answer {"ports": [{"port", "name"}], "emulators": [{"control", "port"}]} to the page, found in a thread. */
void window_ports_list(struct page *page, json_t *request);

/* The same, at once. New reference; NULL: no memory. */
json_t *window_ports_find(void);

#endif
