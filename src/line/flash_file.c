/* SPDX-License-Identifier: MIT */
#include "flash_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "file/file.h"
#include "log.h"

#define ERASED 0xff

/* ---- Opening -------------------------------------------------------------------------------------------------------- */

/* See that the name of a new file is on the disk, too. Not every file system can do that. */
static void sync_folder(const char *path)
{
    const char *slash = strrchr(path, '/');
    char folder[PATH_MAX] = ".";
    if (slash)
        snprintf(folder, sizeof folder, "%.*s", slash == path ? 1 : (int)(slash - path), path);
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0)
        return;
    (void)fsync(fd);
    close(fd);
}

static unsigned size_of(const struct flash_file *flash)
{
    return flash->blocks * flash->block_size;
}

/* Write an erased flash to the new file, which is empty or was left unfinished. */
static bool make_image(struct flash_file *flash)
{
    static uint8_t bytes[DEVICE_FLASH_BLOCKS_MAX * DEVICE_FLASH_BLOCK_MAX];
    memset(bytes, ERASED, size_of(flash));
    ssize_t written = pwrite(flash->fd, bytes, size_of(flash), 0);
    if (written == (ssize_t)size_of(flash) && fsync(flash->fd) == 0) {
        sync_folder(flash->path);
        return true;
    }
    bool full = written >= 0 && written < (ssize_t)size_of(flash);
    log_error("cannot write the %s image %s: %s", flash->name, flash->path, full ? "the disk is full" : strerror(errno));
    if (ftruncate(flash->fd, 0) != 0)
        log_error("%s is incomplete: remove it", flash->path);
    return false;
}

/* Is there nothing in the file but the beginning of an erased flash? Then its making was cut. */
static bool is_unfinished(const struct flash_file *flash, off_t size)
{
    static uint8_t bytes[DEVICE_FLASH_BLOCKS_MAX * DEVICE_FLASH_BLOCK_MAX];
    if (size >= (off_t)size_of(flash) || pread(flash->fd, bytes, size_of(flash), 0) != (ssize_t)size)
        return false;
    for (off_t i = 0; i < size; i++)
        if (bytes[i] != ERASED)
            return false;
    return true;
}

/* What a killed process left unsynced has to be on the disk before anything is written on the strength of it. */
static bool sync_image(const struct flash_file *flash)
{
    if (fdatasync(flash->fd) == 0)
        return true;
    log_error("cannot write the %s image %s: %s", flash->name, flash->path, strerror(errno));
    return false;
}

/* Is the open file an image, or about to be one, and ours alone? */
static bool check_image(struct flash_file *flash)
{
    struct stat found;
    char *why;
    if (fstat(flash->fd, &found) != 0 || !S_ISREG(found.st_mode)) {
        log_error("--%s: %s is not a file: expected a %s image of %u bytes, or a new name", flash->name, flash->path,
                  flash->name, size_of(flash));
        return false;
    }
    if (!output_file_claim(flash->fd, flash->path, &why)) {
        log_error("cannot use the %s image %s: %s", flash->name, flash->path, why ? why : strerror(ENOMEM));
        free(why);
        return false;
    }
    if (flock(flash->fd, LOCK_EX | LOCK_NB) != 0) {
        log_error("another emulator uses the %s image %s: end it, or choose another --%s", flash->name, flash->path, flash->name);
        return false;
    }
    /* The size under the lock: it may have been made just now. */
    if (fstat(flash->fd, &found) == 0 && is_unfinished(flash, found.st_size))
        return make_image(flash);
    if (found.st_size == (off_t)size_of(flash))
        return sync_image(flash);
    log_error("%s has %lld bytes and is no %s image: expected %u bytes, or a new name", flash->path,
              (long long)found.st_size, flash->name, size_of(flash));
    return false;
}

/* For its owner alone, whatever the umask. */
static int make_private(const char *path, int flags)
{
    int fd = open(path, flags | O_CREAT | O_EXCL, 0600);
    if (fd >= 0)
        (void)fchmod(fd, 0600); /* not every file system has modes */
    return fd;
}

/* Open the file, or make it; what is made is a file of that very name, never one that a link leads to. */
static int open_or_make(const char *path, bool *made)
{
    const int flags = O_RDWR | O_CLOEXEC | O_NOCTTY | O_NONBLOCK;
    int fd = open(path, flags);
    *made = fd < 0 && errno == ENOENT && (fd = make_private(path, flags)) >= 0;
    return fd < 0 && errno == EEXIST ? open(path, flags) : fd; /* another emulator has made it just now */
}

bool flash_file_open(struct flash_file *flash, const char *path, const char *name, unsigned blocks, unsigned block_size)
{
    *flash = (struct flash_file){
        .path = path, .name = name ? name : "flash", .blocks = blocks, .block_size = block_size, .unsynced = -1};
    bool made;
    flash->fd = open_or_make(path, &made);
    if (flash->fd < 0) {
        log_error("cannot open the %s image %s: %s", flash->name, path, strerror(errno));
        return false;
    }
    if (check_image(flash)) {
        if (made)
            output_file_made(flash->fd);
        return true;
    }
    if (made)
        unlink(path);
    output_file_release(flash->fd);
    close(flash->fd);
    flash->fd = -1;
    return false;
}

/* ---- Operations ----------------------------------------------------------------------------------------------------- */

static bool is_within(const struct flash_file *flash, unsigned block, unsigned offset, unsigned length)
{
    return block < flash->blocks && offset <= flash->block_size && length <= flash->block_size - offset;
}

bool flash_file_sync(struct flash_file *flash)
{
    int block = flash->unsynced;
    if (flash->fd < 0 || block < 0)
        return true;
    flash->unsynced = -1;
    if (fdatasync(flash->fd) == 0)
        return true;
    /* The system may now take for written what is not: it is reported only once. */
    flash->lost[block] = true;
    log_error("cannot write the %s image %s: %s", flash->name, flash->path, strerror(errno));
    return false;
}

static int write_at(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length)
{
    flash->unsynced = (int)block;
    flash->end = offset + length;
    ssize_t written = pwrite(flash->fd, data, length, block * flash->block_size + offset);
    if (written == (ssize_t)length)
        return 0;
    log_error("cannot write the %s image %s: %s", flash->name, flash->path, written >= 0 ? "the disk is full" : strerror(errno));
    return 1;
}

int flash_file_read(struct flash_file *flash, unsigned block, unsigned offset, void *data, unsigned length)
{
    if (!is_within(flash, block, offset, length))
        return 1;
    if (flash->unsynced == (int)block)
        flash_file_sync(flash);
    if (flash->lost[block])
        return 1;
    if (pread(flash->fd, data, length, block * flash->block_size + offset) == (ssize_t)length)
        return 0;
    log_error("cannot read the %s image %s", flash->name, flash->path);
    return 1;
}

int flash_file_erase(struct flash_file *flash, unsigned block)
{
    uint8_t bytes[DEVICE_FLASH_BLOCK_MAX];
    if (!is_within(flash, block, 0, flash->block_size))
        return 1;
    memset(bytes, ERASED, flash->block_size);
    if (flash->unsynced != (int)block && !flash_file_sync(flash))
        return 1;
    int result = write_at(flash, block, 0, bytes, flash->block_size);
    flash->lost[block] = flash->lost[block] && result != 0;
    return result;
}

int flash_file_program(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length)
{
    if (!is_within(flash, block, offset, length))
        return 1;
    bool follows = flash->unsynced == (int)block && offset == flash->end;
    if ((!follows && !flash_file_sync(flash)) || flash->lost[block])
        return 1;
    return write_at(flash, block, offset, data, length);
}

bool flash_file_close(struct flash_file *flash)
{
    bool synced = flash_file_sync(flash);
    if (flash->fd >= 0) {
        output_file_release(flash->fd);
        close(flash->fd);
    }
    flash->fd = -1;
    return synced;
}
