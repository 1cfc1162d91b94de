/* SPDX-License-Identifier: MIT */
#include "raster.h"

#include <errno.h>
#include <fcntl.h>
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

/* What comes out of the pipe goes to the picture: rsvg-convert does not notice that a disk is full. */
static const char *copy_picture(int from, FILE *png)
{
    char bytes[65536];
    ssize_t got;
    while ((got = read(from, bytes, sizeof bytes)) > 0 || (got < 0 && errno == EINTR))
        if (got > 0 && fwrite(bytes, 1, (size_t)got, png) != (size_t)got)
            return strerror(errno);
    return got < 0 || fflush(png) != 0 ? strerror(errno) : NULL;
}

static int begin_convert(FILE *svg, int out, unsigned scale, pid_t *child)
{
    char zoom[16];
    posix_spawn_file_actions_t actions;
    snprintf(zoom, sizeof zoom, "%u", scale);
    char *const words[] = {(char *)"rsvg-convert", (char *)"--format", (char *)"png", (char *)"--zoom", zoom, NULL};
    int wrong = posix_spawn_file_actions_init(&actions);
    if (wrong != 0)
        return wrong;
    wrong = posix_spawn_file_actions_adddup2(&actions, fileno(svg), STDIN_FILENO);
    if (wrong == 0)
        wrong = posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    if (wrong == 0)
        wrong = posix_spawnp(child, words[0], &actions, NULL, words, environ);
    posix_spawn_file_actions_destroy(&actions);
    return wrong;
}

const char *plot_rasterize(FILE *svg, FILE *png, unsigned scale)
{
    pid_t child;
    int ends[2], status;
    if (fflush(png) != 0 || pipe2(ends, O_CLOEXEC) != 0)
        return strerror(errno);
    const int wrong = begin_convert(svg, ends[1], scale, &child);
    close(ends[1]);
    const char *why = wrong == 0 ? copy_picture(ends[0], png) : reason_of(wrong);
    close(ends[0]);
    if (wrong != 0)
        return why;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return strerror(errno);
    if (why != NULL)
        return why;
    if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
        return reason_of(ENOENT);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? NULL : "rsvg-convert has failed";
}
