/* SPDX-License-Identifier: MIT */
#include "window_system.h"

#include <err.h>
#include <signal.h>
#include <spawn.h>
#include <stdint.h>
#include <sys/eventfd.h>
#include <unistd.h>

extern char **environ;

const int window_signals[WINDOW_SIGNALS] = {SIGTERM, SIGINT, SIGHUP};
const char window_ended_by[] = "SIGTERM, SIGINT or SIGHUP";
const char window_examples[] =
    "  rkmctl window --open\n"
    "  rkmctl window -p /dev/ttyUSB0\n"
    "  rkmctl window -c $XDG_RUNTIME_DIR/rkm04/bus0.control\n";

const char *window_option_text(const char *name, const char *text)
{
    (void)name;
    return text;
}

void window_system_begin(void)
{
    signal(SIGPIPE, SIG_IGN);
}

bool window_is_wanted(void)
{
    char byte;
    return read(STDIN_FILENO, &byte, 1) == 1;
}

static void on_input(uv_poll_t *handle, int status, int events)
{
    char bytes[16];
    (void)events;
    if (status < 0 || read(STDIN_FILENO, bytes, sizeof bytes) <= 0)
        uv_stop(handle->loop);
}

void window_watch_input(uv_loop_t *loop, uv_poll_t *input)
{
    if (uv_poll_init(loop, input, STDIN_FILENO) == 0)
        uv_poll_start(input, UV_READABLE, on_input);
}

void window_show_in_browser(const char *address)
{
    char *const words[] = {"xdg-open", (char *)(uintptr_t)address, NULL};
    pid_t child;
    signal(SIGCHLD, SIG_IGN); /* its end is not awaited */
    if (posix_spawnp(&child, words[0], NULL, NULL, words, environ) != 0)
        warnx("cannot start xdg-open: open the address yourself");
}

int window_stream_open(uv_loop_t *loop, union window_stream *stream, int fd)
{
    uv_pipe_init(loop, &stream->pipe, 0);
    return uv_pipe_open(&stream->pipe, fd);
}

/* ---- The flag: readable while it is set ------------------------------------------------------------------------------- */

int window_cancel_open(void)
{
    return eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
}

void window_cancel_set(int cancel)
{
    const uint64_t one = 1;
    if (write(cancel, &one, sizeof one) < 0)
        return; /* it is readable already */
}

void window_cancel_clear(int cancel)
{
    uint64_t count;
    while (read(cancel, &count, sizeof count) > 0)
        ;
}

void window_cancel_close(int cancel)
{
    if (cancel >= 0)
        close(cancel);
}
