/* SPDX-License-Identifier: MIT */
/* window_files.h: the files of the page, as they are compiled in. */
#ifndef RKM04_WINDOW_FILES_H
#define RKM04_WINDOW_FILES_H

#include <stddef.h>

struct window_file {
    const char *path; /* "/index.html" */
    const char *type; /* of its contents */
    const unsigned char *bytes;
    size_t length;
};

/* NULL: there is none. */
const struct window_file *window_file_find(const char *path);

#endif
