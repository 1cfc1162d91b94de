/* SPDX-License-Identifier: MIT */
/* check_inside.h: what the files of the check share. */
#ifndef RKM04_PROGRAM_TOOLS_CHECK_INSIDE_H
#define RKM04_PROGRAM_TOOLS_CHECK_INSIDE_H

#include "check.h"
#include "code.h"
#include "flow.h"
#include "planner.h"

/* The program of one motor. */
struct check_motor {
    unsigned motor; /* 0: all four */
    struct code code;
    struct flow flow;
};

struct check {
    const struct program_source *sources;
    size_t count;
    const struct check_options *options;
    struct diagnostics *found;
    char **texts;               /* of the sources, mapped in place */
    struct check_motor *motors;
    size_t motor_count;
    struct planner planner;
};

/* Report a warning about commands `first` to `last` of a motor. */
void check_warn(struct check *check, const struct check_motor *motor, enum check_warning warning, size_t first, size_t last,
                const char *hint, const char *format, ...) __attribute__((format(printf, 7, 8)));

/* The same at a place. */
void check_warn_at(struct check *check, struct diagnostic place, enum check_warning warning, const char *hint,
                   const char *format, ...) __attribute__((format(printf, 5, 6)));

/* check_text.c: read the source; errors with their hints, and K and C75 inside a program. */
bool check_read(struct check *check, struct check_motor *motor, size_t source);

/* Each finds warnings in the program of one motor. */
void check_labels(struct check *check, const struct check_motor *motor);
void check_flow(struct check *check, struct check_motor *motor);
void check_motions(struct check *check, const struct check_motor *motor);
void check_guards(struct check *check, const struct check_motor *motor);

/* check_bits.c: outputs and variables, in all programs. */
void check_outputs(struct check *check);
bool check_variables(struct check *check);

/* check_plant.c: run the programs with the plant. */
bool check_plant(struct check *check);

/* check_nolint.c: drop what a comment in the text has switched off. */
void check_nolint(struct check *check);

#endif
