/* SPDX-License-Identifier: MIT */
#include "link_path.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "lock_file.h"
#include "log.h"

#define RECORD "rkm04 process %ld, pty %63s" /* in the lock file: whose the link is, and where it leads */

/* ---- The default ---------------------------------------------------------------------------------------------------- */

/* Make the folder, for its owner alone; one that is there must be such a one. */
static bool is_private_folder(const char *path)
{
    struct stat found;
    if (mkdir(path, 0700) != 0 && errno != EEXIST)
        return false;
    if (lstat(path, &found) != 0)
        return false;
    if (!S_ISDIR(found.st_mode) || found.st_uid != geteuid()) {
        errno = EPERM;
        return false;
    }
    return (found.st_mode & 077) == 0 || chmod(path, 0700) == 0;
}

/* The folder of default names. Returns false if there is none (reported). */
static bool default_folder(char folder[PATH_MAX])
{
    const char *base = getenv("XDG_RUNTIME_DIR");
    if (base && base[0] == '/' && snprintf(folder, PATH_MAX, "%s/rkm04", base) < PATH_MAX && is_private_folder(folder))
        return true;
    base = getenv("TMPDIR");
    if (!base || base[0] != '/')
        base = "/tmp";
    if (snprintf(folder, PATH_MAX, "%s/rkm04-%lu", base, (unsigned long)geteuid()) >= PATH_MAX) {
        log_error("the name of the temporary directory is too long: set TMPDIR, or give --link PATH or --control PATH");
        return false;
    }
    if (is_private_folder(folder))
        return true;
    log_error("cannot use the folder %s: %s; give --link PATH or --control PATH", folder,
              errno == EPERM ? "it is not a folder that you own" : strerror(errno));
    return false;
}

bool link_path_default(char path[PATH_MAX], const char *name)
{
    char folder[PATH_MAX];
    if (!default_folder(folder))
        return false;
    if (snprintf(path, PATH_MAX, "%s/%s", folder, name) < PATH_MAX)
        return true;
    log_error("the path of the folder %s is too long: give --link PATH or --control PATH", folder);
    return false;
}

/* ---- The lock ------------------------------------------------------------------------------------------------------- */

/* Find the target of the link in a record. Returns false if it is none; an empty one (we made the file) has an empty target. */
static bool read_record(const char *record, char target[64])
{
    long pid;
    target[0] = '\0';
    return record[0] == '\0' || sscanf(record, RECORD, &pid, target) == 2;
}

/* ---- The link ------------------------------------------------------------------------------------------------------- */

/* Does the link at `path` lead to `target`? */
static bool is_link_to(const char *path, const char *target)
{
    char found[64];
    ssize_t length = readlink(path, found, sizeof found);
    return length > 0 && (size_t)length < sizeof found && (size_t)length == strlen(target) &&
           memcmp(found, target, (size_t)length) == 0;
}

/* Remove what a killed emulator has left. Returns false if something else is there (reported). */
static bool clear_stale(const struct link_path *link, const char *target)
{
    struct stat found;
    if (lstat(link->path, &found) != 0)
        return true;
    if (target[0] && is_link_to(link->path, target) && unlink(link->path) == 0)
        return true;
    log_error("%s exists and is not the link of an emulator: remove it, or choose another --link",
              link->path);
    return false;
}

bool link_path_claim(struct link_path *link, const char *path, unsigned number)
{
    char record[LOCK_RECORD_MAX], target[64], name[16];
    *link = (struct link_path){.lock = -1};
    snprintf(name, sizeof name, "bus%u", number);
    if (!path && !link_path_default(link->path, name))
        return false;
    if (path && snprintf(link->path, sizeof link->path, "%s", path) >= (int)sizeof link->path) {
        log_error("--link: the path is too long");
        return false;
    }
    if (snprintf(link->lock_path, sizeof link->lock_path, "%s.lock", link->path) >= (int)sizeof link->lock_path) {
        log_error("--link: the path is too long");
        return false;
    }
    link->lock = lock_file_take(link->lock_path, record);
    if (link->lock < 0) {
        if (errno == EWOULDBLOCK)
            log_error("another emulator (%s) uses the link %s: end it, or choose another --link",
                      record[0] ? record : "about to start", link->path);
        else
            log_error("cannot lock %s: %s; choose a --link in an existing folder that you can write to",
                      link->lock_path, lock_file_reason(errno));
        return false;
    }
    if (!read_record(record, target)) {
        log_error("%s is not a lock file of an emulator: remove it, or choose another --link", link->lock_path);
        lock_file_release(&link->lock);
        return false;
    }
    if (!clear_stale(link, target)) {
        lock_file_remove(link->lock_path, &link->lock);
        return false;
    }
    return true;
}

bool link_path_make(struct link_path *link, const char *target)
{
    /* The record first: a link without it would not be known as ours. symlink() is atomic and replaces nothing. */
    if (!lock_file_write(link->lock, "rkm04 process %ld, pty %s", (long)getpid(), target) ||
        symlink(target, link->path) != 0) {
        log_error("cannot make the link %s: %s; choose another --link", link->path, strerror(errno));
        return false;
    }
    snprintf(link->target, sizeof link->target, "%s", target);
    return true;
}

void link_path_hide(struct link_path *link)
{
    if (link->target[0] && is_link_to(link->path, link->target))
        unlink(link->path);
    link->target[0] = '\0';
}

void link_path_release(struct link_path *link)
{
    if (link->lock < 0)
        return;
    link_path_hide(link);
    lock_file_remove(link->lock_path, &link->lock);
}
