/* SPDX-License-Identifier: MIT */
#include "socket_address.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

bool socket_address_find(const char *path, struct sockaddr_un *address, int *folder)
{
    size_t room = sizeof address->sun_path, length = strlen(path);
    *folder = -1;
    *address = (struct sockaddr_un){.sun_family = AF_UNIX};
    if (length > 0 && length < room) {
        memcpy(address->sun_path, path, length + 1);
        return true;
    }
    const char *slash = strrchr(path, '/');
    errno = ENAMETOOLONG;
    if (!slash || slash == path || length >= PATH_MAX)
        return false;
    char name[PATH_MAX];
    snprintf(name, sizeof name, "%.*s", (int)(slash - path), path);
    *folder = open(name, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (*folder < 0)
        return false;
    errno = ENAMETOOLONG;
    return snprintf(address->sun_path, room, "/proc/self/fd/%d%s", *folder, slash) < (int)room;
}
