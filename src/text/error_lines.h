/* SPDX-License-Identifier: MIT */
/* error_lines.h: errors of a text, a line each, up to a limit: a file of another kind must not fill a terminal or a log. */
#ifndef RKM04_TEXT_ERROR_LINES_H
#define RKM04_TEXT_ERROR_LINES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#define ERROR_LINES_MAX 1000u /* shown of one text; further ones are counted */

/* Of one text. Plain data, zero at first. */
struct error_lines {
    size_t count;
};

/* Count an error. Returns whether it is to be printed. */
bool error_lines_add(struct error_lines *lines);

/* After the last one: print to `out` how many were not printed, if any. */
void error_lines_end(const struct error_lines *lines, const char *name, FILE *out);

#endif
