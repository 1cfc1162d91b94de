/* SPDX-License-Identifier: MIT */
/* pmc_main.c: a PMC on a board. */
#include "pmc_loop.h"

int main(void)
{
    pmc_loop_start();
    for (;;)
        pmc_loop_turn();
}
