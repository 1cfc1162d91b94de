/* SPDX-License-Identifier: MIT */
/* client_link.h: one request and its answer over an open line, as the host (node 0, specification section 4). */
#ifndef RKM04_CLIENT_LINK_H
#define RKM04_CLIENT_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <rkm04/link.h>

#define CLIENT_MESSAGE_MAX 9216 /* bytes of the longest message in either direction (L4) */
#define CLIENT_BAUD 19200       /* of the line (U7) */

enum client_outcome {
    CLIENT_ANSWERED,
    CLIENT_SENT,   /* to all units: none answers */
    CLIENT_SILENT, /* no answer in time (reported, with advice) */
    CLIENT_LOST,   /* the line failed (reported) */
    CLIENT_CANCELLED
};

struct client {
    /* Set by the caller. */
    int fd;           /* non-blocking */
    const char *port; /* name for messages */
    const struct rkm04_framing *framing;
    uint8_t node;        /* 1..16; 0 = all units */
    unsigned timeout_ms; /* how long a unit may be silent when it is its turn */
    const int *cancel;   /* a descriptor: while it is readable no request is under way; NULL: none */
    /* Called about ten times a second while a request is under way; NULL: not wanted. sent: bytes of the request that have
     * left at the line's speed. */
    void (*progress)(void *context, size_t sent);
    void *context;

    /* The answer. */
    uint8_t answer[CLIENT_MESSAGE_MAX];
    size_t length;

    struct rkm04_receiver receiver;
    struct rkm04_receiver unbroken; /* of the same bytes as if they had come without silences */
    size_t first_count;
    char first[256];             /* bytes that came: a text, if we are refused */
    uint32_t received;           /* bytes that came since the request */
    uint32_t unexpected;         /* whole messages among them that were not the answer */
    uint32_t echoed;             /* of these, the request itself */
    struct rkm04_receiver other; /* what the same bytes are in the other framing: counts only */
    uint32_t foreign;            /* whole messages in it */
    uint8_t foreign_message[CLIENT_MESSAGE_MAX];
    uint8_t unbroken_message[CLIENT_MESSAGE_MAX];
    uint8_t wire[2 * CLIENT_MESSAGE_MAX + 2 * RKM04_FRAME_EDGE_MAX];
};

/* Send a message of 1..CLIENT_MESSAGE_MAX bytes and wait for its answer: same message number (or 255 and that number), from
 * the unit asked. Whatever else comes is passed over; what came before is dropped. The time limit runs from the moment
 * at which the request has gone out at the line's speed, and again from each byte that comes.
 * Returns the outcome; the answer is in client->answer. */
enum client_outcome client_exchange(struct client *client, const uint8_t *request, size_t length);

#endif
