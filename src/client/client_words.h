/* SPDX-License-Identifier: MIT */
/* client_words.h: a line of `rkmctl shell` as words. Pure. */
#ifndef RKM04_CLIENT_WORDS_H
#define RKM04_CLIENT_WORDS_H

#include <stdbool.h>

#define CLIENT_WORDS_MAX 64

/* Is the line program text? Commands of the shell begin with a small letter, those of a program do not. */
bool client_words_is_program(const char *line);

/* Cut a line into words, in place: blanks between them, ' and " around what has blanks; from # on it is a comment. Returns their
 * number; -1: a quote is left open; -2: there are more than CLIENT_WORDS_MAX. */
int client_words_split(char *line, char *word[CLIENT_WORDS_MAX]);

#endif
