/* SPDX-License-Identifier: MIT */
/* blocks.c: the programs' flash: eight sectors of 4096 bytes from the start of the last 64 KiB, by the functions of the ROM
 * (2.8.3.1.3). While one of them works the flash cannot be read: nothing reads it, everything is in RAM, interrupts included. */
#include <string.h>

#include <rkm04/limits.h>

#include "board.h"
#include "rp2040.h"

#define PAGE 256u /* the ROM programs whole ones; bytes FF leave what is there as it is */

extern uint8_t blocks_begin[]; /* of pico.ld */

typedef void *rom_look_up(const uint16_t *table, uint32_t code);
typedef void rom_work(uint32_t offset, uintptr_t second, uint32_t third, uint32_t fourth);

/* Call a function of the ROM by its two characters; it takes as many of the arguments as it has. */
static void rom(const char *name, uint32_t offset, uintptr_t second, uint32_t third, uint32_t fourth)
{
    rom_look_up *look_up = (rom_look_up *)(uintptr_t)rom_lookup;
    void *found = look_up((const uint16_t *)(uintptr_t)rom_table, (uint32_t)name[1] << 8 | (uint32_t)name[0]);
    ((rom_work *)found)(offset, second, third, fourth);
}

/* The same with the flash taking commands, and then read as memory again. */
static void change(const char *name, uint32_t offset, uintptr_t second, uint32_t third, uint32_t fourth)
{
    rom("IF", 0, 0, 0, 0); /* connect_internal_flash */
    rom("EX", 0, 0, 0, 0); /* flash_exit_xip */
    rom(name, offset, second, third, fourth);
    rom("FC", 0, 0, 0, 0); /* flash_flush_cache */
    rom("CX", 0, 0, 0, 0); /* flash_enter_cmd_xip */
}

static uint32_t place(unsigned block, unsigned offset)
{
    return (uint32_t)(uintptr_t)blocks_begin - XIP_BASE + block * RKM04_FLASH_BLOCK_SIZE + offset;
}

int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    memcpy(data, (const void *)(uintptr_t)(XIP_NOCACHE_NOALLOC_BASE + place(block, offset)), length);
    return 0;
}

int board_flash_erase(void *context, unsigned block)
{
    (void)context;
    change("RE", place(block, 0), RKM04_FLASH_BLOCK_SIZE, 65536, 0xd8); /* flash_range_erase; for larger ranges by 64 KiB, D8 */
    const uint8_t *from = (const uint8_t *)(uintptr_t)(XIP_NOCACHE_NOALLOC_BASE + place(block, 0)), *at = from;
    while (at < from + RKM04_FLASH_BLOCK_SIZE && *at == 0xff)
        at++;
    return at == from + RKM04_FLASH_BLOCK_SIZE ? 0 : 1;
}

int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    static uint8_t page[2 * PAGE];
    unsigned begin = offset % PAGE;
    memset(page, 0xff, sizeof page);
    memcpy(page + begin, data, length);
    change("RP", place(block, offset - begin), (uintptr_t)page, begin + length > PAGE ? 2 * PAGE : PAGE, 0);
    return memcmp((const void *)(uintptr_t)(XIP_NOCACHE_NOALLOC_BASE + place(block, offset)), data, length) == 0 ? 0 : 1;
}
