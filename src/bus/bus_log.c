/* SPDX-License-Identifier: MIT */
#include "bus_log.h"

#include <stdarg.h>
#include <stdio.h>

#include "line/line.h"

static void write_line(const struct bus_log *log, uint64_t tick, const char *format, va_list list)
{
    char text[512];
    vsnprintf(text, sizeof text, format, list);
    if (log->several)
        log_at(tick, "line %u: %s", log->number, text);
    else
        log_at(tick, "%s", text);
}

void bus_log(const struct bus_log *log, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    write_line(log, log->present(log->context), format, list);
    va_end(list);
}

void bus_log_detail(const struct bus_log *log, const char *format, ...)
{
    va_list list;
    if (!log->detailed)
        return;
    va_start(list, format);
    write_line(log, log->present(log->context), format, list);
    va_end(list);
}

void bus_log_at(const struct bus_log *log, uint64_t tick, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    write_line(log, tick, format, list);
    va_end(list);
}
