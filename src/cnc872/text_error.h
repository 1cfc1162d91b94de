/* SPDX-License-Identifier: MIT */
/* text_error.h: errors of texts, of CONFIG.xml, NC programs and PLC programs alike (NJ1, NN2, NP8). */
#ifndef CNC872_TEXT_ERROR_H
#define CNC872_TEXT_ERROR_H

#include <stddef.h>
#include <stdint.h>

#define CNC_TEXT_ERRORS_MAX 20u  /* reported of one text; further ones are counted */
#define CNC_TEXT_ERROR_SIZE 200u /* bytes of a message, with its final 0 */

struct cnc_text_error {
    uint32_t line, column; /* from 1; a column is a byte */
    const char *text;      /* "expected ..."; valid during the call only */
};

typedef void cnc_text_report(void *context, const struct cnc_text_error *error);

/* The errors of a text: where they go to, and how many there are. */
struct cnc_text_errors {
    cnc_text_report *report; /* NULL: they are counted only */
    void *context;
    uint32_t count;
};

/* Report one error: `before`, the `length` bytes at `piece` (what is not printable as ?, cut after 40 bytes), `after`. */
void cnc_text_fail(struct cnc_text_errors *errors, uint32_t line, uint32_t column, const char *before, const char *piece,
                   size_t length, const char *after);

/* The same with the bytes in quotes behind the reason, "unknown instruction `TIM'"; without any the reason alone. */
void cnc_text_fail_at(struct cnc_text_errors *errors, uint32_t line, uint32_t column, const char *reason, const char *piece,
                      size_t length);

#endif
