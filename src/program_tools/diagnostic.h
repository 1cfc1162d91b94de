/* SPDX-License-Identifier: MIT */
/* diagnostic.h: an error or a warning about a place in a program text, and lists of them. */
#ifndef RKM04_PROGRAM_TOOLS_DIAGNOSTIC_H
#define RKM04_PROGRAM_TOOLS_DIAGNOSTIC_H

#include <stdbool.h>
#include <stddef.h>

/* A program text as it is in a file. */
struct program_source {
    const char *name; /* of the file, for messages */
    const char *text; /* need not end with a zero */
    size_t length;    /* bytes */
    unsigned motor;   /* 1..4; 0: for all four. Sources for the same motor are sent one after the other */
};

enum diagnostic_severity { DIAGNOSTIC_ERROR, DIAGNOSTIC_WARNING };

struct diagnostic {
    size_t source;         /* which of the sources */
    size_t offset, length; /* in bytes, of what it is about; offset may be the end of the text */
    size_t line, column;   /* of the offset, from 1; a UTF-8 character is one column */
    enum diagnostic_severity severity;
    const char *name;      /* "bad-value", "missing-label"; static */
    char *message;         /* what is wrong, one line */
    char *hint;            /* what to do; NULL: nothing to add */
};

#define DIAGNOSTICS_MAX 1000u /* kept of one check; further ones are counted */

/* A list in the order of sources and offsets. All zero: empty. */
struct diagnostics {
    struct diagnostic *list;
    size_t count;
    size_t errors, warnings; /* those beyond DIAGNOSTICS_MAX included */
    bool bad_plant;          /* the plant given has an error, which has been reported */
    size_t room;             /* inside */
    bool no_memory;          /* inside: a diagnostic is missing */
};

/* Add one. `hint` may be NULL. The message is printf-like. */
void diagnostics_add(struct diagnostics *all, const struct diagnostic *what, const char *hint, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Bring them into order and work out line and column of each. */
void diagnostics_arrange(struct diagnostics *all, const struct program_source *sources);

void diagnostics_free(struct diagnostics *all);

#endif
