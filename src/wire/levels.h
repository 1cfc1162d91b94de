/* SPDX-License-Identifier: MIT */
/* wire.h: two wires of RS485, 8N1, bit by bit: what each station receives of what all of them send. Pure: no
 * file, no clock.
 *
 * The level is 0 while anyone sends a 0. A station listens as a UART does: it waits for the line to fall, samples the middle of
 * the start bit, of the eight bits and of the stop bit, and has the byte when ten bits are over. A start bit that is gone in its
 * middle was none; a byte without its stop bit is lost and counted. Who sends does not receive meanwhile, and joins in the middle
 * of things if others are still at it. So a byte without a disturbance is received as it was sent, and the rest comes out of the
 * bits.
 *
 * Times are parts, WIRE_TICK to a tick: a bit is a whole number of them at 9600, 19200, 38400, 57600 and 115200 baud, so nothing
 * is ever rounded. */
#ifndef RKM04_WIRE_LEVELS_H
#define RKM04_WIRE_LEVELS_H

#include <stdbool.h>
#include <stdint.h>

#include "device/device.h"

#define WIRE_TICK 72u    /* parts of a tick */
#define WIRE_BIT 3750u   /* parts of a bit at 19200 baud */
#define WIRE_BYTE 37500u /* parts of ten bits */

#define WIRE_HOST 0u                          /* station 0; 1..16 are units */
#define WIRE_STATIONS 17u /* the host, and sixteen units */
#define WIRE_MONITOR WIRE_STATIONS              /* a receiver that never sends: it receives everything */
#define WIRE_RECEIVERS (WIRE_STATIONS + 1u)
#define WIRE_NOISE WIRE_RECEIVERS                    /* no station: something that disturbs the line, for wire_hold() */
#define WIRE_SIGNALS 80u /* signals that matter at a time: of each station those of the last three bytes' time, and spare ones */

/* A byte on the wire, or a break. */
struct wire_signal {
    uint64_t start, end; /* parts; end: of the stop bit */
    uint16_t bits;       /* start bit in bit 0, stop bit in bit 9 */
    uint8_t station;
    bool held;           /* a break: 0 from start to end */
    bool collided;       /* counted already */
};

struct wire_receiver {
    uint64_t from;           /* it waits for the line to fall since then */
    uint64_t fall;           /* when that was; DEVICE_NEVER: not yet */
    uint64_t framing_errors; /* bytes lost: the stop bit was 0 */
    uint64_t received;       /* bytes */
};

/* What a receiver has received. */
struct wire_byte {
    uint64_t start, end; /* parts: of the ten bits */
    unsigned receiver;   /* station 0..16, or WIRE_MONITOR */
    uint32_t senders;    /* who was sending meanwhile: bit n is station n; several: a collision */
    uint8_t byte;
    bool lost;           /* framing error: reported to the monitor alone, with the bits as they were */
};

struct wire {
    uint32_t bit;        /* parts of a bit */
    uint64_t sent;       /* bytes sent, by all */
    uint64_t collisions; /* of these, bytes during which another station was sending, too */
    uint32_t stations;   /* receivers in use: bit n is station n, or the monitor */
    unsigned first;      /* of all receivers, the one that receives a byte next: its `fall` is the earliest */
    unsigned count;
    struct wire_signal signal[WIRE_SIGNALS]; /* in order of their starts */
    struct wire_receiver receiver[WIRE_RECEIVERS];

    /* What was found last while the signals are the same: most receivers receive the same byte at the same time. */
    struct {
        uint64_t from, fall; /* the line falls at `fall` if one waits since `from`; DEVICE_NEVER: nothing was found yet */
        bool high;           /* and gives a 1 before */
    } found;
    struct wire_byte sampled; /* start DEVICE_NEVER: nothing yet */
};

/* An idle wire without units, with a speed that divides 115200 baud. */
void wire_begin(struct wire *wire, unsigned baud);

/* Parts of the ten bits of a byte. */
uint64_t wire_byte_parts(const struct wire *wire);

/* A station listens from `time` on (its power comes), or no more. Both also end what it sends, at `time`. */
void wire_join(struct wire *wire, unsigned station, uint64_t time);
void wire_leave(struct wire *wire, unsigned station, uint64_t time);

/* A station sends a byte from `start` on. The calls have to come in the order of time, to a tick: `start` must not lie more than
 * WIRE_TICK - 1 before any time given to this wire. A station's own bytes must not overlap. */
void wire_send(struct wire *wire, unsigned station, uint8_t byte, uint64_t start);

/* A station holds the line at 0 (break), or lets it go. */
void wire_hold(struct wire *wire, unsigned station, bool on, uint64_t time);

/* Make all times later by `parts`. */
void wire_shift(struct wire *wire, uint64_t parts);

/* When the next byte will have been received if nothing more is sent; DEVICE_NEVER: never. */
uint64_t wire_due(const struct wire *wire);

/* Fetch the next byte received by `until`; those of the same time come in the order of their ears. Returns false if there is
 * none. */
bool wire_receive(struct wire *wire, uint64_t until, struct wire_byte *byte);

#endif
