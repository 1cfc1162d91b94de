/* SPDX-License-Identifier: MIT */
#include "disk_shim.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>

#define WRITES 128 /* between two syncs */
#define SECTOR 512

ssize_t __real_pwrite(int fd, const void *data, size_t length, off_t at);
ssize_t __real_pread(int fd, void *data, size_t length, off_t at);
ssize_t __wrap_pwrite(int fd, const void *data, size_t length, off_t at);
ssize_t __wrap_pread(int fd, void *data, size_t length, off_t at);
int __wrap_fdatasync(int fd);
int __wrap_fsync(int fd);

static struct {
    uint8_t synced[FLASH_FILE_SIZE];
    struct {
        unsigned at, length;
        uint8_t bytes[FLASH_FILE_SIZE];
    } write[WRITES];
    unsigned writes;
    unsigned calls, folders, fault_at, done, length;
    enum disk_fault fault;
    bool off, full;
} disk;

unsigned disk_calls(void)
{
    return disk.calls;
}

unsigned disk_folders_synced(void)
{
    return disk.folders;
}

void disk_arm(unsigned n, enum disk_fault fault, unsigned done)
{
    disk.calls = disk.length = 0;
    disk.fault_at = n;
    disk.fault = fault;
    disk.done = done;
}

unsigned disk_length(void)
{
    return disk.length;
}

bool disk_off(void)
{
    return disk.off;
}

void disk_well(const uint8_t image[FLASH_FILE_SIZE])
{
    memcpy(disk.synced, image, FLASH_FILE_SIZE);
    disk.writes = disk.calls = disk.fault_at = disk.length = 0;
    disk.off = disk.full = false;
}

void disk_next_process(void)
{
    disk.calls = disk.fault_at = disk.length = 0;
    disk.off = disk.full = false;
}

/* Has the call that goes wrong come? */
static bool struck(void)
{
    return ++disk.calls == disk.fault_at;
}

static int refuse(int error)
{
    errno = error;
    return -1;
}

/* Write for real, and remember that it is not synced. */
static ssize_t put(int fd, const void *data, size_t length, off_t at)
{
    ssize_t written = length > 0 ? __real_pwrite(fd, data, length, at) : 0;
    if (written > 0 && disk.writes < WRITES) {
        disk.write[disk.writes].at = (unsigned)at;
        disk.write[disk.writes].length = (unsigned)written;
        memcpy(disk.write[disk.writes++].bytes, data, (size_t)written);
    }
    return written;
}

ssize_t __wrap_pwrite(int fd, const void *data, size_t length, off_t at)
{
    if (disk.off)
        return refuse(EIO);
    if (disk.full && disk.fault == DISK_FULL)
        return refuse(ENOSPC);
    if (!struck() || disk.fault == DISK_FULL_LATE)
        return put(fd, data, length, at);
    disk.length = (unsigned)length;
    ssize_t written = put(fd, data, disk.done < length ? disk.done : length, at);
    disk.off = disk.fault != DISK_FULL;
    disk.full = !disk.off;
    return disk.off ? refuse(EIO) : written > 0 ? written : refuse(ENOSPC);
}

static int sync_all(void)
{
    if (disk.off)
        return refuse(EIO);
    bool now = struck();
    if (disk.fault == DISK_FULL_LATE && disk.fault_at > 0 && disk.calls >= disk.fault_at)
        return refuse(ENOSPC);
    if (now && (disk.fault == DISK_KILL || disk.fault == DISK_POWER)) {
        disk.off = true;
        return refuse(EIO);
    }
    for (unsigned i = 0; i < disk.writes; i++)
        memcpy(disk.synced + disk.write[i].at, disk.write[i].bytes, disk.write[i].length);
    disk.writes = 0;
    return 0;
}

int __wrap_fdatasync(int fd)
{
    (void)fd;
    return sync_all();
}

int __wrap_fsync(int fd)
{
    struct stat found;
    disk.folders += fstat(fd, &found) == 0 && S_ISDIR(found.st_mode);
    return sync_all();
}

ssize_t __wrap_pread(int fd, void *data, size_t length, off_t at)
{
    return disk.off ? refuse(EIO) : __real_pread(fd, data, length, at);
}

void disk_survives(uint8_t image[FLASH_FILE_SIZE], uint32_t seed)
{
    uint32_t random = seed * 2654435761u + 1;
    memcpy(image, disk.synced, FLASH_FILE_SIZE);
    for (unsigned i = 0; i < disk.writes; i++) {
        unsigned at = disk.write[i].at, end = at + disk.write[i].length;
        for (unsigned from = at, to; from < end; from = to) {
            to = (from / SECTOR + 1) * SECTOR;
            to = to < end ? to : end;
            random = random * 1664525u + 1013904223u;
            unsigned part = to - from;
            if (random >> 30 == 0) /* a piece that is torn, too */
                part = (random >> 8) % part;
            if (random >> 31 == 0)
                memcpy(image + from, disk.write[i].bytes + (from - at), part);
        }
    }
}
