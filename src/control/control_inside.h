/* SPDX-License-Identifier: MIT */
/* control_inside.h: what the parts of the control socket share. */
#ifndef RKM04_CONTROL_INSIDE_H
#define RKM04_CONTROL_INSIDE_H

#include "condition/condition.h"
#include "control.h"
#include "control_connection.h"
#include "control_file.h"
#include "control_place.h"
#include "control_rpc.h"
#include "line/line.h"
#include "trace/trace.h"

#define CONTROL_CLIENTS 64u
#define CONTROL_TOO_MANY "too many clients: expected at most %u at a time"
#define CONTROL_WAITS 64u        /* per client */
#define CONTROL_SUBSCRIPTIONS 16u /* per client */

struct control_call;
struct subscription;

/* A `restore` of a file that continues between the turns of the loop. */
struct control_restore {
    struct control_client *client; /* NULL: there is none */
    struct bus *bus;
    json_t *id;
    struct restore *restore;
    uint64_t deadline, slice_end; /* ns */
};

/* A client with what it waits for. */
struct control_client {
    struct connection connection; /* first: client_of() */
    struct control *control;
    struct control_client *next;
    struct control_call *calls;   /* that it waits for (control_time.c, as the next two) */
    unsigned waits;               /* of these, without `advance` */
    struct control_call *advance; /* NULL: none is running */
    bool restores;                /* a `restore` of it continues (control_restore.c) */
    struct subscription *subscriptions; /* control_subscribe.c, as the next one */
    unsigned subscribed;          /* number of the last subscription */
    uint64_t deadline;            /* ms of the loop; of a stranger (control_door.c) */
};

struct control {
    uv_loop_t *loop;
    struct bus *const *buses;
    unsigned lines;
    struct control_calls calls;
    struct control_place place;
    char address[NET_NAME_SIZE];             /* of the TCP port; "": a Unix socket */
    char token[CONTROL_TOKEN_LENGTH + 1];

    union {
        uv_handle_t handle;
        uv_stream_t stream;
        uv_pipe_t pipe;
        uv_tcp_t tcp;
    } listener;
    uv_prepare_t turn;   /* once a turn of the loop: sends what has been gathered for the clients */
    uv_idle_t work;      /* runs while there are lines to be handled */
    uv_idle_t restoring; /* runs while there is a `restore` */
    struct control_restore restore;
    uv_timer_t check;   /* runs while a client has closed its sending side: checks whether it is gone */
    uv_timer_t ending;  /* shutdown: the longest time for the answer to be read */
    uv_timer_t door;    /* runs while there are strangers */
    bool open, working;

    struct control_client *clients;
    unsigned client_count;
    struct control_client *strangers; /* clients that have not shown the token yet, the newest first */
    unsigned stranger_count;
    struct control_client *ender; /* who asked for shutdown; NULL: none */
    struct control_client *last;  /* the same, when it has read its answer: sees the end of its connection last; NULL: none */
    struct trace_set traces;
};

/* Execute a client's line, or refuse it. Returns false if that is not possible yet: the line is passed again after
 * control_schedule_lines() has been called. */
bool control_handle_line(struct control_client *client, const char *line, size_t length);

/* End the emulator as soon as this client has read its answer. */
void control_end(struct control_client *client);

/* A line was too long, or has no newline. */
void control_refuse_line(struct control_client *client, int code, const char *text);

/* A client may send requests from now on. */
void control_add_client(struct control_client *client);

/* A stranger has come; it goes, or is a stranger no longer: returns false if it was none. Its first line has come, or cannot be
 * one. control_door.c. */
void control_door_add(struct control_client *client);
bool control_door_remove(struct control_client *client);
void control_door_line(struct control_client *client, const char *line, size_t length);
void control_door_refuse(struct control_client *client);

/* Schedule the handling of lines in the next turn of the loop. */
void control_schedule_lines(struct control *control);

/* Answer a request; `id` NULL: the request wants no answer. Take the reference to `result`. */
void control_answer(struct control_client *client, const json_t *id, json_t *result);
void control_refuse(struct control_client *client, const json_t *id, const struct refusal *refusal);

/* Methods of the host. They return the result, a new reference; NULL: refused, or, where `later` or `again` is set, not yet. */
struct control_context {
    struct control_client *client;
    struct bus *bus;
    const struct rpc_request *request;
    bool later; /* it has been answered by control_answer(), or is when it comes true */
    bool again; /* it cannot be done yet: control_handle_line() returns false */
};
typedef json_t *control_method(struct control_context *context, struct refusal *refusal);

control_method control_wait, control_advance, control_exchange; /* control_time.c */
control_method control_subscribe, control_collected, control_unsubscribe; /* control_subscribe.c */
control_method control_trace_start, control_trace_stop;   /* control_trace.c */
control_method control_restore;                           /* control_restore.c: with `file` */

/* Is a client moving this clock, perhaps between two slices? */
bool control_time_is_moved(const struct control *control, const struct bus *bus);

/* The client has read: continue an `advance` that waited for that. */
void control_time_continue(struct control_client *client);

/* A client is being closed: drop what belongs to it. */
void control_time_remove_client(struct control_client *client);
void control_subscribe_remove_client(struct control_client *client);
void control_restore_remove_client(struct control_client *client);

/* The socket is closed: end all files. */
void control_trace_end(struct control *control);

#endif
