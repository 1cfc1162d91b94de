/* SPDX-License-Identifier: MIT */
/* diagnose.h: what is wrong with a program text, for people: FILE:LINE:COLUMN: error: what was expected. */
#ifndef RKM04_TEXT_DIAGNOSE_H
#define RKM04_TEXT_DIAGNOSE_H

#include <stddef.h>
#include <stdio.h>

#include <rkm04/readings.h>
#include <rkm04/text.h>

/* A place in a text as an editor shows it: both count from 1, a UTF-8 character is one column. Plain data. */
struct text_place {
    const char *text;
    size_t length;
    size_t at; /* offset in bytes */
    size_t line, column;
};

/* The beginning of a text. */
struct text_place text_place_begin(const char *text, size_t length);

/* Continue to `offset`, not before the present place, at most the end of the text. */
void text_place_move(struct text_place *place, size_t offset);

/* Bytes of the UTF-8 character at `at` < length; 1 for what is none: texts in the code pages of old are taken, too. */
size_t text_character_length(const char *text, size_t length, size_t at);

/* As rkm04_read(), but a wrong character of several bytes is one error. */
enum rkm04_read diagnose_read(struct rkm04_reader *reader, struct rkm04_command *command);

/* Print what was expected and what was found there, without place and newline, after an error of diagnose_read(). */
void diagnose_error(const struct rkm04_reader *reader, enum rkm04_read found, FILE *out);

/* Read a whole program text and print one line `NAME:LINE:COLUMN: error: …` to `out` for each command that the unit would
 * refuse (flags 1 and 2 of message 2), at the place of the command. Returns their number; 0: the unit takes the text. */
int diagnose_text(const char *name, const char *text, size_t length, FILE *out);

/* The same for commands of a text without errors that a unit with these readings refuses. */
int diagnose_readings(const char *name, const char *text, size_t length, const struct rkm04_readings *readings, FILE *out);

#endif
