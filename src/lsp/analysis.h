/* SPDX-License-Identifier: MIT */
/* analysis.h: what is known of a program text until its next edit; each part is worked out when it is first asked for. */
#ifndef RKM04_LSP_ANALYSIS_H
#define RKM04_LSP_ANALYSIS_H

#include "program_tools/program_tools.h"

/* An estimate follows so many commands, which takes less than 5 ms. */
#define ANALYSIS_COMMANDS_MAX 5000u

struct analysis_command {
    struct rkm04_command command;
    size_t offset, length;
    unsigned program; /* a text is several programs with \ between them: labels of one are unknown in the others */
};

/* All zero: nothing is known yet. */
struct analysis {
    char *mapped; /* the text, mapped in place */
    struct analysis_command *commands;
    size_t count, room;
    struct explanations explanations;
    struct estimate estimate;
    enum estimate_result estimated; /* ESTIMATE_OK: there is an estimate */
    bool has_commands, has_explanations, has_estimate;
};

/* Each returns false if out of memory. */
bool analysis_read(struct analysis *analysis, const struct program_source *source);
bool analysis_explain(struct analysis *analysis, const struct program_source *source, enum explain_language language);
bool analysis_estimate(struct analysis *analysis, const struct program_source *source);

void analysis_clear(struct analysis *analysis);

/* The command at an offset, or that which ends there; NULL: none. After analysis_read(). */
const struct analysis_command *analysis_at(const struct analysis *analysis, size_t offset);

/* The label that a command has or goes to, 1..80; 0: none. */
unsigned analysis_label(struct rkm04_command command);

/* Where the digits of its label are. */
void analysis_label_place(const struct analysis *analysis, const struct analysis_command *command, size_t *offset,
                          size_t *length);

/* The @ that counts for jumps to `label` in a program; NULL: none. */
const struct analysis_command *analysis_find_label(const struct analysis *analysis, unsigned label, unsigned program);

/* The motion of the estimate at an offset; NULL: none. After analysis_estimate(). */
const struct estimate_motion *analysis_motion(const struct analysis *analysis, size_t offset);

#endif
