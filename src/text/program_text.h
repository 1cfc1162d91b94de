/* SPDX-License-Identifier: MIT */
/* program_text.h: program texts as people write them, read from files. */
#ifndef RKM04_TEXT_PROGRAM_TEXT_H
#define RKM04_TEXT_PROGRAM_TEXT_H

#include <stdbool.h>
#include <stddef.h>

struct program_text {
    char *text; /* NULL: none */
    size_t length;
};

/* Map in place to the bytes the unit takes: a UTF-8 byte order mark goes, the typographic apostrophes U+00B4, U+2018,
 * U+2019 and U+201E become the 0x27 of a call. Returns the new length. */
size_t program_text_map(char *text, size_t length);

/* The same, but every character keeps its place: what goes leaves blanks, which the unit passes over. Returns whether there was a
 * typographic apostrophe. */
bool program_text_map_in_place(char *text, size_t length);

/* Read the whole file `path`, "-" for standard input, into *text, mapped. program_text_free() is due in any case.
 * Returns NULL, or why it cannot be read. */
const char *program_text_read(struct program_text *text, const char *path);

/* The same without the map: the bytes of the file. */
const char *program_text_read_raw(struct program_text *text, const char *path);

void program_text_free(struct program_text *text);

#endif
