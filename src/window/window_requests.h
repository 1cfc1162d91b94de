/* SPDX-License-Identifier: MIT */
/* window_requests.h: what a page can ask for: {"id": ANY, "do": NAME, …}. The answer has the same id; {"id", "error": TEXT} if it
 * is refused. docs/WINDOW.md lists them. */
#ifndef RKM04_WINDOW_REQUESTS_H
#define RKM04_WINDOW_REQUESTS_H

#include <jansson.h>

#define WINDOW_TIMEOUT_MS 1000 /* for an answer of a unit, if neither the page nor the environment says another time */
#define WINDOW_TIMEOUT_MS_MAX 60000

struct page;

/* pages.request and pages.closed, with a struct window as pages.context. */
void window_request(struct page *page, json_t *request);
void window_page_closed(struct page *page);

#endif
