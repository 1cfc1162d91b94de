/* SPDX-License-Identifier: MIT */
/* pty_lock_shim.c: for pty.sh (LD_PRELOAD). Whenever the emulator opens its first pty again, a client has just opened it, taken
 * it for itself and gone without giving it back. */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

int open(const char *path, int flags, ...);

int open(const char *path, int flags, ...)
{
    static char first[64];
    int (*real)(const char *, int, ...) = (int (*)(const char *, int, ...))dlsym(RTLD_NEXT, "open");
    va_list list;
    va_start(list, flags);
    mode_t mode = flags & O_CREAT ? (mode_t)va_arg(list, unsigned) : 0;
    va_end(list);
    if (strncmp(path, "/dev/pts/", 9) == 0 && !first[0])
        snprintf(first, sizeof first, "%s", path);
    if (first[0] && strcmp(path, first) == 0) {
        int client = real(path, O_RDWR | O_NOCTTY);
        if (client >= 0) {
            ioctl(client, TIOCEXCL);
            close(client);
        }
    }
    return real(path, flags, mode);
}
