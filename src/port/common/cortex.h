/* SPDX-License-Identifier: MIT */
/* cortex.h: what all Cortex-M processors have. */
#ifndef CORTEX_H
#define CORTEX_H

#include <stdint.h>

/* Interrupts 0-31: enable, set pending; one byte of priority each, 0 is the most urgent (write words on a Cortex-M0+). */
#define NVIC_ENABLE (*(volatile uint32_t *)0xe000e100)
#define NVIC_PEND (*(volatile uint32_t *)0xe000e200)
#define NVIC_PRIORITY ((volatile uint8_t *)0xe000e400)
#define SCB_VTOR (*(volatile uint32_t *)0xe000ed08)
#define SCB_AIRCR (*(volatile uint32_t *)0xe000ed0c)
#define AIRCR_RESET 0x05fa0004u

/* An interrupt's entry in the vectors: a board lists its own, from number 0 on, in this section. */
typedef void handler(void);
#define INTERRUPTS __attribute__((section(".vectors.interrupts"), used)) handler *const

static inline void interrupts_off(void)
{
    __asm__ volatile("cpsid i" ::: "memory");
}

static inline void interrupts_on(void)
{
    __asm__ volatile("cpsie i" ::: "memory");
}

#endif
