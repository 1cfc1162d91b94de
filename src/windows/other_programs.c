/* SPDX-License-Identifier: MIT */
/* other_programs.c: programs that ours run: diff of `rkm04 fmt --diff', rsvg-convert of `rkm04 plot -o FILE.png'. */
#include <errno.h>
#include <process.h>
#include <windows.h>

#include "plot/raster.h"
#include "program_tools/text_diff.h"

#define PATH_SIZE (MAX_PATH + 32)

/* A temporary file with this text; its name is in `path`. Returns whether it is there. */
static bool make_file(char path[PATH_SIZE], const char *text, size_t length)
{
    DWORD folder = GetTempPathA(MAX_PATH, path); /* ends with a \ */
    strcpy(path + (folder < MAX_PATH ? folder : 0), "rkm04-XXXXXX");
    int fd = mkostemp(path, 0);
    if (fd < 0)
        return false;
    bool written = write(fd, text, (unsigned)length) == (ssize_t)length;
    close(fd);
    return written;
}

/* Folders of users may have blanks. */
static const char *quote(const char *path, char quoted[PATH_SIZE + 2])
{
    snprintf(quoted, PATH_SIZE + 2, "\"%s\"", path);
    return quoted;
}

bool text_diff(const char *name, const char *before, size_t before_length, const char *after, size_t after_length)
{
    char left[PATH_SIZE] = "", right[PATH_SIZE] = "", quoted[2][PATH_SIZE + 2], label[2][512];
    snprintf(label[0], sizeof label[0], "--label=\"%s\"", name);
    snprintf(label[1], sizeof label[1], "--label=\"%s (formatted)\"", name);
    fflush(stdout);
    intptr_t status = -1;
    if (make_file(left, before, before_length) && make_file(right, after, after_length))
        status = _spawnlp(_P_WAIT, "diff", "diff", "-u", label[0], label[1], quote(left, quoted[0]), quote(right, quoted[1]),
                          NULL);
    int error = errno;
    unlink(left);
    unlink(right);
    if (status < 0 || status > 1)
        fprintf(stderr, "rkm04 fmt: cannot run diff: %s\n", strerror(status < 0 ? error : EIO));
    return status == 0 || status == 1;
}

const char *plot_rasterize(FILE *svg, FILE *png, unsigned scale)
{
    char zoom[16];
    snprintf(zoom, sizeof zoom, "%u", scale);
    if (fflush(png) != 0)
        return strerror(errno);
    int in = dup(STDIN_FILENO), out = dup(STDOUT_FILENO);
    lseek(fileno(svg), 0, SEEK_SET);
    dup2(fileno(svg), STDIN_FILENO);
    dup2(fileno(png), STDOUT_FILENO);
    intptr_t status = _spawnlp(_P_WAIT, "rsvg-convert", "rsvg-convert", "--format", "png", "--zoom", zoom, NULL);
    dup2(in, STDIN_FILENO);
    dup2(out, STDOUT_FILENO);
    close(in);
    close(out);
    if (status < 0)
        return "rsvg-convert is not installed; ask for .svg";
    return status == 0 ? NULL : "rsvg-convert has failed";
}
