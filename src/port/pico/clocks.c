/* SPDX-License-Identifier: MIT */
/* clocks.c: the clocks of the RP2040, and its resets. */
#include "board.h"
#include "rp2040.h"

static void wait_for(const volatile uint32_t *state, uint32_t bits)
{
    while ((*state & bits) != bits)
        ;
}

/* 12 MHz crystal * 125 / 6 / 2 = 125 MHz for processor, peripherals and PIO; microseconds for the timer (2.15.6.1, 2.16.3,
 * 2.18.3). */
void clocks_start(void)
{
    const uint32_t used = RESET_IO | RESET_PADS | RESET_PIO0 | RESET_PIO1 | RESET_PLL_SYS | RESET_TIMER | RESET_UART0;
    XOSC_STARTUP = 47;               /* 1 ms in units of 256 cycles */
    XOSC_CTRL = 0xfabu << 12 | 0xaa0; /* enable, 1 to 15 MHz */
    wait_for(&XOSC_STATUS, 1u << 31);
    CLK_REF_CTRL = 2; /* the crystal */
    wait_for(&CLK_REF_SELECTED, 1u << 2);
    CLK_SYS_CTRL = 0; /* from the reference, while the PLL starts */
    wait_for(&CLK_SYS_SELECTED, 1u);
    CLK_PERI_CTRL = 1u << 11; /* on, from the system clock */
    SET(RESETS_RESET) = used;
    CLEAR(RESETS_RESET) = used;
    wait_for(&RESETS_DONE, used);
    PLL_SYS_CS = 1;      /* reference divided by 1 */
    PLL_SYS_FBDIV = 125; /* 1500 MHz */
    PLL_SYS_PWR = 0xc; /* all on but the post dividers */
    wait_for(&PLL_SYS_CS, 1u << 31);
    PLL_SYS_PRIM = 6u << 16 | 2u << 12;
    PLL_SYS_PWR = 4;
    CLK_SYS_CTRL = 1; /* the PLL */
    wait_for(&CLK_SYS_SELECTED, 1u << 1);
    WATCHDOG_TICK = 1u << 9 | 12; /* on; 12 cycles of the reference */
}

void board_reset(void)
{
    PSM_WDSEL = 0x1fffcu; /* all but the oscillators */
    WATCHDOG_CTRL = 1u << 31;
}
