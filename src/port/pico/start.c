/* SPDX-License-Identifier: MIT */
/* start.c: what happens before main: vectors, clocks, and memory as C expects it. */
#include <stdint.h>

#include "pico.h"
#include "rp2040.h"

extern uint32_t stack_top, bss_begin, bss_end; /* of pico.ld */

int main(void);

/* 12 MHz crystal * 125 / 6 / 2 = 125 MHz for processor, peripherals and PIO; microseconds for the timer (2.15.6.1, 2.16.3,
 * 2.18.3). */
static void start_clocks(void)
{
    XOSC_STARTUP = 47;               /* 1 ms in units of 256 cycles */
    XOSC_CTRL = 0xfabu << 12 | 0xaa0; /* enable, 1 to 15 MHz */
    while (!(XOSC_STATUS >> 31))
        ;
    CLK_REF_CTRL = 2; /* the crystal */
    while (!(CLK_REF_SELECTED & 1u << 2))
        ;
    CLK_SYS_CTRL = 0; /* from the reference, while the PLL starts */
    while (!(CLK_SYS_SELECTED & 1u))
        ;
    SET(RESETS_RESET) = RESET_PLL_SYS;
    CLEAR(RESETS_RESET) = RESET_PLL_SYS;
    while (!(RESETS_DONE & RESET_PLL_SYS))
        ;
    PLL_SYS_CS = 1;      /* reference divided by 1 */
    PLL_SYS_FBDIV = 125; /* 1500 MHz */
    PLL_SYS_PWR = 0xc; /* all on but the post dividers */
    while (!(PLL_SYS_CS >> 31))
        ;
    PLL_SYS_PRIM = 6u << 16 | 2u << 12;
    PLL_SYS_PWR = 4;
    CLK_SYS_CTRL = 1; /* the PLL */
    while (!(CLK_SYS_SELECTED & 1u << 1))
        ;
    CLK_PERI_CTRL = 1u << 11;         /* on, from the system clock */
    WATCHDOG_TICK = 1u << 9 | 12; /* on; 12 cycles of the reference */
}

_Noreturn void reset(void);
_Noreturn void reset(void)
{
    const uint32_t used = RESET_IO | RESET_PADS | RESET_PIO0 | RESET_PIO1 | RESET_TIMER | RESET_UART0;
    interrupts_off();
    for (uint32_t *to = &bss_begin; to < &bss_end; to++)
        *to = 0;
    start_clocks();
    SET(RESETS_RESET) = used;
    CLEAR(RESETS_RESET) = used;
    while ((RESETS_DONE & used) != used)
        ;
    interrupts_on();
    (void)main();
    for (;;)
        ;
}

/* A processor fault: start again, as after switching on (the programs are in flash). */
static void fault(void)
{
    PSM_WDSEL = 0x1fffcu; /* all but the oscillators */
    WATCHDOG_CTRL = 1u << 31;
    for (;;)
        ;
}

typedef void handler(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler *exception[15];
    handler *interrupt[1]; /* no other is enabled */
} vectors = {
    &stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault},
    {[IRQ_TIMER0] = beat_interrupt},
};
