/* SPDX-License-Identifier: MIT */
#include "text_diff.h"

#include <errno.h>
#include <spawn.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

/* A file in memory with this text. Returns its descriptor, -1: errno. */
static int make_file(const char *text, size_t length)
{
    int file = memfd_create("text", 0);
    size_t written = 0;
    while (file >= 0 && written < length) {
        ssize_t more = write(file, text + written, length - written);
        if (more < 0 && errno == EINTR)
            continue;
        if (more <= 0) {
            close(file);
            return -1;
        }
        written += (size_t)more;
    }
    return file;
}

/* Returns 0, or an error number. */
static int run_diff(const char *name, int before, int after)
{
    char left[32], right[32], label[2][512];
    int status;
    pid_t process;
    snprintf(left, sizeof left, "/dev/fd/%d", before);
    snprintf(right, sizeof right, "/dev/fd/%d", after);
    snprintf(label[0], sizeof label[0], "--label=%s", name);
    snprintf(label[1], sizeof label[1], "--label=%s (formatted)", name);
    char *arguments[] = {(char[]){"diff"}, (char[]){"-u"}, label[0], label[1], left, right, NULL};
    fflush(stdout);
    int wrong = posix_spawnp(&process, "diff", NULL, NULL, arguments, environ);
    if (wrong != 0)
        return wrong;
    while (waitpid(process, &status, 0) < 0)
        if (errno != EINTR)
            return errno;
    return WIFEXITED(status) && WEXITSTATUS(status) < 2 ? 0 : EIO;
}

bool text_diff(const char *name, const char *before, size_t before_length, const char *after, size_t after_length)
{
    int left = make_file(before, before_length), right = make_file(after, after_length);
    int wrong = left < 0 || right < 0 ? errno : run_diff(name, left, right);
    if (left >= 0)
        close(left);
    if (right >= 0)
        close(right);
    if (wrong != 0)
        fprintf(stderr, "rkm04 fmt: cannot run diff: %s\n", strerror(wrong));
    return wrong == 0;
}
