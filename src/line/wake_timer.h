/* SPDX-License-Identifier: MIT */
/* wake_timer.h: a timer of the event loop that goes off within microseconds, where that of libuv has milliseconds. */
#ifndef RKM04_LINE_WAKE_TIMER_H
#define RKM04_LINE_WAKE_TIMER_H

#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

struct wake_timer {
    void (*expired)(void *context);
    void *context;

    /* Inside. */
    bool open;
    uv_poll_t poll;
    intptr_t system; /* the system's */
};

/* Make a timer, which is not set. *timer must be zero. Failures are reported. Returns false if it did not work. */
bool wake_timer_open(struct wake_timer *timer, uv_loop_t *loop, void (*expired)(void *context), void *context);

/* Call expired() at `when` (ns of uv_hrtime()), or in the next turn of the loop if that is past; 0: not at all. What was set
 * before does not count. A timer that is not open is left alone. */
void wake_timer_set(struct wake_timer *timer, uint64_t when);

/* Close it: expired() is not called any more. The handle is gone when the loop has run out. One that is not open is left
 * alone. */
void wake_timer_close(struct wake_timer *timer);

#endif
