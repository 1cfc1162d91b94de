/* SPDX-License-Identifier: MIT */
/* explain.h: programs in words, command by command, with the parameters in force at each motion. */
#ifndef RKM04_PROGRAM_TOOLS_EXPLAIN_H
#define RKM04_PROGRAM_TOOLS_EXPLAIN_H

#include <rkm04/text.h>

#include "diagnostic.h"
#include "explain_language.h"

/* What one command does. */
struct explanation {
    size_t source, offset, length, line, column;
    char *text; /* one line */
};

struct explanations {
    struct explanation *list; /* in the order of the sources and their texts; errors are left out */
    size_t count, room;
};

/* Explain the sources, those for one motor as one program. explain_free() is due in any case. Returns false if out of
 * memory. */
bool explain_programs(const struct program_source *sources, size_t count, enum explain_language language,
                      struct explanations *all);
void explain_free(struct explanations *all);

/* The explanation of the command at `offset` of one of the sources, or right before it; NULL: there is none. */
const struct explanation *explain_at(const struct explanations *all, size_t source, size_t offset);

/* A command alone, without what precedes it: "wait until input 03 is 1". Returns `text`. */
const char *explain_command(struct rkm04_command command, enum explain_language language, char *text, size_t size);

/* The same with n in place of its number: "wait until input n is 1". `low`: a number that the command may have; commands mean
 * different things in different ranges. */
const char *explain_kind(uint8_t op, uint32_t low, enum explain_language language, char *text, size_t size);

#endif
