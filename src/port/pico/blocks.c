/* SPDX-License-Identifier: MIT */
/* blocks.c: the programs' flash: eight sectors of 4096 bytes from the start of the last 64 KiB, by the functions of the ROM
 * (2.8.3.1.3). While one of them works the flash cannot be read: nothing reads it, everything is in RAM, interrupts included. */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include <rkm04/limits.h>

#include "board.h"
#include "rp2040.h"

#define PAGE 256u

extern uint8_t blocks_begin[]; /* of pico.ld */

typedef void rom_plain(void);
typedef void rom_erase(uint32_t offset, uint32_t length, uint32_t block, uint32_t command);
typedef void rom_program(uint32_t offset, const uint8_t *data, uint32_t length);
typedef void *rom_look_up(const uint16_t *table, uint32_t code);

/* A function of the ROM, by its two characters. */
static void *rom(char first, char second)
{
    rom_look_up *look_up = (rom_look_up *)(uintptr_t)rom_lookup;
    return look_up((const uint16_t *)(uintptr_t)rom_table, (uint32_t)second << 8 | (uint32_t)first);
}

/* The flash takes commands instead of being read. */
static void begin_commands(void)
{
    ((rom_plain *)rom('I', 'F'))(); /* connect_internal_flash */
    ((rom_plain *)rom('E', 'X'))(); /* flash_exit_xip */
}

static void end_commands(void)
{
    ((rom_plain *)rom('F', 'C'))(); /* flash_flush_cache */
    ((rom_plain *)rom('C', 'X'))(); /* flash_enter_cmd_xip: read as memory again, by command 03 */
}

static uint32_t offset_of(unsigned block, unsigned offset)
{
    return (uint32_t)(uintptr_t)blocks_begin - XIP_BASE + block * RKM04_FLASH_BLOCK_SIZE + offset;
}

static const uint8_t *address_of(unsigned block, unsigned offset)
{
    return (const uint8_t *)(uintptr_t)(XIP_NOCACHE_NOALLOC_BASE + offset_of(block, offset));
}

int board_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    (void)context;
    memcpy(data, address_of(block, offset), length);
    return 0;
}

int board_flash_erase(void *context, unsigned block)
{
    (void)context;
    begin_commands();
    ((rom_erase *)rom('R', 'E'))(offset_of(block, 0), RKM04_FLASH_BLOCK_SIZE, 65536, 0xd8);
    end_commands();
    for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
        if (*address_of(block, i) != 0xff)
            return 1;
    return 0;
}

/* The ROM programs whole pages; bytes FF leave what is there as it is. */
int board_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    (void)context;
    static uint8_t page[2 * PAGE];
    unsigned begin = offset % PAGE, pages = begin + length > PAGE ? 2 : 1;
    memset(page, 0xff, sizeof page);
    memcpy(page + begin, data, length);
    begin_commands();
    ((rom_program *)rom('R', 'P'))(offset_of(block, offset - begin), page, pages * PAGE);
    end_commands();
    return memcmp(address_of(block, offset), data, length) == 0 ? 0 : 1;
}
