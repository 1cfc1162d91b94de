/* SPDX-License-Identifier: MIT */
/* main.c: an RKM04 on a board. */
#include "loop.h"

int main(void)
{
    loop_start();
    for (;;)
        loop_turn();
}
