/* SPDX-License-Identifier: MIT */
/* window_inside.h: the window: its pages, its port, its emulator. */
#ifndef RKM04_WINDOW_INSIDE_H
#define RKM04_WINDOW_INSIDE_H

#include <limits.h>
#include <stdbool.h>
#include <uv.h>

#include "window_page.h"
#include "window_port.h"
#include "window_system.h"
#include "window_watch.h"

#define WINDOW_TOKEN_SIZE 33 /* 128 bits in hexadecimal digits, and a zero */

struct lws_context;

struct window {
    uv_loop_t loop;
    struct lws_context *server;
    char token[WINDOW_TOKEN_SIZE];
    char host[80];    /* ADDRESS:PORT, as a browser names it */
    unsigned listens; /* the port number */
    unsigned timeout_ms; /* how long an answer of a unit is waited for if the page does not say */
    struct pages pages;
    struct window_port port;
    struct window_watch watch;
    char folder[PATH_MAX]; /* of files for downloads; empty: not made yet */
    uv_signal_t signals[WINDOW_SIGNALS];
    uv_poll_t input;
};

#endif
