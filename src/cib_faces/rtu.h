/* SPDX-License-Identifier: MIT */
/* rtu.h: Modbus RTU at a CIB module: finds requests among the bytes on the bus, has them executed, sends the answers
 * (docs/CIB.md, BL1-BL4).
 *
 *     address, function, …, check value low, high
 *
 * A request ends as soon as as many bytes have come as its function says, so that it works where time is stopped, too; one with
 * an unknown function ends in silence. */
#ifndef RKM04_CIB_FACES_RTU_H
#define RKM04_CIB_FACES_RTU_H

#include "cib/cib.h"
#include "pdu.h"

#define CIB_SILENCE 2344u         /* us without a byte: 3.5 characters, and the one that would have come */
#define CIB_SILENCE_MAX 100000u   /* us, of the option */
#define CIB_TURNAROUND 1823u      /* us from the last byte of a request to the answer: 3.5 characters */

struct cib_rtu_counters {
    uint32_t requests, answers, others, dropped; /* as struct device_counters */
};

/* Plain data, zero-initialised but for `address` and `silence`. */
struct cib_rtu {
    uint8_t address;        /* 1..247 */
    uint32_t silence;       /* us */
    uint64_t last;          /* tick of the last byte */
    uint16_t check;         /* of the bytes of the frame; 0 after a correct one */
    uint16_t length;        /* bytes of the frame */
    bool skipping;          /* nothing counts up to the next silence; the frame keeps its length until then */
    bool untimed;           /* bytes of the frame came faster than they can on the wires */
    bool waiting;           /* the frame is a whole request that is executed after the present answer */
    uint16_t answer_length, answer_sent; /* 0: no answer */
    struct cib_rtu_counters counters;
    uint8_t frame[MODBUS_FRAME_MAX], answer[MODBUS_FRAME_MAX];
};

/* Take one byte at the present tick of the unit. Returns false: it is lost, a request waits. */
bool cib_rtu_receive(struct cib_rtu *rtu, struct cib_unit *unit, uint8_t byte);

/* The tick at which silence ends what has been gathered; CIB_NEVER: nothing has. */
uint64_t cib_rtu_due(const struct cib_rtu *rtu);

/* Silence may have lasted long enough at the present tick of the unit. */
void cib_rtu_check_silence(struct cib_rtu *rtu, struct cib_unit *unit);

/* The next byte of the answer. Returns false if there is none. */
bool cib_rtu_send(struct cib_rtu *rtu, struct cib_unit *unit, uint8_t *byte);

#endif
