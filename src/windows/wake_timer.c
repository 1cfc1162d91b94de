/* SPDX-License-Identifier: MIT */
/* wake_timer.c: a waitable timer; a thread of the system's pool waits for it and wakes the event loop. */
#include <uv.h>

#include "line/line.h"

#define NS_PER_UNIT 100 /* of a waitable timer */
#define HIGH_RESOLUTION 2 /* CREATE_WAITABLE_TIMER_HIGH_RESOLUTION, from Windows 10, version 1803 */

struct waitable {
    HANDLE timer, wait;
    uint64_t when; /* ns for which it is set; 0: it is not */
};

static struct waitable *waitable_of(const struct wake_timer *timer)
{
    return (struct waitable *)timer->system;
}

static void CALLBACK on_signal(void *context, BOOLEAN timed_out)
{
    struct wake_timer *timer = context;
    (void)timed_out;
    uv_async_send(&timer->handle.async);
}

static void set(const struct waitable *waitable, uint64_t ns)
{
    LARGE_INTEGER due = {.QuadPart = -(LONGLONG)(ns / NS_PER_UNIT + 1)};
    SetWaitableTimer(waitable->timer, &due, 0, NULL, NULL, FALSE);
}

static void on_wake(uv_async_t *handle)
{
    struct wake_timer *timer = handle->data;
    struct waitable *waitable = waitable_of(timer);
    uint64_t now = uv_hrtime();
    if (!timer->open || waitable->when == 0)
        return;
    if (now < waitable->when) { /* it has been set again meanwhile, or the two clocks differ a little */
        set(waitable, waitable->when - now);
        return;
    }
    waitable->when = 0;
    timer->expired(timer->context);
}

static struct waitable *make_waitable(void)
{
    struct waitable *waitable = calloc(1, sizeof *waitable);
    if (!waitable)
        return NULL;
    waitable->timer = CreateWaitableTimerExA(NULL, NULL, HIGH_RESOLUTION, TIMER_ALL_ACCESS);
    if (!waitable->timer)
        waitable->timer = CreateWaitableTimerExA(NULL, NULL, 0, TIMER_ALL_ACCESS);
    if (waitable->timer)
        return waitable;
    free(waitable);
    return NULL;
}

bool wake_timer_open(struct wake_timer *timer, uv_loop_t *loop, void (*expired)(void *context), void *context)
{
    struct waitable *waitable = make_waitable();
    timer->expired = expired;
    timer->context = context;
    timer->system = (intptr_t)waitable;
    timer->handle.async.data = timer;
    timer->open = waitable && uv_async_init(loop, &timer->handle.async, on_wake) == 0;
    if (timer->open && RegisterWaitForSingleObject(&waitable->wait, waitable->timer, on_signal, timer, INFINITE,
                                                   WT_EXECUTEINWAITTHREAD))
        return true;
    log_error("cannot make a timer: Windows has no more");
    if (timer->open)
        uv_close((uv_handle_t *)&timer->handle.async, NULL);
    timer->open = false;
    if (waitable)
        CloseHandle(waitable->timer);
    free(waitable);
    return false;
}

void wake_timer_set(struct wake_timer *timer, uint64_t when)
{
    struct waitable *waitable = waitable_of(timer);
    if (!timer->open)
        return;
    uint64_t now = uv_hrtime();
    waitable->when = when;
    if (when == 0)
        CancelWaitableTimer(waitable->timer);
    else if (when <= now)
        uv_async_send(&timer->handle.async);
    else
        set(waitable, when - now);
}

void wake_timer_close(struct wake_timer *timer)
{
    struct waitable *waitable = waitable_of(timer);
    if (!timer->open)
        return;
    timer->open = false;
    UnregisterWaitEx(waitable->wait, INVALID_HANDLE_VALUE); /* from here on the thread of the pool is out of on_signal() */
    uv_close((uv_handle_t *)&timer->handle.async, NULL);
    CloseHandle(waitable->timer);
    free(waitable);
    timer->system = 0;
}
