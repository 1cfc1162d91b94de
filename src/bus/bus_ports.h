/* SPDX-License-Identifier: MIT */
/* bus_ports.h: the ways in for clients of a line: a pty of its own or a serial device, TCP, RFC 2217; and what they have set
 * their ports to. All clients are connected to the same two wires: each receives what the units send. */
#ifndef RKM04_BUS_PORTS_H
#define RKM04_BUS_PORTS_H

#include <uv.h>

#include "bus_log.h"
#include "bus_options.h"
#include "bus_pty.h"
#include "bus_rts.h"
#include "line/line.h"

/* What the ports report, and ask, upwards. */
struct bus_ports_calls {
    void (*expect)(void *context);     /* bytes are about to be read, or room() to be asked: bring the units up to the present */
    size_t (*room)(void *context);     /* returns how many bytes can be taken now */
    /* A client sends, at `tick` (the present or later) or when what was sent before is out. `length` <= room(). */
    void (*take)(void *context, const uint8_t *bytes, size_t length, uint64_t tick);
    void (*line_break)(void *context, bool on);
    void (*purge)(void *context);      /* drop what has not set out yet */
    void (*changed)(void *context);    /* bytes were taken: do at once what follows */
    uint64_t (*reached)(void *context); /* returns the tick that the units have reached */
    void (*failed)(void *context);     /* the line is lost (reported) */
    void (*presence)(void *context);   /* a client has come or gone, or bytes came */
};

struct bus_ports {
    const struct bus_options *options;
    const struct bus_log *log;
    const struct bus_ports_calls *calls;
    void *context;

    struct line line;           /* the pty or device */
    struct line_watch *watch;
    struct bus_pty pty;
    struct line_poll readable;
    bool reading;                   /* it is being polled */
    struct net_port *tcp, *rfc2217; /* NULL: none */
    uint64_t dropped_logged;        /* of line.dropped, those in the log already */
    unsigned refused;               /* network clients, since one had the line */

    struct line_settings unit;                /* of the units */
    struct line_settings known;               /* of the client, as logged last */
    struct line_settings net;                 /* of the RFC 2217 client */
    struct line_receiver to_units, to_client; /* --strict-line and known is not as the unit has it */

    struct bus_rts rts;         /* of a device, with --rts toggle */

    bool pulled, unplugged;     /* the adapter was pulled out since the last check; it is out now, if it is up to the fault */
    bool out;                   /* what follows of that has been done */
    bool closing;               /* `readable` is, of the pty that is gone */
    bool lost;                  /* the pty is, to a client that has locked it and gone */
    bool retrying;              /* there was no new pty to be had: another try when `again` goes off */
    bool retry_logged;
    uv_timer_t retry;           /* follow_adapter() is due */
    bool ended;                 /* bus_ports_close() */
};

/* Tell the ports what they are to be and whom they report to. bus_ports_free() is due from then on. */
void bus_ports_prepare(struct bus_ports *ports, const struct bus_options *options, const struct bus_log *log,
                       const struct bus_ports_calls *calls, void *context);

/* Open what the options ask for. Failures are reported. Returns false if it did not work. */
bool bus_ports_open(struct bus_ports *ports, uv_loop_t *loop, struct line_watch *watch);

/* Make the link to the pty, and Wine's. Failures are reported. Returns false if it did not work. */
bool bus_ports_publish(struct bus_ports *ports);

/* Close everything; the handles are gone when the loop has run out. Then bus_ports_free(). */
void bus_ports_close(struct bus_ports *ports);
void bus_ports_free(struct bus_ports *ports);

/* The adapter is pulled out: the pty goes away with its link, network clients are hung up; or put in again: a new pty with the
 * group and mode of the old one under the same link. If there is no pty to be had (no free descriptor, no pty left), it is tried
 * again every second. A serial device stays. Done in the next bus_ports_listen(). */
void bus_ports_plug(struct bus_ports *ports, bool plugged);

/* How many clients are there; a device counts as none. */
unsigned bus_ports_clients(const struct bus_ports *ports);

/* Send to everybody who is there. */
void bus_ports_send(struct bus_ports *ports, const uint8_t *bytes, size_t length);

/* The units are silent: what a strict line has received in part is received to its end. */
void bus_ports_silence(struct bus_ports *ports);

/* Listen while there is room for what comes. */
void bus_ports_listen(struct bus_ports *ports);

/* Bytes without a client, and bytes that a client did not read. */
uint64_t bus_ports_dropped(const struct bus_ports *ports);

#endif
