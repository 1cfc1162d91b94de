/* SPDX-License-Identifier: MIT */
#include "client_usage.h"

#include <err.h>
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "options/options.h"
#include "text/text.h"

enum exit_status client_usage(const char *format, ...)
{
    char text[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    invisible_note(text, sizeof text);
    arguments_reported();
    warnx("%s", text);
    fprintf(stderr, "Try `%s --help' or `%s --usage' for more information.\n", program_invocation_short_name,
            program_invocation_short_name);
    return STATUS_USAGE;
}

bool client_usage_number(const char *what, const char *text, unsigned low, unsigned high, unsigned *number)
{
    uint64_t read;
    if (number_read(text, low, high, &read)) {
        *number = (unsigned)read;
        return true;
    }
    client_usage("%s: expected a number %u to %u, found '%s'", what, low, high, text);
    return false;
}
