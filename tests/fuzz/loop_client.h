/* SPDX-License-Identifier: MIT */
/* loop_client.h: a client of the control socket, and what it may expect of it (docs/CONTROL.md): each request with an id is
 * answered once, in its turn but for `wait`; each line that is none gets one error; events are of a subscription that there is,
 * of the kinds asked for, and in the order of time with the answers; the connection stays until the client has ended its
 * sending. */
#ifndef RKM04_TESTS_LOOP_CLIENT_H
#define RKM04_TESTS_LOOP_CLIENT_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CLIENT_LINES 2u          /* of the emulator */
#define CLIENT_SUBSCRIPTIONS 256u /* more than one client can ask for */

enum due_kind {
    DUE_OTHER, DUE_WAIT, DUE_ADVANCE, DUE_SUBSCRIBE, DUE_UNSUBSCRIBE, DUE_TRACE_STOP, DUE_SHUTDOWN, DUE_AUTHENTICATE
};

/* An answer that is to come. */
struct due {
    enum due_kind kind;
    json_t *id;
    json_t *params;    /* NULL: the request is none */
    unsigned line;
    bool doubtful;     /* several at a time have this id: it is not known which of them is answered */
    struct due *next;
};

struct subscribed {
    bool there;
    unsigned line;
    json_t *kinds; /* NULL: all */
};

struct client {
    int fd;            /* -1: not connected */
    bool reading;      /* it takes what comes */
    bool left;         /* it has ended its sending */
    bool hung_up;      /* the other end has closed the connection */
    bool crowded;      /* it may be one too many */
    bool over;         /* the emulator ends: what was not read by then may be cut off */
    char *part;        /* of a line, sent */
    size_t part_length, part_room;
    bool skipping;     /* the rest of a line that is too long */
    char *in;          /* received, not yet a line */
    size_t in_length, in_room;
    struct due *first; /* dues, in the order of the requests */
    bool silent_subscribe; /* without an id, or one of several: it is not known what came of it */
    struct subscribed subscription[CLIENT_SUBSCRIPTIONS];
    uint64_t told[CLIENT_LINES];     /* tick of a line before which no event may come any more */
    uint64_t latest;                 /* tick of the latest event */
    uint64_t answered[CLIENT_LINES]; /* tick of the latest answer, waits apart */
    unsigned shutdowns, shutdowns_silent, shutdowns_answered; /* requests; of them, without an id; those executed */
    size_t received, events;   /* bytes; notifications in them */
};

void client_none(struct client *client);

/* The emulator for all clients from now on: its socket `path`, or `tcp`, 127.0.0.1:PORT, if that is not NULL; its lines. */
void client_find(const char *path, const char *tcp, unsigned lines);

/* Connect to it. Returns false if none listens any more. */
bool client_connect(struct client *client);

/* Send; what the other end does not take is lost, and not expected to be answered. Returns the bytes that it took. */
size_t client_send(struct client *client, const char *text, size_t length);

/* End sending. */
void client_leave(struct client *client);

/* Take what has come, and check it. Returns true if something had. */
bool client_take(struct client *client);

/* All has been done that can be done, and the client has read it: no answer is due but those of `wait`. */
void client_check_quiet(const struct client *client);

/* Close the connection, forget everything. */
void client_close(struct client *client);

#endif
