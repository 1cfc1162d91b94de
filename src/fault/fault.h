/* SPDX-License-Identifier: MIT */
/* fault.h: injected faults; the face of the room.
 *
 *     fault          the list of faults: which acts when; breaks, cables, the adapter, inputs
 *     fault_line     faults of bytes and answers: the hooks of the bus
 *     fault_flash    faults of the flash, and power lost in the middle of an operation
 *     fault_apply    does a fault act now; private to the room
 *
 * Each has an optional unit, count, probability (seeded) and window of time. All of it is plain data in virtual time, without
 * JSON: the same faults at the same ticks do the same. docs/FAULTS.md describes every kind.
 *
 * A fault waits for opportunities. Those of the faults of bytes are bytes that set out, those of the faults of answers are
 * answers, those of the faults of the flash are its operations. The others have intervals (FAULT_BREAK and following): their
 * opportunities are the begin of their window, and one every `every` ticks from then on.
 *
 * What the owner of the bus has to do:
 *   begin:        faults_begin() with the segment, whose config.hooks_context has to be the faults; the hooks are put in with the
 *                 first fault, so that a line without faults pays nothing
 *   each leap:    end at faults_next() at the latest, then faults_update() if that is the present tick
 *   the units' port: faults_flash_read(), faults_flash_erase(), faults_flash_program() are before the flash
 *   inputs:       faults_hold_inputs() has the last word
 *   snapshots:    struct faults is part of them (struct segment, too), and is put back with faults_restore() */
#ifndef RKM04_FAULT_H
#define RKM04_FAULT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "wire/wire.h"

#define FAULTS_MAX 64u

enum fault_kind {
    FAULT_DROP,        /* a byte is not there, for anybody; silence in its place */
    FAULT_FLIP,        /* bits of a byte are inverted: `number` is the mask */
    FAULT_DUPLICATE,   /* a byte is there twice */
    FAULT_INSERT,      /* byte `number` is there before a byte */
    FAULT_ECHO,        /* the host receives its own byte, too (two-wire adapter) */
    FAULT_DELAY,       /* the answer sets out `ticks` later */
    FAULT_NO_ANSWER,   /* the answer is not sent; the unit believes that it was */
    FAULT_WRONG_FCS,   /* hdlc: the check value of the answer is wrong, everything else is right */
    FAULT_CUT,         /* the answer ends after `number` bytes */
    FAULT_FLASH,       /* an operation of the flash fails: one of `operations`; `torn`: it is done in part */
    FAULT_POWER,       /* the unit loses its power in the middle of an erase or program; it comes back after `ticks` */
    FAULT_BREAK,       /* from here on kinds with intervals, `ticks` long. The line is held at 0 */
    FAULT_UNPLUGGED,   /* the adapter is gone: the pty goes away, later a new one comes under the same link */
    FAULT_CABLE,       /* the cable is cut: silence both ways, the port stays. `unit`: that unit's own cable */
    FAULT_INPUT,       /* input `number` (from 1) is held at `level` */
    FAULT_KINDS
};

/* Their names. */
static const char *const fault_names[FAULT_KINDS] = {
    [FAULT_DROP] = "drop",           [FAULT_FLIP] = "flip",   [FAULT_DUPLICATE] = "duplicate", [FAULT_INSERT] = "insert",
    [FAULT_ECHO] = "echo",           [FAULT_DELAY] = "delay", [FAULT_NO_ANSWER] = "no_answer", [FAULT_WRONG_FCS] = "wrong_fcs",
    [FAULT_CUT] = "cut",             [FAULT_FLASH] = "flash", [FAULT_POWER] = "power",         [FAULT_BREAK] = "break",
    [FAULT_UNPLUGGED] = "unplugged", [FAULT_CABLE] = "cable", [FAULT_INPUT] = "input",
};

enum fault_direction { FAULT_TO_UNITS = 1, FAULT_TO_HOST = 2, FAULT_BOTH = 3 };

/* Operations of the flash, as a mask. */
enum fault_operation { FAULT_READ = 1, FAULT_ERASE = 2, FAULT_PROGRAM = 4 };

struct fault {
    uint32_t id;         /* 1, 2, … */
    uint8_t kind;        /* enum fault_kind */
    uint8_t unit;        /* number on the line; 0: all */
    uint8_t direction;   /* enum fault_direction, of the faults of bytes */
    uint8_t operations;  /* of FAULT_FLASH, FAULT_POWER: mask of enum fault_operation */
    bool torn, level;
    bool counted;        /* `left` counts */
    uint32_t left;       /* times it will still act */
    uint64_t skip;       /* opportunities that it lets pass before */
    uint32_t acted;      /* times it has */
    uint32_t millionths; /* probability, 1..1 000 000 */
    uint32_t number;     /* a mask, byte, number of bytes, or input */
    uint64_t from, until; /* window: acts at from <= tick < until; DEVICE_NEVER: no end */
    uint64_t ticks;      /* how long; DEVICE_NEVER: to the end of the window */
    uint64_t every;      /* intervals: from one opportunity to the next; 0: there is one only */
    uint64_t next;       /* intervals: tick of the next opportunity; DEVICE_NEVER: none */
    uint64_t ends;       /* of the present spell, or when the power comes back; DEVICE_NEVER: open */
    uint8_t victim;      /* FAULT_POWER: the unit that has lost its power; 0: none */
    bool active;         /* a spell is in force */
};

/* What is wrong with the answer that a unit is sending. */
struct fault_answer {
    uint32_t at;       /* bytes of it that have set out */
    uint32_t end;      /* of these, the ones that are sent at all */
    uint32_t wrong_at; /* byte that is changed; UINT32_MAX: none */
    uint8_t mask;      /* bits that are inverted there */
};

extern const struct fault_answer fault_answer_unchanged; /* nothing is */

/* What faults need of what is around the bus. All are set, but for `adapter`. */
struct fault_calls {
    /* A fault has acted on unit `unit` (0: the line). `text` says what it did; valid during the call. */
    void (*report)(void *context, const struct fault *fault, unsigned unit, const char *text);
    /* What holds the inputs of a unit may have changed: faults_hold_inputs(). */
    void (*inputs_changed)(void *context, unsigned unit);
    void (*power)(void *context, unsigned unit, bool on);
    void (*adapter)(void *context, bool plugged);
    const char *(*unit_name)(void *context, unsigned unit);
    /* The flash as it is, as in struct device_port. */
    int (*flash_read)(void *context, unsigned unit, unsigned block, unsigned offset, void *data, unsigned length);
    int (*flash_erase)(void *context, unsigned unit, unsigned block);
    int (*flash_program)(void *context, unsigned unit, unsigned block, unsigned offset, const void *data, unsigned length);
};

struct faults {
    struct segment *segment;         /* of the bus */
    const struct fault_calls *calls;
    void *context;                   /* of the calls */
    uint32_t last_id;
    uint64_t random;   /* state of the generator, seeded */
    uint32_t kinds;    /* there are some of these: bit n is kind n */
    bool unplugged;    /* calls.adapter has been called for it */
    uint32_t dying;    /* bit n: unit n has lost its power in the middle of an operation, and is to be switched off */
    unsigned count;
    struct fault fault[FAULTS_MAX]; /* in order of their ids */
    struct fault_answer answer[SEGMENT_UNITS];
};

/* No faults. `calls` must stay. */
void faults_begin(struct faults *faults, uint64_t seed, struct segment *segment, const struct fault_calls *calls, void *context);

/* Add a fault; `id`, `acted`, `next`, `ends` and `active` are set here. One that begins now acts from now on. Returns its id; 0:
 * there are FAULTS_MAX that may still act. */
uint32_t faults_add(struct faults *faults, const struct fault *fault);

/* Remove fault `id`, or all with 0; a spell in force ends. Returns how many were removed. */
unsigned faults_remove(struct faults *faults, uint32_t id);

/* Will it never act again? It is kept for a while so that it can be seen how often it did. */
bool fault_is_spent(const struct fault *fault, uint64_t now);

/* Is there a spell of this kind in force now, for unit `unit` alone, or with 0 for all? Returns it, or NULL. */
const struct fault *fault_find_active(const struct faults *faults, enum fault_kind kind, unsigned unit);

/* `levels` of the inputs of a unit, with those that a fault holds as it holds them. */
uint32_t faults_hold_inputs(const struct faults *faults, unsigned unit, uint32_t levels);

/* The flash as the unit finds it: calls.flash_read(), … with what goes wrong. */
int faults_flash_read(struct faults *faults, unsigned unit, unsigned block, unsigned offset, void *data, unsigned length);
int faults_flash_erase(struct faults *faults, unsigned unit, unsigned block);
int faults_flash_program(struct faults *faults, unsigned unit, unsigned block, unsigned offset, const void *data,
                         unsigned length);

/* Begin and end what is due by now, and do what follows (inputs, line, adapter, power). */
void faults_update(struct faults *faults);

/* The next tick at which that is due, which may be over; DEVICE_NEVER: never. */
uint64_t faults_next(const struct faults *faults);

/* All times `shift` ticks later. */
void faults_shift(struct faults *faults, uint64_t shift);

/* Be like the faults of a snapshot, all times `shift` ticks later; segment and calls stay. calls.adapter is not made. */
void faults_restore(struct faults *faults, const struct faults *snapshot, uint64_t shift);

/* "drop", "flip", … as in fault.inject. Never NULL. */
const char *fault_kind_name(enum fault_kind kind);

/* Find a kind by its name. Returns FAULT_KINDS if there is none of that name. */
enum fault_kind fault_kind_named(const char *name);

#endif
