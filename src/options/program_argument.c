/* SPDX-License-Identifier: MIT */
#include "program_argument.h"

#include <stdlib.h>
#include <string.h>

bool program_argument_read(const char *argument, unsigned motors, unsigned *motor, const char **path)
{
    size_t digits = strspn(argument, "0123456789");
    *motor = 1;
    *path = argument;
    if (digits == 0 || argument[digits] != '=')
        return true;
    if (digits > 2 || (digits == 2 && argument[0] == '0'))
        return false;
    *motor = (unsigned)strtoul(argument, NULL, 10);
    *path = argument + digits + 1;
    return *motor <= motors;
}
