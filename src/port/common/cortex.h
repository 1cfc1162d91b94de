/* SPDX-License-Identifier: MIT */
/* cortex.h: what all Cortex-M processors have. */
#ifndef CORTEX_H
#define CORTEX_H

#include <stdint.h>

/* Interrupts, 32 a word: enable, disable, set pending; one byte of priority each, 0 is the most urgent (write words on a
 * Cortex-M0+, which has one word of each). */
#define NVIC_ENABLE ((volatile uint32_t *)0xe000e100)
#define NVIC_DISABLE ((volatile uint32_t *)0xe000e180)
#define NVIC_PEND ((volatile uint32_t *)0xe000e200)
#define NVIC_PRIORITY ((volatile uint8_t *)0xe000e400)
#define SCB_VTOR (*(volatile uint32_t *)0xe000ed08)
#define SCB_AIRCR (*(volatile uint32_t *)0xe000ed0c)
#define AIRCR_RESET 0x05fa0004u

/* SysTick: counts cycles of the processor down, 24 bits, then interrupts. */
#define SYSTICK_CONTROL (*(volatile uint32_t *)0xe000e010)
#define SYSTICK_RELOAD (*(volatile uint32_t *)0xe000e014)
#define SYSTICK_VALUE (*(volatile uint32_t *)0xe000e018)

/* An interrupt's entry in the vectors: a board lists its own, from number 0 on, in this section. */
typedef void handler(void);
#define INTERRUPTS __attribute__((section(".vectors.interrupts"), used)) handler *const

/* Of a board that uses SysTick; otherwise it counts as a fault. */
void systick_interrupt(void);

/* Have SysTick interrupt in `ticks` of `megahertz` cycles each, or as late as it can if that is sooner. */
static inline void systick_start(uint32_t ticks, uint32_t megahertz)
{
    const uint32_t longest = 0xffffffu / megahertz;
    SYSTICK_RELOAD = (ticks < longest ? ticks : longest) * megahertz;
    SYSTICK_VALUE = 0;
    SYSTICK_CONTROL = 7; /* the processor's clock, its interrupt, on */
}

static inline void systick_stop(void)
{
    SYSTICK_CONTROL = 0;
}

static inline void interrupts_off(void)
{
    __asm__ volatile("cpsid i" ::: "memory");
}

static inline void interrupts_on(void)
{
    __asm__ volatile("cpsie i" ::: "memory");
}

#endif
