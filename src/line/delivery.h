/* SPDX-License-Identifier: MIT */
/* delivery.h: a text for a descriptor whose reader may be slow, stopped or gone. A thread of its own writes it, so that nothing
 * else waits (log.h says why no other way does). The caller ignores SIGPIPE. */
#ifndef RKM04_LINE_DELIVERY_H
#define RKM04_LINE_DELIVERY_H

#include <stdbool.h>
#include <stddef.h>
#include <time.h>

struct delivery;

/* Begin to write `text` in one piece. close_it: close the descriptor after it. Returns NULL if there is no memory or thread. */
struct delivery *delivery_begin(int fd, const char *text, bool close_it);

/* Wait for the end, but at most `milliseconds`; *delivery is not to be used any more. Returns 0 if all is written, or it is
 * not wanted (the reader has gone, the stream was closed from the beginning), or it is still on its way; else the errno of the
 * failure. What is still on its way when the process ends is lost. */
int delivery_wait(struct delivery *delivery, unsigned milliseconds);

/* Write all of the text, in one piece if the system takes it so; waits as long as that takes, even if O_NONBLOCK is
 * set. Returns 0 or the errno. */
int delivery_write(int fd, const char *text, size_t length);

/* Start a thread that is never waited for, and in which no signal is handled: not even one of a terminal whose user wants no
 * output from the background (SIGTTOU). Returns false if there is none to be had. */
bool delivery_thread(void *(*run)(void *context), void *context);

/* The time of CLOCK_MONOTONIC in so many milliseconds. */
struct timespec delivery_deadline(unsigned milliseconds);

#endif
