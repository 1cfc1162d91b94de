/* SPDX-License-Identifier: MIT */
/* main_semihosting.c: the digest on a bare Cortex-M under an emulator or debugger that offers semihosting. */
#include "digest.h"

/* Operations of semihosting and the status of a program that has ended well (ARM, "Semihosting for AArch32 and AArch64"). */
enum { SYS_WRITE0 = 0x04, SYS_EXIT = 0x18, APPLICATION_EXIT = 0x20026, RUN_TIME_ERROR = 0x20023 };

extern uint32_t data_image[], data_begin[], data_end[], bss_begin[], bss_end[], stack_top[];

static void semihosting(uint32_t operation, uintptr_t argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register uintptr_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

static void say(const char *line)
{
    semihosting(SYS_WRITE0, (uintptr_t)line);
    semihosting(SYS_WRITE0, (uintptr_t)"\n");
}

_Noreturn void reset(void);
void reset(void)
{
    uint32_t *from = data_image;
    for (uint32_t *to = data_begin; to < data_end;)
        *to++ = *from++;
    for (uint32_t *to = bss_begin; to < bss_end;)
        *to++ = 0;
    digest_run(say);
    semihosting(SYS_EXIT, APPLICATION_EXIT);
    for (;;)
        continue;
}

/* Whatever goes wrong in the processor. */
static void fault(void)
{
    semihosting(SYS_EXIT, RUN_TIME_ERROR);
}

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    void (*handler[6])(void); /* reset, NMI, hard fault, memory, bus, usage fault */
} vectors = {stack_top, {reset, fault, fault, fault, fault, fault}};
