/* SPDX-License-Identifier: MIT */
/* control_connection.h: the connection of one control client: its lines, the bytes that wait to be read by it, and the limits
 * of both. It does not interpret the lines. A client is a stranger, of whom few bytes are taken, until it is admitted.
 *
 *     socket --on_read--> in --connection_serve()--> handle_line()
 *     connection_send(), connection_begin_event() --> out --connection_flush()--> wire --> socket
 *
 * connection_flush() sends the bytes; control.c calls it for every client once a turn of the event loop, so that many events
 * make one write. */
#ifndef RKM04_CONTROL_CONNECTION_H
#define RKM04_CONTROL_CONNECTION_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#define CONNECTION_LINE_MAX 1048576u           /* bytes of a request, without its newline */
#define CONNECTION_IN_MAX (CONNECTION_LINE_MAX + 65536u)
#define CONNECTION_FIRST_MAX 512u              /* bytes of the first line of a stranger */
#define CONNECTION_IGNORED_MAX 65536u          /* bytes of a client that has been turned away; then it is closed */
#define CONNECTION_EVENTS_MAX (8u << 20)       /* bytes not yet read beyond which events are dropped */
#define CONNECTION_QUEUE_MAX (CONNECTION_EVENTS_MAX + (1u << 20)) /* beyond which requests wait */
#define CONNECTION_QUEUE_SMALL (1u << 20)      /* below which an `advance` continues */

struct connection;

/* Callbacks given by control.c. */
struct connection_calls {
    /* Handle a line: execute or refuse it. Returns false if that is not possible yet; connection->blocked is set then. */
    bool (*handle_line)(struct connection *connection, const char *line, size_t length);
    /* The line is refused: it is too long, or has no newline. */
    void (*refuse)(struct connection *connection, int code, const char *text);
    bool (*is_held)(const struct connection *connection);      /* returns whether its next line waits for a request of its own */
    bool (*is_expecting)(const struct connection *connection); /* returns whether answers or events may still come for it */
    bool (*is_queued)(const struct connection *connection);    /* returns whether connection_serve() will be called in any case */
    void (*more)(struct connection *connection);               /* lines may be left: connection_serve() is due */
    void (*leaving)(struct connection *connection);            /* it has closed its sending side */
    void (*flushed)(struct connection *connection);            /* bytes have been sent: it may have room again */
    void (*gone)(struct connection *connection);               /* it is being closed */
    void (*closed)(struct connection *connection);             /* the loop has closed its handle: its memory can go */
};

/* Bytes in a row: those from `at` to `length` count. */
struct bytes {
    char *byte;
    size_t at, length, room;
};

struct connection {
    const struct connection_calls *calls;
    union {
        uv_handle_t handle;
        uv_stream_t stream;
        uv_pipe_t pipe;
        uv_tcp_t tcp;
    } end; /* ours */
    uv_write_t write;
    uv_shutdown_t shutdown;
    bool is_tcp;     /* who has ended its sending has gone: the system does not know more */
    bool stranger;   /* not admitted yet */
    bool turned_away;
    size_t ignored;  /* bytes since then */
    bool leaving;    /* it sends no more; it may still read */
    bool gone;       /* it reads no more either: what it has sent is still done, what is sent to it is dropped */
    bool closing;
    bool failed;     /* it is to be closed at the next turn */
    bool reading, writing;
    bool skipping;   /* the rest of a line that was too long */
    bool blocked;    /* its next line cannot be handled yet */
    struct bytes in, out, wire;
    size_t scanned;     /* bytes of `in` in which there is no newline, counted from `at` */
    uint64_t lost;      /* events dropped and not yet reported */
    uint64_t lost_tick; /* of the first one */
};

/* Accept a client; *connection is zero. Over TCP it is a stranger. Returns false if there is none; the connection is closed
 * then. */
bool connection_accept(struct connection *connection, uv_loop_t *loop, uv_stream_t *listener,
                       const struct connection_calls *calls);

/* Its further lines are read with the limits of all clients. */
void connection_admit(struct connection *connection);

/* Send what was given to connection_send() and close it: not at once, since bytes that it has still sent would take the answer
 * away with them. What comes is ignored. */
void connection_turn_away(struct connection *connection);

/* Start reading. */
void connection_start(struct connection *connection);

/* Handle its lines for about `budget` ns, at least one line. Returns true if more lines can be handled now. */
bool connection_serve(struct connection *connection, uint64_t budget);

/* Send text[0..length): answers, which are never dropped. */
void connection_send(struct connection *connection, const char *text, size_t length);

/* Returns space for an event of up to `room` characters, or NULL if the event is dropped (and counted). The caller passes the
 * end of the written text to connection_end_event(). */
char *connection_begin_event(struct connection *connection, size_t room, uint64_t tick);
void connection_end_event(struct connection *connection, const char *end);

/* Number of bytes that the client has not read. */
size_t connection_unread(const struct connection *connection);

/* Send the waiting bytes, as many as the system takes. */
void connection_flush(struct connection *connection);

/* Returns whether the client has closed both directions (not just its sending side). */
bool connection_is_gone(const struct connection *connection);

/* The client has gone: do what it has sent, up to what it would have to wait for, and close the connection. */
void connection_forsake(struct connection *connection);

/* Close the connection. closed() is called when the loop has closed its handle. */
void connection_close(struct connection *connection);

/* The same in two steps: nothing is done for the client any more, which sees the end of the connection later. */
void connection_abandon(struct connection *connection);
void connection_hang_up(struct connection *connection);

#endif
