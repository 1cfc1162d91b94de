/* SPDX-License-Identifier: MIT */
/* cortex.c: what happens on a Cortex-M before main: the vectors, and memory as C expects it. */
#include "cortex.h"

#include <stdint.h>

#include "board.h"

extern uint32_t stack_top, data_image, data_begin, data_end, bss_begin, bss_end; /* of the board's linker script */

int main(void);

_Noreturn void reset(void);
_Noreturn void reset(void)
{
    uint32_t *from = &data_image;
    for (uint32_t *to = &data_begin; to < &data_end; to++)
        *to = *from++;
    for (uint32_t *to = &bss_begin; to < &bss_end; to++)
        *to = 0;
    (void)main();
    for (;;)
        ;
}

/* A processor fault: start again, as after switching on (the programs are in flash). */
static void fault(void)
{
    board_reset();
    for (;;)
        ;
}

__attribute__((weak, alias("fault"))) void systick_interrupt(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler *exception[15];
} vectors = {
    &stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, systick_interrupt},
};

void board_interrupts(bool on)
{
    if (on)
        interrupts_on();
    else
        interrupts_off();
}

void board_wait(void)
{
    __asm__ volatile("wfi" ::: "memory");
}
