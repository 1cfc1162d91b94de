/* SPDX-License-Identifier: MIT */
/* window_port.h: the one port of the window, and the jobs on it, one after the other, in a thread of libuv's pool. */
#ifndef RKM04_WINDOW_PORT_H
#define RKM04_WINDOW_PORT_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "window_job.h"

struct pages;

/* Returns false if the system has no more descriptors (reported). */
bool window_port_begin(struct window_port *port, struct pages *pages);

/* Give up all jobs. The port is closed when the thread has ended. */
void window_port_end(struct window_port *port);

/* Close the port, after the last job. */
void window_port_close(struct window_port *port);

/* A job with a copy of what was asked; NULL: no memory. */
struct port_job *port_job_new(enum port_kind kind, uint64_t page, json_t *request);
void port_job_free(struct port_job *job);

/* Do it after those before it; PORT_STOP at once: all others are given up. Takes the job. Returns false if there are too many. */
bool window_port_do(struct window_port *port, struct port_job *job);

/* What pages get about the port: {"event": "port", "port": NAME or null, "framing": …}. New reference. */
json_t *window_port_json(const struct window_port *port);

#endif
