/* SPDX-License-Identifier: MIT */
/* start.c: what happens before main: the vectors, and memory as C expects it. */
#include <stdint.h>

#include "board.h"
#include "mps2.h"

extern uint32_t stack_top, data_image, data_begin, data_end, bss_begin, bss_end; /* of mps2_an385.ld */

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
    *(volatile uint32_t *)0xe000ed0c = 0x05fa0004; /* AIRCR: system reset request */
    for (;;)
        ;
}

typedef void handler(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler *exception[15];
    handler *interrupt[10];
} vectors = {
    &stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault},
    {[0] = uart_receive_interrupt, [1] = uart_sent_interrupt, [2] = fault, [3] = fault, [4] = fault, [5] = fault,
     [6] = fault, [7] = board_input_interrupt, [8] = board_timer_interrupt, [9] = uart_timer_interrupt},
};
