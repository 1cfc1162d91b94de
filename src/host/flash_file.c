#include "flash_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "log.h"

#define ERASED 0xff

/* ---- Opening -------------------------------------------------------------------------------------------------------- */

/* Write an erased flash to the new, empty file. */
static bool make_image(struct flash_file *flash)
{
    uint8_t bytes[FLASH_FILE_SIZE];
    memset(bytes, ERASED, sizeof bytes);
    ssize_t written = pwrite(flash->fd, bytes, sizeof bytes, 0);
    if (written == (ssize_t)sizeof bytes && fsync(flash->fd) == 0)
        return true;
    log_error("cannot write the flash image %s: %s", flash->path, written >= 0 ? "the disk is full" : strerror(errno));
    if (ftruncate(flash->fd, 0) != 0)
        log_error("%s is not whole: remove it", flash->path);
    return false;
}

/* Is the open file an image, or empty, and ours alone? */
static bool check_image(struct flash_file *flash)
{
    struct stat found;
    if (fstat(flash->fd, &found) != 0 || !S_ISREG(found.st_mode)) {
        log_error("--flash: %s is not a file: expected a flash image of %d bytes, or a name that is free", flash->path,
                  FLASH_FILE_SIZE);
        return false;
    }
    if (flock(flash->fd, LOCK_EX | LOCK_NB) != 0) {
        log_error("another emulator uses the flash image %s: end it, or choose another --flash", flash->path);
        return false;
    }
    /* The size under the lock: it may have been made just now. */
    if (fstat(flash->fd, &found) == 0 && found.st_size == 0)
        return make_image(flash);
    if (found.st_size == FLASH_FILE_SIZE)
        return true;
    log_error("--flash: %s has %lld bytes and is no flash image: expected %d bytes, or a name that is free", flash->path,
              (long long)found.st_size, FLASH_FILE_SIZE);
    return false;
}

bool flash_file_open(struct flash_file *flash, const char *path)
{
    flash->path = path;
    flash->fd = -1;
    flash->unsynced = false;
    flash->end = 0;
    flash->fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOCTTY | O_NONBLOCK, 0666);
    if (flash->fd < 0) {
        log_error("cannot open the flash image %s: %s", path, strerror(errno));
        return false;
    }
    if (check_image(flash))
        return true;
    close(flash->fd);
    flash->fd = -1;
    return false;
}

/* ---- Operations ----------------------------------------------------------------------------------------------------- */

static bool within(unsigned block, unsigned offset, unsigned length)
{
    return block < RKM04_FLASH_BLOCKS && offset <= RKM04_FLASH_BLOCK_SIZE && length <= RKM04_FLASH_BLOCK_SIZE - offset;
}

bool flash_file_sync(struct flash_file *flash)
{
    if (flash->fd < 0 || !flash->unsynced)
        return true;
    if (fdatasync(flash->fd) != 0) {
        log_error("cannot write the flash image %s: %s", flash->path, strerror(errno));
        return false;
    }
    flash->unsynced = false;
    return true;
}

static int write_at(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length)
{
    unsigned at = block * RKM04_FLASH_BLOCK_SIZE + offset;
    if (at != flash->end && !flash_file_sync(flash))
        return 1;
    flash->unsynced = true;
    flash->end = at + length;
    ssize_t written = pwrite(flash->fd, data, length, at);
    if (written == (ssize_t)length)
        return 0;
    log_error("cannot write the flash image %s: %s", flash->path, written >= 0 ? "the disk is full" : strerror(errno));
    return 1;
}

int flash_file_read(struct flash_file *flash, unsigned block, unsigned offset, void *data, unsigned length)
{
    if (!within(block, offset, length))
        return 1;
    unsigned at = block * RKM04_FLASH_BLOCK_SIZE + offset;
    if (!flash_file_sync(flash))
        return 1;
    if (pread(flash->fd, data, length, at) == (ssize_t)length)
        return 0;
    log_error("cannot read the flash image %s", flash->path);
    return 1;
}

int flash_file_erase(struct flash_file *flash, unsigned block)
{
    uint8_t bytes[RKM04_FLASH_BLOCK_SIZE];
    if (!within(block, 0, sizeof bytes))
        return 1;
    memset(bytes, ERASED, sizeof bytes);
    return write_at(flash, block, 0, bytes, sizeof bytes);
}

int flash_file_program(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return within(block, offset, length) ? write_at(flash, block, offset, data, length) : 1;
}

bool flash_file_close(struct flash_file *flash)
{
    bool synced = flash_file_sync(flash);
    if (flash->fd >= 0)
        close(flash->fd);
    flash->fd = -1;
    return synced;
}
