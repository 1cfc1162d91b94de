/* SPDX-License-Identifier: MIT */
#include "text_replace.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static bool write_all(int file, const char *text, size_t length)
{
    while (length > 0) {
        ssize_t written = write(file, text, (unsigned)length);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        text += written;
        length -= (size_t)written;
    }
    return true;
}

/* Write the text to `file`, a new one called `temporary`, and let it take the place of `path`. Returns 0 or an error number. */
static int put_in_place(int file, const char *temporary, const char *path, const struct stat *old, const char *text,
                        size_t length)
{
    bool ok = write_all(file, text, length) && fchmod(file, old->st_mode & 07777) == 0 && fsync(file) == 0;
    int wrong = ok ? 0 : errno;
    if (close(file) != 0 && wrong == 0)
        wrong = errno;
    if (wrong == 0 && rename(temporary, path) != 0)
        wrong = errno;
    if (wrong != 0)
        unlink(temporary);
    return wrong;
}

const char *text_replace(const char *path, const char *text, size_t length)
{
    struct stat old;
    char *real = realpath(path, NULL), *temporary = NULL;
    int wrong = errno;
    if (real != NULL && stat(real, &old) == 0 && !S_ISREG(old.st_mode)) {
        wrong = EINVAL;
    } else if (real != NULL && asprintf(&temporary, "%s.XXXXXX", real) > 0) {
        int file = mkstemp(temporary);
        wrong = file < 0 ? errno : put_in_place(file, temporary, real, &old, text, length);
    }
    free(temporary);
    free(real);
    return wrong == 0 ? NULL : strerror(wrong);
}
