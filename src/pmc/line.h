/* SPDX-License-Identifier: MIT */
/* line.h: a line of the ASCII face as operands (AS2). It knows nothing of the state of a unit. */
#ifndef PMC_LINE_H
#define PMC_LINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What follows the three letters. */
enum pmc_line_operand {
    PMC_LINE_NONE,
    PMC_LINE_AXES,    /* XY */
    PMC_LINE_SIGNED,  /* X -Y */
    PMC_LINE_ONE,     /* X */
    PMC_LINE_START,   /* XY00 */
    PMC_LINE_NUMBERS, /* 10,-1 */
    PMC_LINE_VALUES,  /* the same, or nothing */
    PMC_LINE_VALUE    /* 19200, or nothing */
};

/* Operands of a line. A number of more than nine digits counts as PMC_LINE_LARGE. */
struct pmc_line_operands {
    uint8_t axes;     /* bit 0 X, bit 1 Y: named, or with a number */
    uint8_t forward;  /* of these, those without a - */
    uint8_t reg;      /* two digits, 0..99 */
    bool is_empty;    /* there is no operand */
    int32_t number[2];
};

#define PMC_LINE_LARGE INT32_C(1000000000)

/* Read operands of the kind `form` from text[0..length), which follows the three letters. `axes`: how many the unit has, 1 or 2.
 * Text after a complete operand is ignored. Returns false if the operand is missing or malformed, or names an axis twice or one
 * that is not there. */
bool pmc_line_read(enum pmc_line_operand form, const char *text, size_t length, unsigned axes,
                   struct pmc_line_operands *operands);

#endif
