/* SPDX-License-Identifier: MIT */
#include "line.h"

static void on_poll(uv_poll_t *handle, int status, int events)
{
    struct line_poll *poll = handle->data;
    (void)status; /* a hang-up shows when reading */
    (void)events;
    poll->readable(poll->context);
}

int line_poll_start(struct line_poll *poll)
{
    return poll->open ? uv_poll_start(&poll->handle.poll, UV_READABLE, on_poll) : UV_EINVAL;
}

void line_poll_stop(struct line_poll *poll)
{
    if (poll->open)
        uv_poll_stop(&poll->handle.poll);
}

int line_poll_open(struct line_poll *poll, uv_loop_t *loop, struct line *line)
{
    poll->line = line;
    poll->handle.poll.data = poll;
    int error = uv_poll_init(loop, &poll->handle.poll, line->fd);
    poll->open = error == 0;
    if (error == 0)
        error = line_poll_start(poll);
    if (error != 0)
        line_poll_close(poll);
    return error;
}

static void on_closed(uv_handle_t *handle)
{
    struct line_poll *poll = handle->data;
    if (poll->closed)
        poll->closed(poll->context);
}

void line_poll_close(struct line_poll *poll)
{
    if (!poll->open)
        return;
    poll->open = false;
    uv_close((uv_handle_t *)&poll->handle.poll, on_closed);
}
