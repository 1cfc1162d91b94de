/* SPDX-License-Identifier: MIT */
/* notify_shim.c: a system whose inotify is used up, for pty.sh (LD_PRELOAD). NOTIFY_SHIM=instances: no instance is left; else
 * no watch is. */
#include <errno.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <unistd.h>

int inotify_init1(int flags);
int inotify_add_watch(int fd, const char *path, uint32_t mask);

int inotify_init1(int flags)
{
    const char *what = getenv("NOTIFY_SHIM");
    if (what && strcmp(what, "instances") == 0) {
        errno = EMFILE;
        return -1;
    }
    return (int)syscall(SYS_inotify_init1, flags);
}

int inotify_add_watch(int fd, const char *path, uint32_t mask)
{
    (void)fd, (void)path, (void)mask;
    errno = ENOSPC;
    return -1;
}
