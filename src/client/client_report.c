/* SPDX-License-Identifier: MIT */
#include "client_report.h"

#include <err.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char *sink;
static _Thread_local size_t sink_size;

void client_report_into(char *text, size_t size)
{
    sink = text;
    sink_size = size;
    if (text != NULL)
        text[0] = '\0';
}

static void append(const char *format, va_list arguments) __attribute__((format(printf, 1, 0)));
static void append(const char *format, va_list arguments)
{
    size_t length = strlen(sink);
    vsnprintf(sink + length, sink_size - length, format, arguments);
}

void client_report(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (sink == NULL) {
        vwarnx(format, arguments);
    } else {
        append(format, arguments);
        client_advise("\n");
    }
    va_end(arguments);
}

void client_advise(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    if (sink == NULL)
        vfprintf(stderr, format, arguments);
    else
        append(format, arguments);
    va_end(arguments);
}
