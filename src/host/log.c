/* SPDX-License-Identifier: MIT */
#include "log.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>

#include <rkm04/limits.h>

void log_error(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fputs("rkm04 serve: ", stderr);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
}

void log_at(uint64_t tick, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    fprintf(stderr, "[%6" PRIu64 ".%06" PRIu64 "] ", tick / RKM04_TICKS_PER_SECOND, tick % RKM04_TICKS_PER_SECOND);
    vfprintf(stderr, format, list);
    fputc('\n', stderr);
    va_end(list);
}
