/* SPDX-License-Identifier: MIT */
#include "output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file that the process reads, has written, or writes. Descriptors and files belong to the process, and so does this list. */
struct use {
    dev_t device;
    ino_t inode;
    int fd;    /* open for writing; -1: spared */
    bool made; /* it was not there before */
    const struct output_kind *reserved; /* output_file_reserve() with that kind; NULL: not */
    char *path; /* "-": standard input */
    struct use *next;
};

static struct use *uses;

/* Returns false, for the callers' convenience. */
__attribute__((format(printf, 2, 3))) static bool explain(char **why, const char *format, ...)
{
    va_list values;
    va_start(values, format);
    if (vasprintf(why, format, values) < 0)
        *why = NULL;
    va_end(values);
    return false;
}

/* The same with an errno. */
static bool explain_error(char **why, int error)
{
    return explain(why, "%s", strerror(error));
}

/* ---- Files in use --------------------------------------------------------------------------------------------------- */

static bool is_file(const struct use *use, const struct stat *status)
{
    return use->device == status->st_dev && use->inode == status->st_ino;
}

static int stat_input(const char *path, struct stat *status)
{
    return strcmp(path, "-") == 0 ? fstat(STDIN_FILENO, status) : stat(path, status);
}

/* The number of a file that was spared and is gone may have been given to another one. */
static bool is_in_use(const struct use *use, const struct stat *status)
{
    struct stat present;
    return is_file(use, status) && (use->fd >= 0 || (stat_input(use->path, &present) == 0 && is_file(use, &present)));
}

static bool add_use(const struct stat *status, int fd, const char *path)
{
    struct use *use = malloc(sizeof *use);
    char *copy = strdup(path);
    if (!use || !copy) {
        free(use);
        free(copy);
        return false;
    }
    *use = (struct use){.device = status->st_dev, .inode = status->st_ino, .fd = fd, .path = copy, .next = uses};
    uses = use;
    return true;
}

static bool is_open_at(int fd, const struct stat *status)
{
    struct stat open;
    return fstat(fd, &open) == 0 && open.st_dev == status->st_dev && open.st_ino == status->st_ino;
}

/* Is the regular file used for nothing else? `written`: only files that are written count. */
static bool check_free(const struct stat *status, const char *path, bool written, char **why)
{
    static const char same_file[] = "it is the same file as %s, which is %s: choose another name";
    for (const struct use *use = uses; use; use = use->next) {
        const char *how = use->fd >= 0 ? "written" : "read";
        if ((written && use->fd < 0) || !is_in_use(use, status))
            continue;
        if (strcmp(use->path, path) == 0)
            return explain(why, "it is %s: choose another name", use->fd >= 0 ? "being written already" : "read, too");
        return explain(why, same_file, strcmp(use->path, "-") == 0 ? "standard input" : use->path, how);
    }
    if (is_open_at(STDOUT_FILENO, status))
        return explain(why, same_file, "standard output", "written");
    if (is_open_at(STDERR_FILENO, status))
        return explain(why, same_file, "standard error", "written");
    return true;
}

bool output_file_spare(const char *path)
{
    struct stat status;
    if (stat_input(path, &status) != 0 || !S_ISREG(status.st_mode))
        return true;
    for (const struct use *use = uses; use; use = use->next)
        if (use->fd < 0 && is_in_use(use, &status))
            return true;
    return add_use(&status, -1, path);
}

bool output_file_claim(int fd, const char *path, char **why)
{
    struct stat status;
    *why = NULL;
    if (fstat(fd, &status) != 0)
        return explain_error(why, errno);
    return check_free(&status, path, false, why) && add_use(&status, fd, path);
}

void output_file_release(int fd)
{
    for (struct use **at = &uses; *at; at = &(*at)->next) {
        struct use *use = *at;
        if (use->fd != fd)
            continue;
        *at = use->next;
        free(use->path);
        free(use);
        return;
    }
}

/* ---- Open and close ------------------------------------------------------------------------------------------------- */

static bool check_kind(int fd, const struct output_kind *kind, unsigned flags, char **why)
{
    char bytes[OUTPUT_KIND_BYTES];
    ssize_t length = pread(fd, bytes, sizeof bytes, 0); /* -1: it may be written, but not read */
    if ((flags & OUTPUT_FORCE) || (length >= 0 && output_kind_is(kind, bytes, (size_t)length)))
        return true;
    return explain(why, "it exists and is not %s: choose another name, or overwrite it with %s", kind->name,
                   flags & OUTPUT_REQUESTED ? "`force': true (rkmctl --force)" : "--force");
}

/* Traces, logs of the wires and recordings show all that a host does: they are made for their owner alone, whatever the umask.
 * Make a file of that name. Returns -1 if there is one already, or errno says why not. */
static int make_output(const char *path, int how, const struct output_kind *kind)
{
    int fd = open(path, how | O_RDWR | O_CREAT | O_EXCL, kind->is_report ? 0666 : 0600);
    if (fd >= 0 && !kind->is_report)
        (void)fchmod(fd, 0600); /* not every file system has modes */
    return fd;
}

/* Regular files are opened for reading, too, to check their kind; a pipe must not be, or it would need no reader. */
static int open_output(const char *path, const struct output_kind *kind, unsigned flags, bool *made)
{
    struct stat there;
    int how = O_CLOEXEC | O_NOCTTY | (flags & OUTPUT_MAY_WAIT ? 0 : O_NONBLOCK);
    *made = stat(path, &there) != 0;
    if (!*made && !S_ISREG(there.st_mode))
        return open(path, how | O_WRONLY);
    int fd = make_output(path, how, kind);
    if (fd < 0 && errno == EEXIST)
        fd = open(path, how | O_RDWR | O_CREAT, kind->is_report ? 0666 : 0600); /* it may be a link to where nothing is */
    if (fd >= 0 || errno != EACCES)
        return fd;
    fd = open(path, how | O_WRONLY);
    if (fd < 0 && errno == ENOENT)
        errno = EACCES; /* it could not be made */
    return fd;
}

/* See that what was opened may be written, and make a regular file ours. */
static bool take_output(int fd, const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    struct stat status;
    if (fstat(fd, &status) != 0)
        return explain_error(why, errno);
    if (S_ISCHR(status.st_mode) || (S_ISFIFO(status.st_mode) && (flags & OUTPUT_MAY_WAIT)))
        return true;
    if (!S_ISREG(status.st_mode))
        return explain(why, "it is not a regular file: choose another name");
    if (!check_free(&status, path, false, why) || !check_kind(fd, kind, flags, why))
        return false;
    if (status.st_size > 0 && !(flags & OUTPUT_KEEP) && ftruncate(fd, 0) != 0)
        return explain_error(why, errno);
    return add_use(&status, fd, path);
}

/* Returns a descriptor of a file that is ours, or -1. */
static int open_and_take(const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    bool made;
    int fd = open_output(path, kind, flags, &made);
    if (fd < 0) {
        explain_error(why, errno);
        return -1;
    }
    if (take_output(fd, path, kind, flags, why)) {
        if (made)
            output_file_made(fd);
        return fd;
    }
    close(fd);
    return -1;
}

static struct use *find_use(int fd)
{
    struct use *use = uses;
    while (use && use->fd != fd)
        use = use->next;
    return use;
}

void output_file_made(int fd)
{
    struct use *use = find_use(fd);
    if (use)
        use->made = true;
}

bool output_file_reserve(const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    *why = NULL;
    int fd = open_and_take(path, kind, flags | OUTPUT_KEEP, why);
    struct use *use = fd >= 0 ? find_use(fd) : NULL;
    if (use)
        use->reserved = kind;
    else if (fd >= 0)
        close(fd); /* a device */
    return fd >= 0;
}

/* The descriptor of a reserved file, which is emptied now, or -1. */
static int take_reserved(const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    struct use *use = uses;
    while (use && !(use->reserved == kind && strcmp(use->path, path) == 0))
        use = use->next;
    if (!use)
        return -1;
    if (!(flags & OUTPUT_KEEP) && ftruncate(use->fd, 0) != 0) {
        explain_error(why, errno);
        return -1;
    }
    use->reserved = NULL;
    return use->fd;
}

FILE *output_file_open(const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    *why = NULL;
    int fd = take_reserved(path, kind, flags, why);
    if (fd < 0 && !*why)
        fd = open_and_take(path, kind, flags, why);
    if (fd < 0)
        return NULL;
    FILE *file = fdopen(fd, "w");
    if (file)
        return file;
    output_file_release(fd);
    close(fd);
    return NULL;
}

static void remove_file(const struct use *use)
{
    struct stat there;
    char *real = realpath(use->path, NULL); /* a link may have been there before */
    if (real && stat(real, &there) == 0 && is_file(use, &there))
        unlink(real);
    free(real);
}

void output_files_undo(void)
{
    struct use *next;
    for (struct use *use = uses; use; use = next) {
        int fd = use->fd;
        next = use->next;
        if (use->made)
            remove_file(use);
        if (!use->reserved)
            continue;
        output_file_release(fd);
        close(fd);
    }
}

bool output_file_empty(FILE *file)
{
    struct stat status;
    if (fstat(fileno(file), &status) != 0)
        return false;
    return !S_ISREG(status.st_mode) || ftruncate(fileno(file), 0) == 0;
}

int output_file_close(FILE *file)
{
    const bool has_failed = ferror(file) != 0;
    output_file_release(fileno(file));
    if (fclose(file) != 0)
        return EOF;
    if (has_failed)
        errno = EIO;
    return has_failed ? EOF : 0;
}

/* ---- Replace -------------------------------------------------------------------------------------------------------- */

/* May what has that name, if anything does, be replaced? */
static bool check_replaced(const char *path, const struct output_kind *kind, unsigned flags, char **why)
{
    struct stat status;
    if (lstat(path, &status) != 0)
        return errno == ENOENT || explain_error(why, errno);
    if (!S_ISREG(status.st_mode))
        return explain(why, "it is not a regular file: choose another name");
    if (!check_free(&status, path, true, why))
        return false;
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOCTTY | O_NOFOLLOW | O_NONBLOCK);
    bool ok = check_kind(fd, kind, flags, why);
    if (fd >= 0)
        close(fd);
    return ok;
}

/* A new file in the folder of `path`, whose name is in *name, to be freed. Returns NULL if there is none; errno says why. */
static FILE *make_beside(const char *path, char **name)
{
    const char *slash = strrchr(path, '/');
    int folder = slash ? (int)(slash - path) + 1 : 0;
    if (asprintf(name, "%.*s.rkm04-XXXXXX", folder, path) < 0) {
        *name = NULL;
        errno = ENOMEM;
        return NULL;
    }
    int fd = mkostemp(*name, O_CLOEXEC);
    if (fd >= 0)
        (void)fchmod(fd, 0600);
    FILE *file = fd >= 0 ? fdopen(fd, "w") : NULL;
    if (!file && fd >= 0) {
        int error = errno;
        close(fd);
        unlink(*name);
        errno = error;
    }
    return file;
}

bool output_file_replace(const char *path, const struct output_kind *kind, unsigned flags,
                         bool (*write)(void *context, FILE *out), void *context, char **why)
{
    char *name = NULL;
    *why = NULL;
    if (!check_replaced(path, kind, flags, why))
        return false;
    FILE *file = make_beside(path, &name);
    bool ok = file && write(context, file);
    int error = errno;
    if (file && fclose(file) != 0 && ok) {
        ok = false;
        error = errno;
    }
    if (ok && rename(name, path) != 0) {
        ok = false;
        error = errno;
    }
    if (!ok && file)
        unlink(name);
    free(name);
    return ok || explain_error(why, error);
}
