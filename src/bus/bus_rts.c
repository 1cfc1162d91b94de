/* SPDX-License-Identifier: MIT */
#include "bus_rts.h"

#include <errno.h>
#include <sys/timerfd.h>
#include <unistd.h>

#define NS_PER_SECOND UINT64_C(1000000000)
#define BITS_PER_BYTE 10u
#define NS_PER_LOOK 200000u /* between two looks whether the device has sent all */

static void set_timer(struct bus_rts *rts, uint64_t when)
{
    struct itimerspec spec = {
        .it_value = {.tv_sec = (time_t)(when / NS_PER_SECOND), .tv_nsec = (long)(when % NS_PER_SECOND)},
    };
    timerfd_settime(rts->timer_fd, TFD_TIMER_ABSTIME, &spec, NULL);
}

static void on_timer(uv_poll_t *handle, int status, int events)
{
    struct bus_rts *rts = handle->data;
    uint64_t expired;
    (void)status;
    (void)events;
    if (read(rts->timer_fd, &expired, sizeof expired) < 0 && errno == EAGAIN)
        return;
    if (rts->line->raised && !line_serial_lower(rts->line))
        set_timer(rts, uv_hrtime() + NS_PER_LOOK);
}

bool bus_rts_begin(struct bus_rts *rts, struct line *line, unsigned baud, uv_loop_t *loop)
{
    rts->line = line;
    rts->baud = baud;
    rts->timer.data = rts;
    rts->timer_fd = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
    int error = rts->timer_fd < 0 ? -errno : uv_poll_init(loop, &rts->timer, rts->timer_fd);
    if (error == 0)
        error = uv_poll_start(&rts->timer, UV_READABLE, on_timer);
    if (error != 0)
        log_error("cannot make a timer: %s", uv_strerror(error));
    return error == 0;
}

void bus_rts_lower_after(struct bus_rts *rts, size_t length)
{
    uint64_t now = uv_hrtime();
    if (rts->sent_until < now)
        rts->sent_until = now;
    rts->sent_until += (length * BITS_PER_BYTE * NS_PER_SECOND + rts->baud - 1u) / rts->baud;
    set_timer(rts, rts->sent_until);
}

void bus_rts_free(struct bus_rts *rts)
{
    if (rts->timer_fd >= 0)
        close(rts->timer_fd);
}
