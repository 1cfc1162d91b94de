/* SPDX-License-Identifier: MIT */
/* explain_words.h: the words of each language. For the files of the explanation. */
#ifndef RKM04_PROGRAM_TOOLS_EXPLAIN_WORDS_H
#define RKM04_PROGRAM_TOOLS_EXPLAIN_WORDS_H

#include <rkm04/text.h>

#include "explain_language.h"

/* Phrases besides those of the commands. %s and numbers as printf() takes them. */
enum explain_phrase {
    PHRASE_FORWARD,
    PHRASE_BACK,
    PHRASE_EITHER,        /* direction not known */
    PHRASE_STEPS,         /* PRId64 steps, direction */
    PHRASE_SOME_STEPS,    /* a number that is not known, direction */
    PHRASE_COMPOUND,      /* number of segments, PRIu64 steps, direction */
    PHRASE_SOME_COMPOUND,
    PHRASE_NOTHING,       /* no steps */
    PHRASE_GUARD,         /* character and number of M or N */
    PHRASE_NEVER,         /* never executed */
    PHRASE_SUBROUTINE,
    PHRASES
};

const char *explain_phrase(enum explain_phrase phrase, enum explain_language language);

/* What a command does, a template in which %u is its number; of I the input, H or L as 1 or 0, and the label. */
const char *explain_template(struct rkm04_command command, enum explain_language language);

#endif
