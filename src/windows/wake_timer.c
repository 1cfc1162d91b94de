/* SPDX-License-Identifier: MIT */
/* wake_timer.c: one waitable timer for all of the process; a thread of the system's pool waits for it and wakes the event loop.
 * It is set for the first time that any of them waits for, or an earlier one that none waits for any more. */
#include <uv.h>

#include "line/line.h"

#define NS_PER_UNIT 100 /* of a waitable timer */
#define HIGH_RESOLUTION 2 /* CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, from Windows 10, version 1803 */

struct waiting {
    struct wake_timer *timer;
    uint64_t when; /* ns for which it is set; 0: it is not */
    struct waiting *next;
};

static struct alarm_clock {
    HANDLE timer, wait;
    uv_async_t async;
    uint64_t when; /* ns for which it is set; 0: it is not */
    struct waiting *first;
} *alarm_clock; /* NULL: there are no timers */

static struct waiting *waiting_of(const struct wake_timer *timer)
{
    return (struct waiting *)timer->system;
}

/* ---- The clock ------------------------------------------------------------------------------------------------------ */

static void CALLBACK on_signal(void *context, BOOLEAN timed_out)
{
    struct alarm_clock *clock = context;
    (void)timed_out;
    uv_async_send(&clock->async);
}

static void set_clock(struct alarm_clock *clock, uint64_t when)
{
    uint64_t now = uv_hrtime();
    LARGE_INTEGER due = {.QuadPart = when > now ? -(LONGLONG)((when - now) / NS_PER_UNIT + 1) : -1};
    clock->when = when;
    SetWaitableTimer(clock->timer, &due, 0, NULL, NULL, FALSE);
}

/* Set it for the first of those that wait. */
static void wind_clock(struct alarm_clock *clock)
{
    uint64_t when = 0;
    for (const struct waiting *waiting = clock->first; waiting; waiting = waiting->next)
        if (waiting->when != 0 && (when == 0 || waiting->when < when))
            when = waiting->when;
    clock->when = 0;
    if (when != 0)
        set_clock(clock, when);
}

/* The one that is due; its time is over. NULL: there is none. */
static struct wake_timer *take_due(struct alarm_clock *clock, uint64_t now)
{
    struct waiting *waiting = clock->first;
    while (waiting && (waiting->when == 0 || now < waiting->when))
        waiting = waiting->next;
    if (!waiting)
        return NULL;
    waiting->when = 0;
    return waiting->timer;
}

static void on_wake(uv_async_t *handle)
{
    struct alarm_clock *clock = handle->data;
    uint64_t now = uv_hrtime();
    struct wake_timer *timer;
    while (clock == alarm_clock && (timer = take_due(clock, now)) != NULL)
        timer->expired(timer->context);
    if (clock == alarm_clock)
        wind_clock(clock);
}

static void on_closed(uv_handle_t *handle)
{
    free(handle->data);
}

static void stop_clock(void)
{
    if (alarm_clock->wait)
        UnregisterWaitEx(alarm_clock->wait, INVALID_HANDLE_VALUE); /* afterwards no thread is in on_signal() */
    CloseHandle(alarm_clock->timer);
    uv_close((uv_handle_t *)&alarm_clock->async, on_closed);
    alarm_clock = NULL;
}

static bool start_clock(uv_loop_t *loop)
{
    struct alarm_clock *clock = calloc(1, sizeof *clock);
    HANDLE timer = CreateWaitableTimerExA(NULL, NULL, HIGH_RESOLUTION, TIMER_ALL_ACCESS);
    if (!timer)
        timer = CreateWaitableTimerExA(NULL, NULL, 0, TIMER_ALL_ACCESS);
    if (!clock || !timer || uv_async_init(loop, &clock->async, on_wake) != 0) {
        if (timer)
            CloseHandle(timer);
        free(clock);
        return false;
    }
    clock->timer = timer;
    clock->async.data = clock;
    alarm_clock = clock;
    if (RegisterWaitForSingleObject(&clock->wait, timer, on_signal, clock, INFINITE, WT_EXECUTEINWAITTHREAD))
        return true;
    clock->wait = NULL;
    stop_clock();
    return false;
}

/* ---- Timers --------------------------------------------------------------------------------------------------------- */

bool wake_timer_open(struct wake_timer *timer, uv_loop_t *loop, void (*expired)(void *context), void *context)
{
    struct waiting *waiting = calloc(1, sizeof *waiting);
    if (!waiting || (!alarm_clock && !start_clock(loop))) {
        log_error("cannot make a timer: Windows has no more");
        free(waiting);
        return false;
    }
    *waiting = (struct waiting){.timer = timer, .next = alarm_clock->first};
    alarm_clock->first = waiting;
    timer->expired = expired;
    timer->context = context;
    timer->system = (intptr_t)waiting;
    timer->open = true;
    return true;
}

void wake_timer_set(struct wake_timer *timer, uint64_t when)
{
    if (!timer->open)
        return;
    uint64_t now = uv_hrtime();
    if (when != 0 && when < now)
        when = now; /* in the next turn of the loop, not once more in this one */
    waiting_of(timer)->when = when;
    if (when != 0 && (alarm_clock->when == 0 || when < alarm_clock->when))
        set_clock(alarm_clock, when);
}

void wake_timer_close(struct wake_timer *timer)
{
    if (!timer->open)
        return;
    struct waiting *waiting = waiting_of(timer);
    for (struct waiting **at = &alarm_clock->first; *at; at = &(*at)->next) {
        if (*at == waiting) {
            *at = waiting->next;
            break;
        }
    }
    timer->open = false;
    free(waiting);
    if (!alarm_clock->first)
        stop_clock();
}
