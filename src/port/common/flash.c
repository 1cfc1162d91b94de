/* SPDX-License-Identifier: MIT */
#include "flash.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <rkm04/limits.h>

#define UNIT 8u /* bytes that are programmed together, and once */
#define UNITS (RKM04_FLASH_BLOCK_SIZE / UNIT)
#define FORMATTED 0x524b4d34u

static struct {
    uint8_t block[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE];
    uint8_t programmed[RKM04_FLASH_BLOCKS][UNITS / 8]; /* a bit for each 8 bytes, set also if they were programmed with FF */
    uint32_t formatted;
} flash __attribute__((section(".blocks")));

static bool is_within(unsigned block, unsigned offset, unsigned length)
{
    return block < RKM04_FLASH_BLOCKS && length <= RKM04_FLASH_BLOCK_SIZE && offset <= RKM04_FLASH_BLOCK_SIZE - length;
}

void flash_start(void)
{
    if (flash.formatted == FORMATTED)
        return;
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        (void)flash_erase(NULL, block);
    flash.formatted = FORMATTED;
}

int flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    if (!is_within(block, offset, length))
        return 1;
    memcpy(data, flash.block[block] + offset, length);
    return 0;
}

int flash_erase(void *context, unsigned block)
{
    (void)context;
    if (block >= RKM04_FLASH_BLOCKS)
        return 1;
    memset(flash.block[block], 0xff, RKM04_FLASH_BLOCK_SIZE);
    memset(flash.programmed[block], 0, UNITS / 8);
    return 0;
}

int flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    if (!is_within(block, offset, length) || offset % UNIT != 0 || length % UNIT != 0)
        return 1;
    for (unsigned unit = offset / UNIT; unit < (offset + length) / UNIT; unit++) {
        uint8_t bit = (uint8_t)(1u << unit % 8);
        if (flash.programmed[block][unit / 8] & bit)
            return 1;
        flash.programmed[block][unit / 8] |= bit;
    }
    memcpy(flash.block[block] + offset, data, length);
    return 0;
}
