/* SPDX-License-Identifier: MIT */
/* disk_shim.h: the disk under a flash image, which loses its power or is full. It stands between flash_file.c and the system
 * (linked with --wrap) and knows what a machine that loses its power may lose: whatever was not synced. */
#ifndef RKM04_TESTS_DISK_SHIM_H
#define RKM04_TESTS_DISK_SHIM_H

#include <stdbool.h>
#include <stdint.h>

#include "line/flash_file.h"

#define FLASH_FILE_SIZE (RKM04_FLASH_BLOCKS * RKM04_FLASH_BLOCK_SIZE) /* the image of these tests */

enum disk_fault {
    DISK_WELL,
    DISK_KILL,        /* the process ends in the middle of the call; what was written stays */
    DISK_POWER,       /* the machine loses its power there */
    DISK_FULL,        /* from this call on nothing more can be written, but for what the call itself still can */
    DISK_FULL_LATE,   /* writes go well, and the syncs report the failure */
};

/* Calls so far that write or sync (pwrite, fdatasync, fsync), and those of fsync for a folder. */
unsigned disk_calls(void);
unsigned disk_folders_synced(void);

/* From now on the n-th (1..) call goes wrong, after the first `done` bytes if it is a write. 0: none. */
void disk_arm(unsigned n, enum disk_fault fault, unsigned done);

/* Bytes of the write that went wrong; 0: it was no write. */
unsigned disk_length(void);

/* Has the process or the machine come to its end? */
bool disk_off(void);

/* The disk is well again; what is in the image now is on it. */
void disk_well(const uint8_t image[FLASH_FILE_SIZE]);

/* Another process begins: what was not synced still is not. */
void disk_next_process(void);

/* What the machine may find after the cut: all that was synced, and of what was not any part, in pieces of 512 bytes or
 * smaller ones. Another seed, another part. */
void disk_survives(uint8_t image[FLASH_FILE_SIZE], uint32_t seed);

#endif
