/* SPDX-License-Identifier: MIT */
/* wake.h: how the main loop sleeps until an interrupt has something for it. */
#ifndef WAKE_H
#define WAKE_H

#include <stdbool.h>
#include <stdint.h>

/* Main loop: wake me at this tick. Interrupts off, or before there are any. */
void wake_at(uint32_t tick);

/* Interrupt: the tick is `now`; is it time? */
void wake_check(uint32_t now);

/* Interrupt: the tick at which it wants to be woken; `otherwise` if that has happened already. */
uint32_t wake_tick(uint32_t otherwise);

/* Interrupt: an input has changed. Main loop: it has looked at them. */
void wake_changed(void);
void wake_clear(void);

/* Main loop: sleep until the tick handed to wake_at, a change of an input, or until line_needs_main_loop(more). */
void wake_wait(bool more);

#endif
