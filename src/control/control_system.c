/* SPDX-License-Identifier: MIT */
#include "control_system.h"

#include <errno.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include "options/options.h"

/* bind() makes a file and follows no link. */
static int bind_private(const struct sockaddr_un *address)
{
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    mode_t mask = umask(0177);
    bool bound = fd >= 0 && bind(fd, (const struct sockaddr *)address, sizeof *address) == 0;
    int why = errno;
    umask(mask);
    if (fd >= 0 && !bound)
        close(fd);
    errno = why;
    return bound ? fd : -1;
}

int control_system_bind(const char *path)
{
    struct sockaddr_un address;
    int folder, fd = socket_address_find(path, &address, &folder) ? bind_private(&address) : -1, why = errno;
    if (folder >= 0)
        close(folder);
    errno = why;
    return fd;
}

bool control_system_is_socket(const char *path)
{
    struct stat found;
    return lstat(path, &found) == 0 && S_ISSOCK(found.st_mode);
}

bool control_system_is_alive(const char *path)
{
    struct sockaddr_un address;
    int folder, fd = -1;
    bool dead = socket_address_find(path, &address, &folder) &&
                (fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)) >= 0 &&
                connect(fd, (const struct sockaddr *)&address, sizeof address) != 0 && errno == ECONNREFUSED;
    if (fd >= 0)
        close(fd);
    if (folder >= 0)
        close(folder);
    return !dead;
}

bool control_system_is_gone(const uv_pipe_t *pipe)
{
    uv_os_fd_t fd;
    if (uv_fileno((const uv_handle_t *)pipe, &fd) != 0)
        return true;
    struct pollfd look = {.fd = fd};
    return poll(&look, 1, 0) > 0 && (look.revents & (POLLHUP | POLLERR)) != 0;
}

const char *control_system_instead(void)
{
    return NULL;
}
