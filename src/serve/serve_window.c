/* SPDX-License-Identifier: MIT */
#include "serve_window.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <spawn.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include "line/line.h"
#include "options/options.h"

extern char **environ;

/* Words of a command line are not changed. */
static char *word(const char *text)
{
    return (char *)(uintptr_t)text;
}

int serve_window_start(const char *control, const char *address)
{
    char path[PATH_MAX];
    int ends[2];
    if (!process_find_window(path)) {
        log_error("--window: rkm04-window is not there: it was left out when this was built");
        return -1;
    }
    if (pipe2(ends, O_CLOEXEC) != 0) {
        log_error("cannot make a pipe: %s", strerror(errno));
        return -1;
    }
    char *const words[] = {word("rkm04-window"), word("--bound"), word("--control"), word(control), word("--http"), word(address),
                           NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    int error = posix_spawn(&child, path, &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    if (error == 0)
        return ends[1];
    close(ends[1]);
    log_error("cannot start %s: %s", path, strerror(error));
    return -1;
}

void serve_window_show(int descriptor)
{
    if (write(descriptor, "\n", 1) != 1)
        log_error("the window has ended");
}
