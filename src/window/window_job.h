/* SPDX-License-Identifier: MIT */
/* window_job.h: the port of the window, and a job on it. For the files of the port. */
#ifndef RKM04_WINDOW_JOB_H
#define RKM04_WINDOW_JOB_H

#include <jansson.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <uv.h>

#include "client/client.h"

#define PORT_JOBS_MAX 64u /* that wait */
#define PORT_TROUBLE 2048u

struct pages;

enum port_kind { PORT_OPEN, PORT_CLOSE, PORT_REQUEST, PORT_SEND, PORT_STOP };

struct port_job {
    struct port_job *next;
    enum port_kind kind;
    uint64_t page;      /* who has asked; 0: none */
    json_t *request;    /* its words: a reference */
    unsigned node, motor, timeout_ms;
    bool poll;          /* a repeated question: only who asked gets the answer */
    char *text;         /* PORT_OPEN: the port; PORT_SEND: the program */
    size_t length;
    size_t message_max; /* PORT_SEND */
    const struct rkm04_framing *framing; /* PORT_OPEN */
    uint8_t message[CLIENT_MESSAGE_MAX]; /* PORT_REQUEST */
    size_t message_length;
    uint64_t asked;     /* us, when it was asked */
    json_t *result;     /* of the thread */
    char trouble[PORT_TROUBLE];
};

struct window_port {
    struct pages *pages;
    struct client client;   /* of the thread while a job is under way */
    char name[PATH_MAX];    /* of the open port; empty: none. Of the thread, too; after a job copied to: */
    char shown[PATH_MAX];
    const struct rkm04_framing *framing;
    int cancel;             /* of window_cancel_open(): set while the job under way is to end */
    struct port_job *first, *last, *present;
    unsigned waiting;
    uv_work_t work;
    uv_async_t progress;
    atomic_size_t sent, total;
};

#endif
