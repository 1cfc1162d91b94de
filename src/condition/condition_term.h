/* SPDX-License-Identifier: MIT */
/* condition_term.h: what a condition is made of. Inside: condition_read.c builds it, condition.c asks it. */
#ifndef RKM04_CONDITION_TERM_H
#define RKM04_CONDITION_TERM_H

#include "condition.h"

enum term_kind {
    TERM_ALL,      /* of `sub` */
    TERM_ANY,
    TERM_TIME,     /* the rest compare: the time of the bus, ticks */
    TERM_POSITION, /* of a motor: numbers */
    TERM_TRUE_POSITION,
    TERM_STEPS,
    TERM_INDEX,
    TERM_COMMANDS,
    TERM_STATE,    /* names, by their numbers */
    TERM_LED,
    TERM_FAULT,
    TERM_IDLE,     /* of one motor, or all of the unit (motor 0): 0 or 1 */
    TERM_INPUT,    /* bit `number`: 0 or 1 */
    TERM_OUTPUT,
    TERM_VARIABLE,
    TERM_POWERED,
    TERM_CELL,     /* of the device, by name: numbers */
    TERM_MESSAGE
};

enum term_relation { TERM_EQUAL, TERM_UNEQUAL, TERM_LESS, TERM_LESS_EQUAL, TERM_GREATER, TERM_GREATER_EQUAL };

/* A message to wait for; what is negative does not matter. */
struct term_message {
    int number;   /* its first byte */
    int motor;    /* its second one, '0'..'4' */
    int from;     /* 0: the host; 1..16: that unit; TERM_ANY_UNIT */
    bool dropped; /* one that was dropped, not a whole one */
    bool seen;
};
#define TERM_ANY_UNIT 17
#define TERM_CELL_SIZE 64u /* bytes of a cell's name */

struct term {
    uint8_t kind;     /* enum term_kind */
    uint8_t relation; /* enum term_relation */
    uint8_t unit;     /* its number on the line */
    uint8_t motor;    /* 1..4 */
    uint8_t number;   /* of an input, output, variable, as people count */
    int64_t value;
    uint64_t cell;    /* as find_cell() of the device has found it */
    char cell_name[TERM_CELL_SIZE];
    struct term_message message;
    size_t subs;
    struct term *sub;
};

struct condition {
    struct sim *sim;
    struct term root;
    struct watcher watcher; /* of messages */
    bool armed, messages;   /* any TERM_MESSAGE in it */
};

/* Free what hangs on a term. */
void term_clear(struct term *term);

/* Names of the relations, as they are written: ">=". */
const char *term_relation_name(enum term_relation relation);
bool term_relation_named(const char *name, enum term_relation *relation);

/* Is `is` in this relation to `wanted`? */
bool term_compares(int64_t is, enum term_relation relation, int64_t wanted);

#endif
