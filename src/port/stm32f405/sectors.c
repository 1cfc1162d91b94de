/* SPDX-License-Identifier: MIT */
/* sectors.c: the programs' flash: the beginnings of sectors 4 to 11, one a block, since each can be erased alone. An erase takes
 * 1 s, at most 2 s (64 KiB: half of it), in which the flash cannot be read: nothing reads it, everything is in RAM, interrupts
 * included. QEMU's flash cannot be written: there it is RAM that behaves like flash. */
#include <string.h>

#include <rkm04/limits.h>

#include "board.h"
#include "flash.h"
#include "stm32f405.h"

#define FIRST_SECTOR 4u /* 64 KiB at 08010000; the others have 128 KiB each (table 5) */

static const uint8_t *place(unsigned block, unsigned offset)
{
    uintptr_t begin = block == 0 ? 0x08010000u : 0x08000000u + block * 0x20000u;
    return (const uint8_t *)(begin + offset);
}

static void wait_until_done(void)
{
    while (FLASH->sr & FLASH_BUSY)
        ;
}

/* Unlock, for this operation (3.6.1). */
static void begin(uint32_t operation)
{
    wait_until_done();
    FLASH->key = FLASH_KEY1;
    FLASH->key = FLASH_KEY2;
    FLASH->sr = FLASH_WRONG;
    FLASH->cr = FLASH_WORDS | operation;
}

/* Returns 0, or 1 if the chip reports an error. */
static int end(void)
{
    wait_until_done();
    FLASH->cr = FLASH_LOCK;
    return FLASH->sr & FLASH_WRONG ? 1 : 0;
}

int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    if (emulated)
        return flash_read(context, block, offset, data, length);
    memcpy(data, place(block, offset), length);
    return 0;
}

int board_flash_erase(void *context, unsigned block)
{
    if (emulated)
        return flash_erase(context, block);
    begin(FLASH_ERASE | FLASH_SECTOR(FIRST_SECTOR + block));
    FLASH->cr |= FLASH_START;
    int bad = end();
    const uint8_t *from = place(block, 0), *at = from;
    while (at < from + RKM04_FLASH_BLOCK_SIZE && *at == 0xff)
        at++;
    return bad || at < from + RKM04_FLASH_BLOCK_SIZE ? 1 : 0;
}

int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    if (emulated)
        return flash_program(context, block, offset, data, length);
    begin(FLASH_PROGRAM);
    for (unsigned at = 0; at < length; at += 4) {
        uint32_t word;
        memcpy(&word, (const uint8_t *)data + at, 4);
        *(volatile uint32_t *)(uintptr_t)place(block, offset + at) = word;
        wait_until_done();
    }
    int bad = end();
    return bad || memcmp(place(block, offset), data, length) != 0 ? 1 : 0;
}
