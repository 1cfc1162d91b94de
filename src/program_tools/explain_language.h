/* SPDX-License-Identifier: MIT */
/* explain_language.h: the languages of explanations. */
#ifndef RKM04_PROGRAM_TOOLS_EXPLAIN_LANGUAGE_H
#define RKM04_PROGRAM_TOOLS_EXPLAIN_LANGUAGE_H

/* The Czech terms are those of the manual. */
enum explain_language { EXPLAIN_ENGLISH, EXPLAIN_CZECH, EXPLAIN_LANGUAGES };

/* "en" or "cs". Returns EXPLAIN_LANGUAGES for another name. */
enum explain_language explain_language_named(const char *name);

#endif
