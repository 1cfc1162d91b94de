/* SPDX-License-Identifier: MIT */
/* poll.c: <poll.h>, whose events have the numbers of port.h. */
#include <poll.h>
#include <stdbool.h>
#include <windows.h>

#include "port.h"

short (*port_poll)(short events, int timeout);

static bool has_input(int fd)
{
    DWORD waiting = 0;
    HANDLE file = (HANDLE)_get_osfhandle(fd);
    if (GetFileType(file) == FILE_TYPE_PIPE && PeekNamedPipe(file, NULL, 0, NULL, &waiting, NULL))
        return waiting > 0;
    return GetFileType(file) == FILE_TYPE_DISK;
}

int poll(struct pollfd *fds, unsigned long count, int timeout)
{
    if (count == 0) {
        Sleep((DWORD)timeout);
        return 0;
    }
    for (unsigned long i = 1; i < count; i++)
        fds[i].revents = 0;
    if (fds->fd < 0)
        fds->revents = 0;
    else if (fds->fd == PORT_FD)
        fds->revents = port_poll(fds->events, timeout);
    else
        fds->revents = has_input(fds->fd) ? POLLIN : 0;
    return fds->revents != 0;
}
