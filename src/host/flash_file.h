/* flash_file.h: the unit's flash as an image file, which survives.
 *
 * The image is the blocks of the flash one after the other, RKM04_FLASH_BLOCKS x RKM04_FLASH_BLOCK_SIZE bytes, and nothing
 * else. Every operation reaches the file when it is asked for, so a killed emulator loses nothing of what it has done. For a
 * machine that loses its power: operations become lasting in the order in which they were asked for, but for programs that
 * follow one another without a gap, which count as one; what has been read back is on the disk. */
#ifndef RKM04_HOST_FLASH_FILE_H
#define RKM04_HOST_FLASH_FILE_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/unit.h>

#define FLASH_FILE_SIZE (RKM04_FLASH_BLOCKS * RKM04_FLASH_BLOCK_SIZE)

struct flash_file {
    const char *path;
    int fd;           /* -1: not open */
    bool unsynced;
    unsigned end;     /* where the operation before ended */
};

/* Open the image `path`, making an erased one if there is none, for this process alone. `path` must stay.
 * Failures are reported. Returns false if it did not work. */
bool flash_file_open(struct flash_file *flash, const char *path);

/* See that all is on the disk. Failures are reported. Returns false if it did not work. */
bool flash_file_sync(struct flash_file *flash);

/* Sync and close. Returns as flash_file_sync(). */
bool flash_file_close(struct flash_file *flash);

/* As in struct rkm04_port. Failures are reported. */
int flash_file_read(struct flash_file *flash, unsigned block, unsigned offset, void *data, unsigned length);
int flash_file_erase(struct flash_file *flash, unsigned block);
int flash_file_program(struct flash_file *flash, unsigned block, unsigned offset, const void *data, unsigned length);

#endif
