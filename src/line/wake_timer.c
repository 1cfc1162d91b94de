/* SPDX-License-Identifier: MIT */
#include "wake_timer.h"

#include <errno.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "log.h"

#define NS_PER_SECOND UINT64_C(1000000000)

static void on_poll(uv_poll_t *handle, int status, int events)
{
    struct wake_timer *timer = handle->data;
    uint64_t expired;
    (void)status;
    (void)events;
    if (read((int)timer->system, &expired, sizeof expired) < 0 && errno == EAGAIN)
        return; /* it has been set again meanwhile */
    timer->expired(timer->context);
}

bool wake_timer_open(struct wake_timer *timer, uv_loop_t *loop, void (*expired)(void *context), void *context)
{
    int fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    timer->expired = expired;
    timer->context = context;
    timer->system = fd;
    timer->poll.data = timer;
    int error = fd < 0 ? -errno : uv_poll_init(loop, &timer->poll, fd);
    timer->open = error == 0;
    if (error == 0)
        error = uv_poll_start(&timer->poll, UV_READABLE, on_poll);
    if (error == 0)
        return true;
    log_error("cannot make a timer: %s", uv_strerror(error));
    if (fd >= 0 && !timer->open)
        close(fd);
    wake_timer_close(timer);
    return false;
}

void wake_timer_set(struct wake_timer *timer, uint64_t when)
{
    struct itimerspec spec = {
        .it_value = {.tv_sec = (time_t)(when / NS_PER_SECOND), .tv_nsec = (long)(when % NS_PER_SECOND)},
    };
    if (timer->open)
        timerfd_settime((int)timer->system, TFD_TIMER_ABSTIME, &spec, NULL);
}

void wake_timer_close(struct wake_timer *timer)
{
    if (!timer->open)
        return;
    timer->open = false;
    uv_close((uv_handle_t *)&timer->poll, NULL);
    close((int)timer->system);
}
