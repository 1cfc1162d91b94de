/* SPDX-License-Identifier: MIT */
#include "lock_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/file.h"

/* Is the open file still the one of that name? Who held it before may have removed it between our open and our lock. */
static bool is_same_file(int fd, const char *path)
{
    struct stat ours, there;
    return fstat(fd, &ours) == 0 && lstat(path, &there) == 0 && ours.st_ino == there.st_ino && ours.st_dev == there.st_dev;
}

/* Is it a file that we have made? In a folder that all may write to, another user may have put another one there, or a second
 * name of a file that must not be written to; and its content would decide what we remove. */
static bool is_own_file(int fd)
{
    struct stat found;
    return fstat(fd, &found) == 0 && S_ISREG(found.st_mode) && found.st_uid == geteuid() && found.st_nlink <= 1;
}

/* See that no output goes there. Returns `fd`, or -1 if one does already. */
static int check_no_output(int fd, const char *path)
{
    char *why;
    if (output_file_claim(fd, path, &why))
        return fd;
    free(why);
    close(fd);
    errno = EPERM;
    return -1;
}

int lock_file_take(const char *path, char record[LOCK_RECORD_MAX])
{
    record[0] = '\0';
    for (;;) {
        int fd = open(path, O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK, 0600);
        if (fd < 0)
            return -1;
        if (!is_own_file(fd)) {
            close(fd);
            errno = EPERM;
            return -1;
        }
        bool locked = flock(fd, LOCK_EX | LOCK_NB) == 0;
        int why = errno;
        ssize_t length = pread(fd, record, LOCK_RECORD_MAX - 1, 0);
        record[length > 0 ? length : 0] = '\0';
        record[strcspn(record, "\n")] = '\0';
        if (locked && is_same_file(fd, path))
            return check_no_output(fd, path);
        close(fd);
        if (!locked) {
            errno = why;
            return -1;
        }
    }
}

const char *lock_file_reason(int error)
{
    if (error == EPERM)
        return "it is not a lock file that you have made";
    return error == ELOOP ? "a link is in its place" : strerror(error);
}

bool lock_file_write(int fd, const char *format, ...)
{
    char record[LOCK_RECORD_MAX];
    va_list list;
    va_start(list, format);
    int length = vsnprintf(record, sizeof record - 1, format, list);
    va_end(list);
    if (length < 0 || length >= (int)sizeof record - 1)
        return false;
    record[length] = '\n';
    return ftruncate(fd, 0) == 0 && pwrite(fd, record, (size_t)length + 1, 0) == length + 1;
}

void lock_file_release(int *fd)
{
    output_file_release(*fd);
    close(*fd);
    *fd = -1;
}

void lock_file_remove(const char *path, int *fd)
{
    if (is_same_file(*fd, path)) /* not if it has been cleaned away, and is a successor's now */
        unlink(path);
    lock_file_release(fd);
}
