/* SPDX-License-Identifier: MIT */
#include "error_lines.h"

bool error_lines_add(struct error_lines *lines)
{
    return ++lines->count <= ERROR_LINES_MAX;
}

void error_lines_end(const struct error_lines *lines, const char *name, FILE *out)
{
    if (lines->count > ERROR_LINES_MAX)
        fprintf(out, "%s: %zu more errors are not shown\n", name, lines->count - ERROR_LINES_MAX);
}
