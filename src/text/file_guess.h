/* SPDX-License-Identifier: MIT */
/* file_guess.h: what a file seems to be, for messages to users who have mixed files up. */
#ifndef RKM04_TEXT_FILE_GUESS_H
#define RKM04_TEXT_FILE_GUESS_H

#include <stddef.h>

/* What a file with these contents seems to be: "a recording, for `rkm04 replay'"; NULL: nothing that is known. Only its first
 * lines are looked at. */
const char *file_guess(const char *bytes, size_t length);

/* If it seems to be something, and not what begins with `expected` (NULL: nothing is), report that on stderr as a note of
 * `program`. */
void file_guess_note(const char *program, const char *name, const char *expected, const char *bytes, size_t length);

/* The same of a file that is there and regular, by its first bytes. */
void file_guess_note_path(const char *program, const char *path);

#endif
