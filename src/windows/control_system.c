/* SPDX-License-Identifier: MIT */
/* control_system.c: there are no Unix sockets that the event loop can use: the control socket is a TCP port. */
#include "control/control_system.h"

#include <errno.h>

int control_system_bind(const char *path)
{
    (void)path;
    errno = ENOSYS;
    return -1;
}

bool control_system_is_socket(const char *path)
{
    (void)path;
    return false;
}

bool control_system_is_alive(const char *path)
{
    (void)path;
    return false;
}

bool control_system_is_gone(const uv_pipe_t *pipe)
{
    (void)pipe;
    return false;
}

const char *control_system_instead(void)
{
    return "127.0.0.1:0";
}
