/* SPDX-License-Identifier: MIT */
#include "control_socket.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "line/line.h"
#include "options/options.h"

#define RECORD "rkm04 process %ld, control socket %ju:%ju" /* in the lock file: whose it is; device and number of the file */

/* Report in the lock file which socket is ours. */
static bool write_record(struct control_socket *control)
{
    struct stat made;
    if (lstat(control->path, &made) != 0)
        return false;
    control->device = made.st_dev;
    control->inode = made.st_ino;
    return lock_file_write(control->lock, RECORD, (long)getpid(), (uintmax_t)made.st_dev, (uintmax_t)made.st_ino);
}

/* ---- What is there -------------------------------------------------------------------------------------------------- */

static bool is_socket(const char *path, uintmax_t device, uintmax_t inode)
{
    struct stat found;
    return lstat(path, &found) == 0 && S_ISSOCK(found.st_mode) && found.st_dev == device && found.st_ino == inode;
}

/* Does no process listen any more? */
static bool is_dead(const struct sockaddr_un *address)
{
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    bool dead = fd >= 0 && connect(fd, (const struct sockaddr *)address, sizeof *address) != 0 && errno == ECONNREFUSED;
    if (fd >= 0)
        close(fd);
    return dead;
}

/* Remove what a killed emulator has left. Returns false if something else is there (reported). */
static bool clear_stale(const struct control_socket *control, const struct sockaddr_un *address, const char *record)
{
    struct stat found;
    long pid;
    uintmax_t device, inode;
    if (lstat(control->path, &found) != 0 && errno == ENOENT)
        return true;
    if (sscanf(record, RECORD, &pid, &device, &inode) == 3 && is_socket(control->path, device, inode) && is_dead(address) &&
        unlink(control->path) == 0)
        return true;
    log_error("%s exists and is not the control socket of an emulator: remove it, or choose another "
              "--control", control->path);
    return false;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool claim_socket(struct control_socket *control, const struct sockaddr_un *address)
{
    char record[LOCK_RECORD_MAX];
    control->lock = lock_file_take(control->lock_path, record);
    if (control->lock < 0) {
        if (errno == EWOULDBLOCK)
            log_error("another emulator (%s) uses the control socket %s: end it, or choose another --control",
                      record[0] ? record : "about to start", control->path);
        else
            log_error("cannot lock %s: %s; choose a --control in an existing folder that you can write to",
                      control->lock_path, lock_file_reason(errno));
        return false;
    }
    long pid;
    uintmax_t device, inode;
    if (record[0] != '\0' && sscanf(record, RECORD, &pid, &device, &inode) != 3) {
        log_error("%s is not a lock file of an emulator: remove it, or choose another --control", control->lock_path);
        lock_file_release(&control->lock);
        return false;
    }
    if (!clear_stale(control, address, record)) {
        lock_file_remove(control->lock_path, &control->lock);
        return false;
    }
    return true;
}

/* Mode 0600 from the beginning: there is no moment at which others could connect. bind() makes a file and follows no link. */
static bool bind_private(struct control_socket *control, const struct sockaddr_un *address)
{
    control->fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    mode_t mask = umask(0177);
    bool bound = control->fd >= 0 && bind(control->fd, (const struct sockaddr *)address, sizeof *address) == 0;
    int why = errno;
    umask(mask);
    errno = why;
    return bound && write_record(control);
}

static bool make_socket(struct control_socket *control, const struct sockaddr_un *address)
{
    if (!claim_socket(control, address))
        return false;
    if (bind_private(control, address))
        return true;
    log_error("cannot make the control socket %s: %s; choose another --control", control->path, strerror(errno));
    if (control->fd >= 0)
        close(control->fd);
    control->fd = -1;
    control_socket_release(control);
    return false;
}

bool control_socket_open(struct control_socket *control, const char *path)
{
    struct sockaddr_un address;
    int folder;
    *control = (struct control_socket){.lock = -1, .fd = -1};
    bool ok = socket_address_find(path, &address, &folder) &&
                snprintf(control->path, sizeof control->path, "%s", path) < (int)sizeof control->path &&
                snprintf(control->lock_path, sizeof control->lock_path, "%s.lock", path) < (int)sizeof control->lock_path;
    if (ok)
        ok = make_socket(control, &address);
    else
        log_error("--control: cannot use %.100s: expected the path of a socket, its name (after the last /) at most %u "
                  "characters long, in an existing folder", path[0] ? path : "an empty path", SOCKET_NAME_SURE);
    if (folder >= 0)
        close(folder);
    return ok;
}

void control_socket_release(struct control_socket *control)
{
    if (control->lock < 0)
        return;
    if (control->inode != 0 && is_socket(control->path, control->device, control->inode))
        unlink(control->path);
    lock_file_remove(control->lock_path, &control->lock);
}
