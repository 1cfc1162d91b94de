/* SPDX-License-Identifier: MIT */
/* source_texts.h: the texts of sources as the unit takes them, every character at its place. */
#ifndef RKM04_PROGRAM_TOOLS_SOURCE_TEXTS_H
#define RKM04_PROGRAM_TOOLS_SOURCE_TEXTS_H

#include "diagnostic.h"

/* Copies of the texts, mapped by program_text_map_in_place(); NULL: out of memory. */
char **source_texts_map(const struct program_source *sources, size_t count);

/* `texts` may be NULL. */
void source_texts_free(char **texts, size_t count);

#endif
