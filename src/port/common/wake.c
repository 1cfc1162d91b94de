/* SPDX-License-Identifier: MIT */
#include "wake.h"

#include "board.h"
#include "line.h"

static volatile uint32_t wanted;
static volatile bool awake, changed;

void wake_at(uint32_t tick)
{
    wanted = tick;
    awake = false;
}

void wake_check(uint32_t now)
{
    if ((int32_t)(wanted - now) <= 0)
        awake = true;
}

uint32_t wake_tick(uint32_t otherwise)
{
    return awake ? otherwise : wanted;
}

void wake_changed(void)
{
    changed = true;
}

void wake_clear(void)
{
    changed = false;
}

void wake_wait(bool more)
{
    board_interrupts(false); /* or what comes between the look and the sleep would be slept through; it wakes all the same */
    while (!awake && !changed && !line_needs_main_loop(more)) {
        board_wait();
        board_interrupts(true);
        board_interrupts(false);
    }
    board_interrupts(true);
}
