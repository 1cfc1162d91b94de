/* SPDX-License-Identifier: MIT */
/* window_system.h: what the window asks of the system. src/windows has another one. */
#ifndef RKM04_WINDOW_SYSTEM_H
#define RKM04_WINDOW_SYSTEM_H

#include <stdbool.h>
#include <uv.h>

#define WINDOW_SIGNALS 3u

/* Signals that end the window. */
extern const int window_signals[WINDOW_SIGNALS];

/* For --help: what ends the window; examples, a line each. */
extern const char window_ended_by[], window_examples[];

/* What --help says of an option: `text`, or what is so on this system. `name`: without the dashes. */
const char *window_option_text(const char *name, const char *text);

/* Before anything else is done. */
void window_system_begin(void);

/* --bound: wait for a byte on stdin. Returns false if stdin ends before it. */
bool window_is_wanted(void);

/* --bound: the end of stdin stops the loop. */
void window_watch_input(uv_loop_t *loop, uv_poll_t *input);

/* Show the address in the user's browser; what does not work is reported. */
void window_show_in_browser(const char *address);

/* A connection to an emulator. */
union window_stream {
    uv_handle_t handle;
    uv_stream_t stream;
    uv_pipe_t pipe;
    uv_tcp_t tcp;
};

/* Let the loop read and write the connection that client_rpc_open() has made. The handle is begun in any case. Returns 0 or an
 * error of libuv. */
int window_stream_open(uv_loop_t *loop, union window_stream *stream, int fd);

/* A flag that ends a request under way: client.cancel. Returns its number; -1: the system has no more descriptors. */
int window_cancel_open(void);
void window_cancel_set(int cancel);
void window_cancel_clear(int cancel);
void window_cancel_close(int cancel);

#endif
