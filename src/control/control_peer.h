/* SPDX-License-Identifier: MIT */
/* control_peer.h: a client of the control socket: its lines, what waits to be read by it, and the limits of both. Knows nothing
 * of what the lines say.
 *
 *     socket --on_read--> in --peer_serve()--> control_obey()
 *     peer_say(), peer_tell() --> out --peer_pump()--> wire --> socket
 *
 * Bytes leave in peer_pump(), which control.c calls once a turn of the event loop for everybody: many events make one write. */
#ifndef RKM04_HOST_CONTROL_PEER_H
#define RKM04_HOST_CONTROL_PEER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#define PEER_LINE_MAX 1048576u           /* bytes of a request, without its newline */
#define PEER_IN_MAX (PEER_LINE_MAX + 65536u)
#define PEER_EVENTS_MAX (8u << 20)       /* bytes not yet read beyond which events are dropped */
#define PEER_QUEUE_MAX (PEER_EVENTS_MAX + (1u << 20)) /* beyond which requests wait */
#define PEER_QUEUE_SMALL (1u << 20)      /* below which an `advance` goes on */

struct control;
struct control_call;
struct subscription;

/* Bytes in a row: those from `at` to `length` count. */
struct bytes {
    char *byte;
    size_t at, length, room;
};

struct peer {
    struct control *control;
    struct peer *next;
    uv_pipe_t pipe;
    uv_write_t write;
    bool leaving;    /* it sends no more; it may still read */
    bool closing;
    bool failed;     /* it is to be closed at the next turn */
    bool reading, writing;
    bool skipping;   /* the rest of a line that was too long */
    bool blocked;    /* its next line cannot be obeyed yet */
    struct bytes in, out, wire;
    size_t looked;   /* bytes of `in` in which there is no newline, counted from `at` */
    uint64_t lost;   /* events dropped and not yet told of */
    uint64_t lost_tick; /* of the first one */

    struct control_call *calls; /* that it waits for (control_time.c) */
    unsigned waits;             /* of these, without `advance` */
    struct control_call *advance; /* NULL: none is running */
    bool restores;              /* a `restore` of it goes on (control_restore.c) */
    struct subscription *subscriptions;
    unsigned subscribed;        /* number of the last subscription */
};

/* Accept a client. Returns NULL if memory is short, or nobody is there. */
struct peer *peer_accept(struct control *control, uv_stream_t *listener);

/* Begin to hear it. */
void peer_start(struct peer *peer);

/* Obey lines of it for about `budget` ns, at least one. Returns true if there are more that could be obeyed now. */
bool peer_serve(struct peer *peer, uint64_t budget);

/* Send text[0..length): answers, which are never dropped. */
void peer_say(struct peer *peer, const char *text, size_t length);

/* Room for an event of up to `room` characters; NULL: it is dropped and counted. peer_told() takes where it ends. */
char *peer_tell(struct peer *peer, size_t room, uint64_t tick);
void peer_told(struct peer *peer, const char *end);

/* Bytes that it has not read. */
size_t peer_queue(const struct peer *peer);

/* Send what there is, as far as the system takes it. */
void peer_pump(struct peer *peer);

/* Has it hung up altogether (not just ended its own sending)? */
bool peer_gone(const struct peer *peer);

/* Hang up. The peer frees itself when the loop has closed its handle. */
void peer_close(struct peer *peer);

#endif
