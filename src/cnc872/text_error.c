/* SPDX-License-Identifier: MIT */
/* Errors of texts. */
#include "text_error.h"

#include <string.h>

#define PIECE_MAX 40u /* bytes of a piece that are shown */

/* Append what fits, and a final 0. */
static size_t append(char *message, size_t used, const char *text, size_t length)
{
    for (size_t i = 0; i < length && used + 1 < CNC_TEXT_ERROR_SIZE; i++)
        message[used++] = text[i];
    message[used] = '\0';
    return used;
}

void cnc_text_fail_at(struct cnc_text_errors *errors, uint32_t line, uint32_t column, const char *reason, const char *piece,
                      size_t length)
{
    char before[CNC_TEXT_ERROR_SIZE];
    const size_t used = append(before, 0, reason, strlen(reason));
    if (length > 0)
        append(before, used, " `", 2);
    cnc_text_fail(errors, line, column, before, piece, length, length > 0 ? "'" : "");
}

void cnc_text_fail(struct cnc_text_errors *errors, uint32_t line, uint32_t column, const char *before, const char *piece,
                   size_t length, const char *after)
{
    errors->count += errors->count < UINT32_MAX;
    if (errors->count > CNC_TEXT_ERRORS_MAX || errors->report == NULL)
        return;
    char message[CNC_TEXT_ERROR_SIZE];
    const size_t begin = append(message, 0, before, strlen(before));
    const size_t used = append(message, begin, piece, length < PIECE_MAX ? length : PIECE_MAX);
    for (size_t i = begin; i < used; i++)
        if (message[i] < ' ' || message[i] > '~')
            message[i] = '?';
    append(message, used, after, strlen(after));
    errors->report(errors->context, &(struct cnc_text_error){.line = line, .column = column, .text = message});
}
