/* SPDX-License-Identifier: MIT */
/* service_port.h: a TCP port for many clients, each with a connection of its own. It knows bytes alone. All calls back come from
 * the loop, never from within service_port_send(). */
#ifndef RKM04_LINE_SERVICE_PORT_H
#define RKM04_LINE_SERVICE_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "net_address.h"

#define SERVICE_IN 1024u       /* bytes read from a client at once */
#define SERVICE_OUT_MAX 65536u /* bytes that may wait for a client to read; with one more it is hung up */
#define SERVICE_STINT 2000000u /* ns: after them no more clients are read in a turn of the loop */

struct service_connection;

struct service_port_calls {
    /* A client has come. Returns a number for it, from 1 on; 0: there are too many. service_port_greet() may be called within. */
    unsigned (*open)(void *context, const char *peer);
    /* Returns how many of the bytes it has taken, at least one; the others are handed in again when the client has got what it
     * was sent. */
    size_t (*bytes)(void *context, unsigned client, const uint8_t *bytes, size_t length);
    void (*closed)(void *context, unsigned client, const char *why); /* it has gone, or does not read */
};

struct service_port {
    char address[NET_NAME_SIZE]; /* where it listens, with the real port */

    /* Inside. */
    const struct service_port_calls *calls;
    void *context;
    const char *refusal; /* what one too many is sent; NULL: nothing */
    uv_tcp_t listener;
    uv_idle_t turn;      /* begins each turn of the loop while a client has been read and waits for its next read */
    uint64_t stint_end;  /* uv_hrtime() from which no client is read in this turn */
    bool is_over;        /* the stint */
    unsigned reads;      /* in this turn */
    bool open;
    struct service_connection *opening; /* open() is being called for it */
    struct service_connection *first;
};

/* Listen at `address`, with its host in digits. calls, context and refusal must stay; *port must be zero, and must stay until it
 * is closed and the loop has run out. Failures are reported. Returns false if it did not work. */
bool service_port_open(struct service_port *port, uv_loop_t *loop, const char *address, const char *refusal,
                       const struct service_port_calls *calls, void *context);

/* Send to a client. Never blocks; a client that does not read is hung up. One that is not of this port is left alone. */
void service_port_send(struct service_port *port, unsigned client, const uint8_t *bytes, size_t length);

/* Within open(): the first bytes for the client that has come. */
void service_port_greet(struct service_port *port, const uint8_t *bytes, size_t length);

/* Hang a client up when it has got everything; closed() is not called. Returns false if it is not of this port. */
bool service_port_hang_up(struct service_port *port, unsigned client);

/* Stop listening, and close all connections without a call. Closed ports and those never opened are left alone. */
void service_port_close(struct service_port *port);

#endif
