/* SPDX-License-Identifier: MIT */
#include "program_argument.h"

#include <string.h>

#include <rkm04/limits.h>

bool program_argument_read(const char *argument, char *motor, const char **path)
{
    size_t digits = strspn(argument, "0123456789");
    *motor = '1';
    *path = argument;
    if (digits == 0 || argument[digits] != '=')
        return true;
    if (digits > 1 || argument[0] > '0' + RKM04_MOTORS)
        return false;
    *motor = argument[0];
    *path = argument + digits + 1;
    return true;
}
