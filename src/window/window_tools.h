/* SPDX-License-Identifier: MIT */
/* window_tools.h: the program tools for the editor of a page, in a thread. A page has one job under way and one that comes
 * next: a newer one takes its place. */
#ifndef RKM04_WINDOW_TOOLS_H
#define RKM04_WINDOW_TOOLS_H

#include <jansson.h>

struct page;
struct tools_job;

/* Do what the page asks: {"do": "check" or "format", "text", "motor", "language"}. check gives diagnostics, the explanation of
 * each command and, of a text without errors, the estimate. */
void tools_do(struct page *page, json_t *request);

/* Give up a job that has not begun; NULL: none. */
void tools_drop(struct tools_job *job);

/* What `check` and `format` answer. New reference; NULL: no memory. */
json_t *tools_check(const char *text, size_t length, unsigned motor, const char *language);
json_t *tools_format(const char *text, size_t length);

#endif
