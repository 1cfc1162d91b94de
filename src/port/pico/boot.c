/* SPDX-License-Identifier: MIT */
/* boot.c: the second stage (2.8.1.3): the first 256 bytes of the flash, the last four of them a CRC that tools/pico-image
 * inserts. The ROM copies them to the end of the RAM and runs them. They have the flash read as memory, with the command that
 * every chip knows, copy the firmware to RAM and start it: it never runs from flash, so the cache has no influence on its times,
 * and the flash may be erased while interrupts go on. */
#include "cortex.h"
#include "rp2040.h"

__attribute__((section(".boot_crc"), used)) const uint32_t boot_crc = 0;

extern uint32_t image[], image_begin[], image_end[]; /* of pico.ld */

__attribute__((section(".boot"), used, noreturn)) void boot(void)
{
    SSI->ssienr = 0;
    SSI->baudr = 4;                          /* 31 MHz of 125 at most; less while it boots */
    SSI->ctrlr0 = 31u << 16 | 3u << 8;       /* 32 bits a word; EEPROM read: send command and address, then read */
    SSI->ctrlr1 = 0;                         /* one word */
    SSI->spi_ctrlr0 = 0x03u << 24 | 2u << 8 | 6u << 2; /* command 03, 8 bits; 24 bits of address; all on one wire */
    SSI->ssienr = 1;
    const volatile uint32_t *from = image;
    for (uint32_t *to = image_begin; to < image_end; to++)
        *to = *from++;
    SCB_VTOR = (uint32_t)(uintptr_t)image_begin;
    __asm__ volatile("msr msp, %0\n\tbx %1" ::"r"(image_begin[0]), "r"(image_begin[1]));
    __builtin_unreachable();
}
