/* SPDX-License-Identifier: MIT */
#include "process.h"

#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reading finds the end. Writing fails, as it would have: the descriptor is for reading only. */
static void fill_standard_streams(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) != fd)
            exit(EXIT_FAILURE);
}

static void unblock_signals(void)
{
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    sigaddset(&ends, SIGHUP);
    sigprocmask(SIG_UNBLOCK, &ends, NULL);
}

void process_begin(char **argv)
{
    (void)argv;
    fill_standard_streams();
    unblock_signals();
}

bool process_path_is_absolute(const char *path)
{
    return path[0] == '/';
}

bool process_find_window(char path[PATH_MAX])
{
    char self[PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", self, sizeof self - 1);
    if (length <= 0)
        return false;
    self[length] = '\0';
    int folder = (int)(strrchr(self, '/') - self);
    return (snprintf(path, PATH_MAX, "%.*s/rkm04-window", folder, self) < PATH_MAX && access(path, X_OK) == 0) ||
           (snprintf(path, PATH_MAX, "%.*s/../libexec/rkm04/rkm04-window", folder, self) < PATH_MAX && access(path, X_OK) == 0);
}
