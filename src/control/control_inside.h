/* SPDX-License-Identifier: MIT */
/* control_inside.h: what the parts of the control socket share. */
#ifndef RKM04_CONTROL_INSIDE_H
#define RKM04_CONTROL_INSIDE_H

#include "condition/condition.h"
#include "control.h"
#include "control_peer.h"
#include "control_rpc.h"
#include "control_socket.h"

#define CONTROL_CLIENTS 64u
#define CONTROL_WAITS 64u        /* per client */
#define CONTROL_SUBSCRIPTIONS 16u /* per client */
#define CONTROL_TRACES 16u       /* at a time */

struct control_call;
struct subscription;
struct trace_file;
struct wire_file;

/* A file begun with trace.start; one of the two. */
struct control_trace {
    unsigned number; /* 0: this place is free */
    unsigned line;
    char *path;
    struct trace_file *trace;
    struct wire_file *wire;
};

/* A `restore` of a file that goes on between the turns of the loop. */
struct control_restore {
    struct control_client *client; /* NULL: there is none */
    struct bus *bus;
    json_t *id;
    struct restore *restore;
    uint64_t deadline, slice_end; /* ns */
};

/* A client with what it waits for. */
struct control_client {
    struct peer peer; /* first: client_of() */
    struct control *control;
    struct control_client *next;
    struct control_call *calls;   /* that it waits for (control_time.c, as the next two) */
    unsigned waits;               /* of these, without `advance` */
    struct control_call *advance; /* NULL: none is running */
    bool restores;                /* a `restore` of it goes on (control_restore.c) */
    struct subscription *subscriptions; /* control_subscribe.c, as the next one */
    unsigned subscribed;          /* number of the last subscription */
};

struct control {
    uv_loop_t *loop;
    struct bus *const *buses;
    unsigned lines;
    struct control_calls calls;
    struct control_socket socket;

    uv_pipe_t listener;
    uv_prepare_t turn;  /* once a turn of the loop: what has been gathered for clients goes out */
    uv_idle_t work;     /* runs while there are lines to be obeyed */
    uv_idle_t restoring; /* runs while there is a `restore` */
    struct control_restore restore;
    uv_timer_t look;    /* runs while somebody has ended its sending: has it gone? */
    uv_timer_t ending;  /* shutdown: the longest time for the answer to be read */
    bool open, working;

    struct control_client *clients;
    unsigned client_count;
    struct control_client *ender; /* who asked for shutdown; NULL: nobody */
    struct control_trace traces[CONTROL_TRACES];
    unsigned last_trace;
};

/* Obey a line of a client, or refuse it. Returns false if it cannot be obeyed yet: to be offered again when control_work() has
 * been called. */
bool control_obey(struct control_client *client, const char *line, size_t length);

/* The emulator is to end when this client has read its answer. */
void control_end(struct control_client *client);

/* A line was too long, or has no newline. */
void control_refuse_line(struct control_client *client, int code, const char *text);

/* There may be lines to be obeyed. */
void control_work(struct control *control);

/* Answer a request; `id` NULL: it wants none. Take the reference to `result`. */
void control_answer(struct control_client *client, const json_t *id, json_t *result);
void control_refuse(struct control_client *client, const json_t *id, const struct refusal *refusal);

/* Methods of the host. They return the result, a new reference; NULL: refused, or, where `later` or `again` is set, not yet. */
struct control_context {
    struct control_client *client;
    struct bus *bus;
    const struct rpc_request *request;
    bool later; /* it has been answered by control_answer(), or is when it comes true */
    bool again; /* it cannot be done yet: control_obey() returns false */
};
typedef json_t *control_method(struct control_context *context, struct refusal *refusal);

control_method control_wait, control_advance;             /* control_time.c */
control_method control_subscribe, control_unsubscribe;    /* control_subscribe.c */
control_method control_trace_start, control_trace_stop;   /* control_trace.c */
control_method control_restore;                           /* control_restore.c: with `file` */

/* Is a client moving this clock, perhaps between two slices? */
bool control_time_is_moved(const struct control *control, const struct bus *bus);

/* The client has read: an `advance` that waited for that goes on. */
void control_time_go_on(struct control_client *client);

/* A client goes. */
void control_time_forget(struct control_client *client);
void control_subscribe_forget(struct control_client *client);
void control_restore_forget(struct control_client *client);

/* The socket is closed: end all files. */
void control_trace_end(struct control *control);

#endif
