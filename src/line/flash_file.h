/* SPDX-License-Identifier: MIT */
/* flash_file.h: the unit's flash as an image file, which survives.
 *
 * The image is the blocks of the flash one after the other and nothing else. Every operation reaches the file when it is asked
 * for, so a killed emulator loses nothing of what it has done. For a machine that loses its power: operations become lasting in
 * the order in which they were asked for, but for programs that follow one another without a gap, which count as one, and an
 * erase of the block that was written last; what has been read is on the disk. A new image is on the disk with its name before
 * it is used, and one whose making was cut is made again. */
#ifndef RKM04_LINE_FLASH_FILE_H
#define RKM04_LINE_FLASH_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include "device/device.h"

struct flash_file {
    const char *path;
    const char *name; /* of what lies there, for messages; also that of the option */
    unsigned blocks, block_size;
    int fd;           /* -1: not open */
    int unsynced;     /* block with writes that may not be on the disk yet; -1: none */
    unsigned end;     /* where the write before ended in it */
    bool lost[DEVICE_FLASH_BLOCKS_MAX]; /* a sync failed: it does not count what can be read there, until the next erase */
};

/* Open the image `path` of so many blocks, at most DEVICE_FLASH_BLOCKS_MAX of at most DEVICE_FLASH_BLOCK_MAX bytes, making an
 * erased one if there is none, for this process alone. `path` and `name` (NULL: "flash") must stay. Failures are reported.
 * Returns false if it did not work. */
bool flash_file_open(struct flash_file *flash, const char *path, const char *name, unsigned blocks, unsigned block_size);

/* See that all is on the disk. Failures are reported. Returns false if it did not work: the block that was written cannot be
 * read or programmed then until it has been erased. */
bool flash_file_sync(struct flash_file *flash);

/* Sync and close. Returns as flash_file_sync(). */
bool flash_file_close(struct flash_file *flash);

/* As in struct device_port. Failures are reported. */
int flash_file_read(struct flash_file *flash, unsigned block, unsigned offset, void *data, unsigned length);
int flash_file_erase(struct flash_file *flash, unsigned block);
int flash_file_program(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length);

#endif
