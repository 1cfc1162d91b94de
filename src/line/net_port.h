/* SPDX-License-Identifier: MIT */
/* net_port.h: a line over TCP: raw, or a serial port by RFC 2217. It listens; one client at a time has the line, a further one is
 * refused with a message. All calls back come from the loop, or from within net_port_wake(), never from net_port_send(). */
#ifndef RKM04_LINE_NET_PORT_H
#define RKM04_LINE_NET_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <uv.h>

#include "net_address.h"
#include "rfc2217.h"

#define NET_IN 1024u         /* bytes read from a client at once */
#define NET_TO_LINE 4096u    /* bytes of a client that wait for room() */
#define NET_TO_CLIENT 20480u /* bytes that wait for a client to read; as many as with a pty */
#define NET_REPLIES 1024u    /* bytes of RFC 2217 that wait likewise; when they are many, the client is not read */
#define NET_WIRE 2048u       /* bytes that have been given to the system */
#define NET_CONNECTIONS 8u   /* connections at a time: the client and those being refused; for one more, the one refused first
                                is closed at once, so that no client waits */

enum net_kind {
    NET_RAW,
    NET_RFC2217
};

enum net_event {
    NET_DETACHED, /* the client has closed the bus */
    NET_ATTACHED, /* a client has opened it */
    NET_REFUSED   /* a further client came and was sent away */
};

/* What is reported to the owner of the line. All but `bytes` and `event` may be NULL. */
struct net_port_calls {
    /* Data for the units, at most room() bytes; all of them are taken. */
    void (*bytes)(void *context, const uint8_t *data, size_t length);
    /* How many bytes can be taken now; NULL: any number. See net_port_wake(). */
    size_t (*room)(void *context);
    /* `client`: "127.0.0.1:40123". */
    void (*event)(void *context, enum net_event event, const char *client);
    /* Who else has the line (by another way than this port), so that a client has to be refused; NULL: none. */
    const char *(*owner)(void *context);
    /* RFC 2217: the client has changed its port. A client that attaches has 19200 8N1 and sets one thing after the other: what
     * counts is what is set when bytes come. parity: N O E M S; stop_bits: 1, 2, or 3 for 1.5. */
    void (*settings)(void *context, uint32_t baud, unsigned data_bits, char parity, unsigned stop_bits);
    /* RFC 2217: a break begins or ends; a telnet break is both at once. It ends with the client at the latest. */
    void (*line_break)(void *context, bool on);
    /* RFC 2217: the client has changed DTR or RTS; both are on when it attaches. */
    void (*lines)(void *context, bool dtr, bool rts);
    /* RFC 2217: bytes that have been handed to bytes() and are not on the wire yet are to be discarded. */
    void (*purge)(void *context);
};

struct net_port;

/* A connection. */
struct net_connection {
    struct net_port *port;
    uint8_t state;
    uint8_t open_handles;
    bool writing;
    bool failed; /* bytes for it go nowhere */
    uint64_t number; /* of those that have come */
    uv_tcp_t tcp;
    uv_timer_t timer;
    uv_write_t write;
    uv_shutdown_t shutdown;
    char name[NET_NAME_SIZE];
    size_t wire_length;
    uint8_t wire[NET_WIRE];
};

struct net_port {
    char address[NET_NAME_SIZE]; /* where it listens, with the real port: "127.0.0.1:40123", "[::1]:40123" */
    bool attached;               /* a client has the line */
    uint64_t dropped;            /* bytes without a client, or that a client did not read in time */
    uint64_t unread;             /* bytes that the last client has sent and no unit will receive: it gave way to another one */
    struct rfc2217 rfc2217;      /* of the client; read only */

    /* Inside. */
    enum net_kind kind;
    const struct net_port_calls *calls;
    void *context;
    uv_tcp_t listener;
    bool open;
    bool unplugged;          /* net_port_plug() */
    bool waiting;            /* a connection is to be accepted when another one has gone */
    bool moving;             /* in move() */
    bool reading;
    uint64_t arrived;              /* connections so far */
    uint64_t moved;                /* ms of the loop: when bytes last passed */
    struct net_connection *client; /* NULL: none */
    struct net_connection connections[NET_CONNECTIONS];
    size_t in_at, in_length; /* what has been read of a client's bytes, and not been checked */
    uint8_t in[NET_IN];
    size_t to_line_head, to_line_count;
    uint8_t to_line[NET_TO_LINE];
    size_t to_client_head, to_client_count;
    uint8_t to_client[NET_TO_CLIENT];
    size_t replies_length;
    uint8_t replies[NET_REPLIES];
};

/* Listen at `address`, which has its host in digits (net_address_find()); without a host at 127.0.0.1. calls and context must
 * stay; *port must be zero, and must stay until it is closed and the loop has run out. Failures are reported. Returns false if it
 * did not work. */
bool net_port_open(struct net_port *port, uv_loop_t *loop, const char *address, enum net_kind kind,
                   const struct net_port_calls *calls, void *context);

/* The name of the client that has the line; NULL: none, or one that has closed its own side and gives way to any other. That it
 * has done so is looked up, even if more has come from it than there is room for. Not to be called from within bytes(). */
const char *net_port_client(struct net_port *port);

/* There may be room() again. Not needed after bytes(). */
void net_port_wake(struct net_port *port);

/* Send to the client; one that has closed its own side only still gets what follows within a second. Bytes without a client and
 * bytes that do not fit are dropped and counted: a line has no memory. Never blocks. Returns the number of dropped ones. */
size_t net_port_send(struct net_port *port, const uint8_t *bytes, size_t length);

/* The cable of the device server is pulled out: the client is hung up, and so is every new client; or put in again. */
void net_port_plug(struct net_port *port, bool plugged);

/* Stop listening and close the client, without an event. The handles are closed when the loop has run out. A port that was
 * never opened, or is closed, is left alone. */
void net_port_close(struct net_port *port);

#endif
