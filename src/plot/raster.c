/* SPDX-License-Identifier: MIT */
#include "raster.h"

#include <errno.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char *reason_of(int wrong)
{
    return wrong != ENOENT ? strerror(wrong) :
                             "rsvg-convert is not installed: it is in the package librsvg2-bin; or ask for .svg";
}

const char *plot_rasterize(FILE *svg, FILE *png, unsigned scale)
{
    char zoom[16];
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status;
    snprintf(zoom, sizeof zoom, "%u", scale);
    char *const words[] = {(char *)"rsvg-convert", (char *)"--format", (char *)"png", (char *)"--zoom", zoom, NULL};
    if (fflush(png) != 0 || posix_spawn_file_actions_init(&actions) != 0)
        return strerror(errno);
    int wrong = posix_spawn_file_actions_adddup2(&actions, fileno(svg), STDIN_FILENO);
    if (wrong == 0)
        wrong = posix_spawn_file_actions_adddup2(&actions, fileno(png), STDOUT_FILENO);
    if (wrong == 0)
        wrong = posix_spawnp(&child, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (wrong != 0)
        return reason_of(wrong);
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return strerror(errno);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        return reason_of(ENOENT);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? NULL : "rsvg-convert has failed";
}
