/* SPDX-License-Identifier: MIT */
/* figures_count.h: what figures.c and figures_pmc.c share: instructions, counted, and reports by semihosting. */
#ifndef FIGURES_COUNT_H
#define FIGURES_COUNT_H

#include <string.h>

#include "mps2.h"

static inline int semihosting(int operation, const void *argument)
{
    register int r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

static inline void report(const char *name, uint32_t value)
{
    char line[80], *at = line + sizeof line;
    *--at = '\0';
    *--at = '\n';
    do
        *--at = (char)('0' + value % 10);
    while ((value /= 10) > 0);
    *--at = ' ';
    size_t length = strlen(name);
    at -= length;
    memcpy(at, name, length);
    (void)semihosting(4, at);
}

/* The board's dual timer, free running at 25 MHz, downwards. */
#define DUAL_TIMER_VALUE (*(volatile uint32_t *)0x40002004)
#define DUAL_TIMER_CONTROL (*(volatile uint32_t *)0x40002008)

static uint32_t begun, overhead;

static inline void begin(void)
{
    begun = DUAL_TIMER_VALUE;
}

/* Instructions since begin(). */
static inline uint32_t counted(void)
{
    uint32_t counts = begun - DUAL_TIMER_VALUE;
    return (uint32_t)((uint64_t)counts * 10 / 256) - overhead;
}

/* Before the first begin(). */
static inline void count_start(void)
{
    DUAL_TIMER_CONTROL = 0x82; /* on, free running, 32 bits */
    begin();
    overhead = counted();
}

/* The program has ended without an error. */
static inline int count_end(void)
{
    (void)semihosting(0x18, (const void *)0x20026);
    return 0;
}

#endif
