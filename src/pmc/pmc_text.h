/* SPDX-License-Identifier: MIT */
/* pmc_text.h: programs and parameters as text (section 8). A part of pmc.h, which includes it. */
#ifndef PMC_PMC_TEXT_H
#define PMC_PMC_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#define PMC_COMMAND_TEXT_MAX 32u     /* bytes of a command: "ABS -8388608 V4 65535" */
#define PMC_PROGRAM_TEXT_MAX 8192u   /* bytes of a canonical program text of two axes */
#define PMC_PARAMETER_TEXT_MAX 2048u /* bytes of a canonical parameter text of two axes */

/* What is wrong in a text. */
struct pmc_text_error {
    unsigned line, column; /* from 1; bytes */
    bool is_warning;       /* the text counts all the same */
    const char *text;      /* "expected a register from 0 to 63" */
};

/* Gets every error and warning of a text, in the order of lines; those about a whole program come last. */
typedef void pmc_text_report(void *context, const struct pmc_text_error *error);

/* Read a whole program (AF1) for a unit with `axes` axes: registers that it does not name are NOP. report NULL: none. Returns
 * false if the text is wrong; `program` is undefined then. */
bool pmc_program_read(const char *text, size_t length, unsigned axes, struct pmc_command program[PMC_AXES][PMC_REGISTERS],
                      pmc_text_report *report, void *context);

/* Write a program in the canonical form. Returns the length of the text, of which at most `room` bytes are written. */
size_t pmc_program_write(const struct pmc_command *const program[PMC_AXES], unsigned axes, char *text, size_t room);

/* Write a command: "INC -20.5 V4". Returns its length. */
size_t pmc_command_write(const struct pmc_command *command, char text[PMC_COMMAND_TEXT_MAX]);

/* The same two for parameters (AF2): what is missing has its default. */
bool pmc_parameters_read(const char *text, size_t length, unsigned axes, struct pmc_parameters parameters[PMC_AXES],
                         pmc_text_report *report, void *context);
size_t pmc_parameters_write(const struct pmc_parameters *const parameters[PMC_AXES], unsigned axes, char *text, size_t room);

#endif
