/* SPDX-License-Identifier: MIT */
/* estimate_print.h: an estimate for people, and as JSON. */
#ifndef RKM04_PROGRAM_TOOLS_ESTIMATE_PRINT_H
#define RKM04_PROGRAM_TOOLS_ESTIMATE_PRINT_H

#include <jansson.h>
#include <stdio.h>

#include "estimate.h"

void estimate_print(const struct estimate *estimate, const struct program_source *sources, FILE *out);

/* New reference; NULL: out of memory. */
json_t *estimate_json(const struct estimate *estimate, const struct program_source *sources);

/* The whole in a few words, "24.469167 s, 18000 steps, peak 2500 steps/s": for a code lens. Returns `text`. */
const char *estimate_summary(const struct estimate *estimate, char text[160]);

#endif
