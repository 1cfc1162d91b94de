/* SPDX-License-Identifier: MIT */
/* check_print.h: diagnostics for people, editors, CI services. */
#ifndef RKM04_PROGRAM_TOOLS_CHECK_PRINT_H
#define RKM04_PROGRAM_TOOLS_CHECK_PRINT_H

#include <jansson.h>
#include <stdio.h>

#include "diagnostic.h"

enum check_format { CHECK_TEXT, CHECK_JSON, CHECK_SARIF, CHECK_GITHUB, CHECK_GCC, CHECK_FORMATS };

/* "text, json, sarif, github or gcc" */
#define CHECK_FORMAT_NAMES "text, json, sarif, github or gcc"

/* Returns CHECK_FORMATS if there is none of that name. */
enum check_format check_format_named(const char *name);

/* What is printed, one check after the other. */
struct check_printer {
    enum check_format format;
    FILE *out;
    json_t *array;          /* inside: of JSON and SARIF */
    size_t errors, warnings; /* so far */
    bool no_memory;
};

void check_print_begin(struct check_printer *printer, enum check_format format, FILE *out);
void check_print(struct check_printer *printer, const struct program_source *sources, const struct diagnostics *found);

/* Print what is at the end. Returns false if out of memory. */
bool check_print_end(struct check_printer *printer);

/* One diagnostic as an object: file, line, column, offset, length, severity, name, message, hint (null: none). New reference. */
json_t *check_json(const struct diagnostic *one, const struct program_source *sources);

#endif
