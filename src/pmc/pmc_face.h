/* SPDX-License-Identifier: MIT */
/* pmc_face.h: the faces of a PMC, bytes <-> requests: lines of text (`ascii`, section 9) and Modbus RTU (`modbus`, section 10).
 * A unit has one of them, config.face; what they keep is in the unit. */
#ifndef PMC_PMC_FACE_H
#define PMC_PMC_FACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define PMC_LINE_MAX 63u     /* characters of a line, without its CR (AS1) */
#define PMC_ANSWER_MAX 24u   /* bytes of an answer as text */
#define PMC_FRAME_MAX 256u   /* bytes of a Modbus frame */
#define PMC_ADDRESS_MAX 16u  /* of Modbus (AB1) */
#define PMC_BAUD 9600u       /* the default (AS1) */
#define PMC_LATE_MAX 60000u  /* ms */

struct pmc_unit;
struct pmc_face;

/* Lines and frames since power-up, mod 2^32. With each one that ends one of requests, others, dropped counts up. */
struct pmc_counters {
    uint32_t requests; /* for this unit */
    uint32_t answers;  /* that have gone out whole */
    uint32_t others;   /* frames for other addresses */
    uint32_t dropped;  /* lines that were ignored; frames that were none */
};

/* Why lines were ignored (AS4), mod 2^32. */
struct pmc_ignored {
    uint32_t unknown, operand, range, busy, too_long, line;
};

/* What both faces have. */
struct pmc_reply {
    struct pmc_counters counters;
    uint64_t from;         /* tick from which the answer goes out */
    uint16_t length, sent; /* bytes of the answer; length 0: there is none */
    bool has_answered;     /* since power-up */
};

struct pmc_ascii {
    struct pmc_reply reply;
    struct pmc_ignored ignored;
    uint32_t next_baud;  /* from the next RST on; 0: no other */
    uint8_t length;      /* of the line; PMC_LINE_MAX + 1: it is too long */
    bool is_spoilt;      /* a byte of it was lost */
    bool is_waiting;     /* the line is whole: it is executed when the answer has gone out */
    char line[PMC_LINE_MAX];
    uint8_t answer[PMC_ANSWER_MAX];
};

struct pmc_modbus {
    struct pmc_reply reply;
    uint64_t last;   /* tick of the last byte */
    uint16_t length; /* bytes of the frame that comes in; PMC_FRAME_MAX + 1: it is too long */
    bool is_spoilt;  /* silence inside, or a byte of it was lost */
    uint8_t frame[PMC_FRAME_MAX]; /* that comes in or goes out */
};

union pmc_face_state {
    struct pmc_reply reply;
    struct pmc_ascii ascii;
    struct pmc_modbus modbus;
};

extern const struct pmc_face pmc_ascii_face, pmc_modbus_face;

/* The speeds that a line may have; the list ends with 0. */
extern const uint32_t pmc_bauds[];

/* A byte came at the present tick that was none (framing error). */
void pmc_lose_byte(struct pmc_unit *unit);

/* Execute one message at the present tick: a line without CR, or a frame without address and check value. Returns the length of
 * the answer, which may be more than `room`; 0: none. What is on the line, and its counters, stay as they are. */
size_t pmc_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room);

/* The same with a frame of Modbus, whatever face the unit has at its line. */
size_t pmc_modbus_exchange(struct pmc_unit *unit, const uint8_t *message, size_t length, uint8_t *answer, size_t room);

#endif
