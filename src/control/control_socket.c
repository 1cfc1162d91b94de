/* SPDX-License-Identifier: MIT */
#include "control_socket.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

#include "control_system.h"
#include "line/line.h"
#include "options/options.h"

static void report(const char *path)
{
    if (errno == ENAMETOOLONG)
        log_error("--control: cannot use %.100s: expected the path of a socket, its name (after the last /) at most %u "
                  "characters long, in an existing folder", path, SOCKET_NAME_SURE);
    else
        log_error("cannot make the control socket %s: %s; choose another --control", path, strerror(errno));
}

int control_socket_open(struct control_place *place, const char *path)
{
    if (!control_place_claim(place, path))
        return -1;
    int fd = control_system_bind(path);
    if (fd >= 0 && control_place_record(place))
        return fd;
    report(path);
    if (fd >= 0)
        close(fd);
    control_place_release(place);
    return -1;
}
