/* SPDX-License-Identifier: MIT */
/* text_diff.h: what differs between two texts, printed by diff(1). */
#ifndef RKM04_PROGRAM_TOOLS_TEXT_DIFF_H
#define RKM04_PROGRAM_TOOLS_TEXT_DIFF_H

#include <stdbool.h>
#include <stddef.h>

/* Print on stdout as `diff -u` does; `name` stands for both. Returns false if that was not possible, which is reported on
 * stderr. */
bool text_diff(const char *name, const char *before, size_t before_length, const char *after, size_t after_length);

#endif
