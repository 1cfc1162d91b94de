/* SPDX-License-Identifier: MIT */
#include "control_place.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "control_system.h"
#include "line/line.h"

#define RECORD "rkm04 process %ld, control socket %ju:%ju" /* in the lock file: whose it is; device and number of the file */

bool control_place_record(struct control_place *place)
{
    struct stat made;
    if (lstat(place->path, &made) != 0)
        return false;
    place->device = made.st_dev;
    place->inode = made.st_ino;
    return lock_file_write(place->lock, RECORD, (long)getpid(), (uintmax_t)made.st_dev, (uintmax_t)made.st_ino);
}

/* Does it begin as a control file? One that a full disk has cut is one, too. */
static bool is_file(const char *path)
{
    static const char begin[] = CONTROL_FILE_BEGIN;
    char text[sizeof begin];
    struct stat found;
    int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    bool ok = fd >= 0 && fstat(fd, &found) == 0 && S_ISREG(found.st_mode);
    ssize_t length = ok ? read(fd, text, sizeof begin - 1) : -1;
    if (fd >= 0)
        close(fd);
    return length >= 0 && memcmp(text, begin, (size_t)length) == 0;
}

/* Is it the socket or file that an emulator has made? */
static bool is_made(const char *path, uintmax_t device, uintmax_t inode)
{
    struct stat found;
    return lstat(path, &found) == 0 && found.st_dev == device && found.st_ino == inode &&
           (control_system_is_socket(path) || is_file(path));
}

static bool is_alive(const char *path)
{
    return control_system_is_socket(path) && control_system_is_alive(path);
}

/* Remove what a killed emulator has left. Returns false if something else is there (reported). */
static bool clear_stale(const struct control_place *place, const char *record)
{
    struct stat found;
    long pid;
    uintmax_t device, inode;
    if (lstat(place->path, &found) != 0 && errno == ENOENT)
        return true;
    if (sscanf(record, RECORD, &pid, &device, &inode) == 3 && is_made(place->path, device, inode) &&
        !is_alive(place->path) && unlink(place->path) == 0)
        return true;
    log_error("%s exists and is not the control socket of an emulator: remove it, or choose another "
              "--control", place->path);
    return false;
}

static bool take_lock(struct control_place *place)
{
    char record[LOCK_RECORD_MAX];
    place->lock = lock_file_take(place->lock_path, record);
    if (place->lock < 0) {
        if (errno == EWOULDBLOCK)
            log_error("another emulator (%s) uses the control socket %s: end it, or choose another --control",
                      record[0] ? record : "about to start", place->path);
        else
            log_error("cannot lock %s: %s; choose a --control in an existing folder that you can write to",
                      place->lock_path, lock_file_reason(errno));
        return false;
    }
    long pid;
    uintmax_t device, inode;
    if (record[0] != '\0' && sscanf(record, RECORD, &pid, &device, &inode) != 3) {
        log_error("%s is not a lock file of an emulator: remove it, or choose another --control", place->lock_path);
        lock_file_release(&place->lock);
        return false;
    }
    if (!clear_stale(place, record)) {
        lock_file_remove(place->lock_path, &place->lock);
        return false;
    }
    return true;
}

bool control_place_claim(struct control_place *place, const char *path)
{
    *place = (struct control_place){.lock = -1};
    if (path[0] == '\0') {
        log_error("--control: expected a path, found nothing");
        return false;
    }
    if (snprintf(place->path, sizeof place->path, "%s", path) < (int)sizeof place->path &&
        snprintf(place->lock_path, sizeof place->lock_path, "%s.lock", path) < (int)sizeof place->lock_path)
        return take_lock(place);
    log_error("--control: the path %.100s... is too long", path);
    return false;
}

void control_place_release(struct control_place *place)
{
    if (place->lock < 0)
        return;
    if (place->inode != 0 && is_made(place->path, place->device, place->inode))
        unlink(place->path);
    lock_file_remove(place->lock_path, &place->lock);
}
