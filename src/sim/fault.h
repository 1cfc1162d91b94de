/* fault.h: faults on demand, each with an optional unit, count, probability (seeded) and window of time. The sim asks at each
 * place where something could go wrong whether it does. All of it is plain data and virtual time: the same faults at the same
 * ticks do the same. */
#ifndef RKM04_SIM_FAULT_H
#define RKM04_SIM_FAULT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct sim;

#define FAULTS_MAX 64u

enum fault_kind {
    FAULT_DROP,        /* a byte is not heard by anybody */
    FAULT_FLIP,        /* bits of a byte are inverted: `mask` */
    FAULT_DUPLICATE,   /* a byte is there twice */
    FAULT_INSERT,      /* `byte` is there before a byte */
    FAULT_DELAY,       /* the answer sets out `ticks` later */
    FAULT_NO_ANSWER,   /* the answer is not sent; the unit believes that it was */
    FAULT_WRONG_FCS,   /* hdlc: the check value of the answer is wrong, everything else is right */
    FAULT_CUT,         /* the answer ends after `bytes` bytes */
    FAULT_ECHO,        /* the master hears itself, too (two-wire adapter) */
    FAULT_BREAK,       /* the line is held at 0 for `ticks` */
    FAULT_UNPLUGGED,   /* the adapter is gone: the pty goes away, later a new one comes under the same link */
    FAULT_CABLE,       /* the cable is cut: silence both ways, the port stays */
    FAULT_FLASH,       /* an operation of the flash fails */
    FAULT_POWER,       /* the unit loses its power at its `operation`-th flash operation from now, in the middle of it */
    FAULT_INPUT,       /* input `input` is held at `level` */
    FAULT_KINDS
};

enum fault_direction { FAULT_TO_UNITS = 1, FAULT_TO_MASTER = 2, FAULT_BOTH = 3 };

struct fault {
    uint32_t id;         /* 1, 2, … */
    uint8_t kind;        /* enum fault_kind */
    uint8_t unit;        /* number on the line; 0: all */
    uint8_t direction;   /* enum fault_direction, of the kinds about bytes */
    bool counted;        /* `left` counts */
    uint32_t left;       /* times it will still act */
    uint32_t acted;      /* times it has */
    uint32_t millionths; /* probability, 1..1 000 000 */
    uint64_t from, until; /* window: acts at from <= tick < until; RKM04_NEVER: no end */
    uint64_t ticks;
    uint32_t number;     /* bytes, operation, mask, byte, input */
    bool level;
};

struct faults {
    uint32_t last_id;
    uint64_t random;     /* state of the generator, seeded */
    unsigned count;
    struct fault fault[FAULTS_MAX];
};

void faults_begin(struct faults *faults, uint64_t seed);

/* Does a fault of this kind act now? Counts it, and tells the watchers. `unit`: whom it would befall. `direction`: for the kinds
 * about bytes, one of the two. Returns it (valid until the next call), or NULL. */
const struct fault *fault_acts(struct sim *sim, enum fault_kind kind, unsigned unit, enum fault_direction direction);

/* Is there such a fault in force now? For the kinds that last (echo, unplugged, cable, input). Returns it, or NULL. */
const struct fault *fault_lasts(const struct sim *sim, enum fault_kind kind, unsigned unit);

/* `levels` of the inputs of a unit, with those that a fault holds as it holds them. */
uint8_t faults_hold_inputs(const struct sim *sim, unsigned unit, uint8_t levels);

/* The present tick is one at which a fault may have begun or ended: do what follows (inputs, echo, adapter, break). */
void faults_look(struct sim *sim);

/* The next tick at which that is so; RKM04_NEVER: none. */
uint64_t faults_next(const struct sim *sim);

/* All windows `shift` ticks later, for snapshots. */
void faults_shift(struct faults *faults, uint64_t shift);

#endif
