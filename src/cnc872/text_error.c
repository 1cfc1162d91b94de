/* SPDX-License-Identifier: MIT */
/* Errors of texts. */
#include "text_error.h"

#include <string.h>

#define PIECE_MAX 40u /* bytes of a piece that are shown */

/* Append what fits, and a final 0. */
static size_t append(char *message, size_t used, const char *text, size_t length, size_t most)
{
    for (size_t i = 0; i < length && i < most && used + 1 < CNC_TEXT_ERROR_SIZE; i++)
        message[used++] = text[i];
    message[used] = '\0';
    return used;
}

void cnc_text_fail(struct cnc_text_errors *errors, uint32_t line, uint32_t column, const char *before, const char *piece,
                   size_t length, const char *after)
{
    errors->count += errors->count < UINT32_MAX;
    if (errors->count > CNC_TEXT_ERRORS_MAX || errors->report == NULL)
        return;
    char message[CNC_TEXT_ERROR_SIZE];
    size_t used = append(message, 0, before, strlen(before), CNC_TEXT_ERROR_SIZE), begin = used;
    used = append(message, used, piece, length, PIECE_MAX);
    for (size_t i = begin; i < used; i++)
        if (message[i] < ' ' || message[i] > '~')
            message[i] = '?';
    append(message, used, after, strlen(after), CNC_TEXT_ERROR_SIZE);
    errors->report(errors->context, &(struct cnc_text_error){.line = line, .column = column, .text = message});
}
