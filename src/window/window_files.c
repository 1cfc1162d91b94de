/* SPDX-License-Identifier: MIT */
#include "window_files.h"

#include <embedded/window_pages.h>
#include <string.h>

#define ROW(path, type, name) {path, type, name, sizeof(name)},
static const struct window_file files[] = {WINDOW_PAGES(ROW)};
#undef ROW

const struct window_file *window_file_find(const char *path)
{
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++)
        if (strcmp(files[i].path, path) == 0)
            return &files[i];
    return NULL;
}
