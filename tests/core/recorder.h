/* SPDX-License-Identifier: MIT */
/* recorder.h: a port that remembers all that a unit does, for tests. */
#ifndef RKM04_TESTS_RECORDER_H
#define RKM04_TESTS_RECORDER_H

#include <rkm04/unit.h>

enum record_kind { RECORD_STEP, RECORD_DIRECTION, RECORD_OUTPUTS, RECORD_EVENT };

struct record {
    uint64_t tick;
    enum record_kind kind;
    unsigned motor;        /* 1..4; 0 for the unit */
    enum rkm04_event what; /* RECORD_EVENT only */
    int64_t value;         /* step: position; direction: 1 or 0; outputs: mask; event: its value */
};

struct recorder {
    struct record *list; /* grows on the heap */
    size_t count, room;
    const void *flash;   /* a struct flash_fake, or NULL; see flash_fake.h */
};

/* A port whose context is a struct recorder; without flash. */
extern const struct rkm04_port recorder_port;

/* The same with flash_read, _erase and _program going to recorder.flash (a struct flash_fake). */
extern const struct rkm04_port recorder_flash_port;

void recorder_clear(struct recorder *recorder); /* forget, keep the room */
void recorder_free(struct recorder *recorder);

/* Number of steps of a motor (1..4). */
size_t recorder_steps(const struct recorder *recorder, unsigned motor);

/* Tick of the n-th step (1..) of a motor; RKM04_NEVER if there are fewer. */
uint64_t recorder_step(const struct recorder *recorder, unsigned motor, size_t n);

/* The n-th (1..) record of an event of a motor with this value, or NULL. */
const struct record *recorder_event(const struct recorder *recorder, unsigned motor, enum rkm04_event what, int64_t value,
                                    size_t n);

/* Sort by tick, then motor; stable. */
void recorder_sort(struct recorder *recorder);

#endif
