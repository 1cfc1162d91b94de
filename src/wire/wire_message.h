/* SPDX-License-Identifier: MIT */
/* wire_message.h: a message as it was received on the two wires, whole or dropped. */
#ifndef RKM04_WIRE_MESSAGE_H
#define RKM04_WIRE_MESSAGE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "device/device.h"

#define WIRE_ANSWER_MAX DEVICE_MESSAGE_MAX /* bytes of the longest message of a unit */

/* What became of bytes on the wire. */
enum wire_fate {
    WIRE_WHOLE,
    WIRE_WRONG_CHECK,   /* hdlc: wrong FCS */
    WIRE_ABORTED,       /* hdlc: 7D 7E */
    WIRE_TOO_SHORT,     /* hdlc: less than 5 bytes */
    WIRE_TOO_LONG,
    WIRE_OUTSIDE,       /* hdlc: before any flag */
    WIRE_NO_ADDRESS,    /* plain: no DNode, above 16 */
    WIRE_NO_LENGTH,     /* plain: length 0 or above 9216 */
    WIRE_SILENT,        /* plain: 100 ms of silence inside the frame */
    WIRE_MALFORMED,     /* another framing's */
    WIRE_UNFINISHED,    /* the record ends in the middle of a frame */
    WIRE_FRAMING_ERROR, /* one byte, wrong stop bit: not received. The frame around it is reported separately */
    WIRE_BREAK          /* the same with all bits 0 */
};

/* A frame as received. `raw` are its bytes on the wire. */
struct wire_message {
    uint64_t start;       /* tick at which its first byte began */
    uint64_t end;         /* tick at which its last byte had passed; watch_event.tick, or before it if that was noticed later */
    uint32_t senders;     /* bit 0: the host; bit n: unit n */
    uint32_t collided;    /* those who have sent at the same time as another one */
    unsigned lost;        /* bytes inside that were not received (framing errors); they are not in `raw` */
    enum wire_fate fate;
    bool answer;          /* from a unit */
    uint8_t dnode, snode; /* 0 where the framing has none, or it was dropped before */
    const char *dropped;  /* NULL: whole; or why it is none: "wrong FCS", "aborted", "too long", … */
    const char *refused;  /* of an answer: what the unit objects to, in words (flag 1, 2, 3, message 255 …); NULL: nothing */
    const char *ignored;  /* of a whole request: why no unit executes it; NULL: one may */
    size_t raw_total;     /* bytes on the wire; more than raw_length if some were not kept */
    size_t raw_length, length;
    const uint8_t *raw, *message; /* message: empty if it was dropped */
    uint8_t bytes[];      /* inside: what the pointers point into */
};

#endif
