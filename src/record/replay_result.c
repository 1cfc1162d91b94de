/* SPDX-License-Identifier: MIT */
/* What became of a replay: its end, the first difference, and what is said of it. */
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "replay_result.h"
#include "text/text.h"

void replay_finish(struct replay_result *result, enum replay_end end)
{
    result->ended = true;
    result->end = end;
}

void replay_finish_wrong(struct replay_result *result, const char *name, uint64_t line, size_t column, const char *format,
                         va_list list)
{
    int length = snprintf(result->text, sizeof result->text, "%.200s:%" PRIu64 ":%zu: ", name, line, column);
    if (length > 0 && (size_t)length < sizeof result->text)
        vsnprintf(result->text + length, sizeof result->text - (size_t)length, format, list);
    invisible_note(result->text, sizeof result->text);
    result->note[0] = '\0';
    replay_finish(result, REPLAY_WRONG);
}

bool replay_finish_no_memory(struct replay_result *result)
{
    snprintf(result->text, sizeof result->text, "out of memory");
    replay_finish(result, REPLAY_NO_MEMORY);
    return false;
}

void replay_set_text(struct replay_result *result, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(result->text, sizeof result->text, format, list);
    va_end(list);
}

void replay_set_note(struct replay_result *result, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    vsnprintf(result->note, sizeof result->note, format, list);
    va_end(list);
}

bool replay_finish_different(struct replay_result *result, const struct replay_difference *difference, const char *program)
{
    struct replay_difference *first = &result->difference;
    char where[60], when[80];
    *first = *difference;
    if (first->motor > 0)
        snprintf(where, sizeof where, "unit %s, motor %u", first->name, first->motor);
    else if (first->unit > 0)
        snprintf(where, sizeof where, "unit %s", first->name);
    else
        snprintf(where, sizeof where, "%s", first->what);
    if (first->from == first->until)
        snprintf(when, sizeof when, "tick %" PRIu64, first->from);
    else
        snprintf(when, sizeof when, "ticks %" PRIu64 " to %" PRIu64, first->from, first->until);
    int length = snprintf(result->text, sizeof result->text, "%s, %s: recorded %s; came %s", where, when, first->recorded,
                          first->came);
    if (program && strcmp(program, "rkm04 " RKM04_VERSION) != 0 && length > 0 &&
        (size_t)length < sizeof result->text)
        snprintf(result->text + length, sizeof result->text - (size_t)length,
                 " (recorded by %.60s, this is rkm04 " RKM04_VERSION ")", program);
    result->ended = result->differs = true;
    result->end = REPLAY_DIFFERENT;
    return false;
}
