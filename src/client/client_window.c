/* SPDX-License-Identifier: MIT */
#include "client_window.h"

#include <err.h>
#include <limits.h>
#include <unistd.h>

#include "options/options.h"

enum exit_status client_window(char **argv)
{
    char path[PATH_MAX];
    if (!process_find_window(path)) {
        warnx("rkm04-window is not there: it was left out when this was built");
        return STATUS_FAILURE;
    }
    argv[1] = path;
    execv(path, argv + 1);
    warn("%s", path);
    return STATUS_FAILURE;
}
