/* SPDX-License-Identifier: MIT */
#include "exec_program.h"

#include <stdio.h>
#include <string.h>

#include <rkm04/limits.h>

bool exec_file_read(struct exec_file *file, const char *path)
{
    file->name = strcmp(path, "-") == 0 ? "<stdin>" : path;
    const char *wrong = program_text_read(&file->text, path);
    if (wrong != NULL)
        fprintf(stderr, "rkm04 exec: cannot read %s: %s\n", file->name, wrong);
    return wrong == NULL;
}

bool exec_program_argument(const char *argument, char *motor, const char **path)
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
