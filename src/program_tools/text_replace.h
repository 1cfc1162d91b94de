/* SPDX-License-Identifier: MIT */
/* text_replace.h: a file with another text in its place. */
#ifndef RKM04_PROGRAM_TOOLS_TEXT_REPLACE_H
#define RKM04_PROGRAM_TOOLS_TEXT_REPLACE_H

#include <stddef.h>

/* Give the file `path` this content: a new file with its mode takes its place, or it stays as it was. A link stays a link.
 * Returns NULL, or why that was not possible. */
const char *text_replace(const char *path, const char *text, size_t length);

#endif
