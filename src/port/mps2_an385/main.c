/* SPDX-License-Identifier: MIT */
/* main.c: an RKM04 on Arm's MPS2 board with image AN385. */
#include "loop.h"

int main(void)
{
    loop_start();
    for (;;)
        loop_turn();
}
