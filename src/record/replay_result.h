/* SPDX-License-Identifier: MIT */
/* replay_result.h: what became of a replay. Only replay_result.c writes into it. */
#ifndef RKM04_RECORD_REPLAY_RESULT_H
#define RKM04_RECORD_REPLAY_RESULT_H

#include <stdarg.h>
#include <stdbool.h>

#include "record.h"

struct replay_result {
    enum replay_end end;
    bool ended;                 /* for whatever reason */
    bool differs;
    struct replay_difference difference;
    char text[800], note[200];
};

void replay_finish(struct replay_result *result, enum replay_end end);

/* The file `name` is wrong, at this line and column. */
void replay_finish_wrong(struct replay_result *result, const char *name, uint64_t line, size_t column, const char *format,
                         va_list list);

/* Memory is short. Always returns false. */
bool replay_finish_no_memory(struct replay_result *result);

/* The first difference, of a recording by `program` (NULL: not known). Always returns false. */
bool replay_finish_different(struct replay_result *result, const struct replay_difference *difference, const char *program);

void replay_set_text(struct replay_result *result, const char *format, ...) __attribute__((format(printf, 2, 3)));
void replay_set_note(struct replay_result *result, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
