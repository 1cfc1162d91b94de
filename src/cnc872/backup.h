/* SPDX-License-Identifier: MIT */
/* backup.h: the backup memory of the CNC872 in flash (NO3). */
#ifndef CNC872_BACKUP_H
#define CNC872_BACKUP_H

#include <stdbool.h>
#include <stdint.h>

#define CNC_BACKUP_SIZE 10000u /* bytes of PLC_MEM_BACKUP */
#define CNC_BACKUP_BLOCK 4096u /* bytes of a block */
#define CNC_BACKUP_BLOCKS 6u

/* Flash: erased bytes read FF. Each returns 0, or another value if it failed. */
struct cnc_flash {
    int (*read)(void *context, unsigned block, unsigned offset, void *data, unsigned length);
    int (*program)(void *context, unsigned block, unsigned offset, const void *data, unsigned length);
    int (*erase)(void *context, unsigned block);
    void *context;
};

/* The content that was stored last and whole; *number: that of its image, to be kept for the next store. False: there is none,
 * and `bytes` are 0. */
bool cnc_backup_load(const struct cnc_flash *flash, uint8_t bytes[CNC_BACKUP_SIZE], uint32_t *number);

/* Store: whole, or what was there before stays. */
bool cnc_backup_store(const struct cnc_flash *flash, const uint8_t bytes[CNC_BACKUP_SIZE], uint32_t *number);

#endif
