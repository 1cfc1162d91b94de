/* SPDX-License-Identifier: MIT */
/* format.h: the canonical layout of a program text.
 *
 * Every command is written as the unit would (P8), one blank between two. A label is at the margin in a line of its own;
 * loops, [ ] and the bodies of subroutines are indented by four; a line ends after a motion, a dwell, a wait, a jump, a Y. Lines
 * that were separate stay so, one empty line between them stays, comments stay as they are. */
#ifndef RKM04_PROGRAM_TOOLS_FORMAT_H
#define RKM04_PROGRAM_TOOLS_FORMAT_H

#include "diagnostic.h"

enum format_result {
    FORMAT_DONE,
    FORMAT_ERRORS,   /* the unit would refuse the text: check_programs() says why */
    FORMAT_NO_MEMORY
};

/* Lay out a text. With FORMAT_DONE *out is a new text of *length bytes, to be freed. The same commands come out that went in;
 * laying the result out again changes nothing. */
enum format_result format_program(const struct program_source *source, char **out, size_t *length);

#endif
