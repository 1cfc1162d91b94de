/* SPDX-License-Identifier: MIT */
/* poll.c: <poll.h>, whose events have the numbers of port.h. */
#include <poll.h>
#include <stdbool.h>
#include <windows.h>

#include "port.h"

#define LOOK_MS 10

short (*port_poll)(short events, int timeout);
static volatile LONG is_cancelled;

void port_set_cancelled(bool cancelled)
{
    InterlockedExchange(&is_cancelled, cancelled);
}

bool port_is_cancelled(void)
{
    return InterlockedOr(&is_cancelled, 0) != 0;
}

static bool has_input(int fd)
{
    DWORD waiting = 0;
    HANDLE file = (HANDLE)_get_osfhandle(fd);
    if (GetFileType(file) == FILE_TYPE_PIPE && PeekNamedPipe(file, NULL, 0, NULL, &waiting, NULL))
        return waiting > 0;
    return GetFileType(file) == FILE_TYPE_DISK;
}

static short check_file(const struct pollfd *file, int timeout)
{
    if (file->fd == PORT_FD)
        return port_poll(file->events, timeout);
    if (file->fd == CANCEL_FD)
        return port_is_cancelled() ? POLLIN : 0;
    return file->fd >= 0 && has_input(file->fd) ? POLLIN : 0;
}

/* The first one can wait; the others are looked at meanwhile. */
int poll(struct pollfd *fds, unsigned long count, int timeout)
{
    if (count == 0) {
        Sleep((DWORD)timeout);
        return 0;
    }
    bool alone = count == 1 || fds[1].fd < 0;
    ULONGLONG now = GetTickCount64(), end = now + (ULONGLONG)timeout;
    for (int found = 0;; now = GetTickCount64()) {
        int left = now < end ? (int)(end - now) : 0;
        for (unsigned long i = count; i-- > 0;) {
            fds[i].revents = check_file(&fds[i], i > 0 ? 0 : alone || left < LOOK_MS ? left : LOOK_MS);
            found += fds[i].revents != 0;
        }
        if (found > 0 || alone || left == 0)
            return found;
    }
}
