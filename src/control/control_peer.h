/* SPDX-License-Identifier: MIT */
/* control_peer.h: a client of the control socket: its lines, what waits to be read by it, and the limits of both. Knows nothing
 * of what the lines say.
 *
 *     socket --on_read--> in --peer_serve()--> obey()
 *     peer_say(), peer_tell() --> out --peer_pump()--> wire --> socket
 *
 * Bytes leave in peer_pump(), which control.c calls once a turn of the event loop for everybody: many events make one write. */
#ifndef RKM04_CONTROL_PEER_H
#define RKM04_CONTROL_PEER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#define PEER_LINE_MAX 1048576u           /* bytes of a request, without its newline */
#define PEER_IN_MAX (PEER_LINE_MAX + 65536u)
#define PEER_EVENTS_MAX (8u << 20)       /* bytes not yet read beyond which events are dropped */
#define PEER_QUEUE_MAX (PEER_EVENTS_MAX + (1u << 20)) /* beyond which requests wait */
#define PEER_QUEUE_SMALL (1u << 20)      /* below which an `advance` goes on */

struct peer;

/* What a client reports, and asks, upwards. */
struct peer_calls {
    /* Obey a line or refuse it. Returns false if it cannot be obeyed yet: peer->blocked is set then. */
    bool (*obey)(struct peer *peer, const char *line, size_t length);
    /* The line is refused: it is too long, or has no newline. */
    void (*refuse)(struct peer *peer, int code, const char *text);
    bool (*is_held)(const struct peer *peer);    /* returns whether its next line waits for a request of its own */
    bool (*is_expecting)(const struct peer *peer); /* returns whether answers or events may still come for it */
    bool (*is_queued)(const struct peer *peer);  /* returns whether peer_serve() will be called in any case */
    void (*more)(struct peer *peer);             /* there may be lines to be obeyed: peer_serve() is due */
    void (*leaving)(struct peer *peer);          /* it has ended its sending */
    void (*pumped)(struct peer *peer);           /* bytes have been sent: it may have room again */
    void (*gone)(struct peer *peer);             /* it is being closed */
    void (*closed)(struct peer *peer);           /* the loop has closed its handle: its memory can go */
};

/* Bytes in a row: those from `at` to `length` count. */
struct bytes {
    char *byte;
    size_t at, length, room;
};

struct peer {
    const struct peer_calls *calls;
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
};

/* Accept a client; *peer is zero. Returns false if nobody is there: then it is closed. */
bool peer_accept(struct peer *peer, uv_loop_t *loop, uv_stream_t *listener, const struct peer_calls *calls);

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

/* Hang up. closed() is called when the loop has closed its handle. */
void peer_close(struct peer *peer);

#endif
