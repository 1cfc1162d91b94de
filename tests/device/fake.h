/* SPDX-License-Identifier: MIT */
/* fake.h: the core of the example in docs/DEVICES.md: one axis that steps at a constant speed, twenty inputs, one output.
 *
 * A request is an address byte (80h + address), a text, and CR; the answer is a text and CR:
 *
 *     MOVE n     n steps, forward if n > 0     STOP     end the motion at once
 *     RATE n     n steps/s, 1..10000           SAVE     keep the rate in the flash
 *     OUT n      switch the output, 0 or 1     ZERO     call this position 0
 *     POS?       answers the position          IN?      answers the inputs, 0..1048575
 *
 * The others answer OK, or: E1 unknown, E2 out of range, E3 the limit switch is on, E4 the flash failed. A request that is too
 * long is not answered. Input 1 is the limit switch: it ends motions forward. Nothing is received while an answer is being sent.
 * Time is counted in ticks of 0.25 us.
 *
 * With `silent` requests and answers have a check byte, the sum of the others, in place of CR, and end with FAKE_SILENCE us in
 * which no byte comes. */
#ifndef RKM04_TESTS_FAKE_H
#define RKM04_TESTS_FAKE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define FAKE_TICKS_PER_US 4u
#define FAKE_PULSE 2u          /* us; above FAKE_FAST 1 */
#define FAKE_FAST 5000u        /* steps/s */
#define FAKE_ADDRESSES 100u
#define FAKE_TEXT_MAX 16u      /* bytes of a request or an answer, without address and CR */
#define FAKE_INPUTS 20u
#define FAKE_FLASH_BLOCKS 12u  /* the last one is used */
#define FAKE_FLASH_SIZE 16u    /* bytes of a block */
#define FAKE_MOVE_MAX 1000000  /* steps */
#define FAKE_RATE_MAX 10000u   /* steps/s */
#define FAKE_SILENCE 2000u     /* us */
#define FAKE_NEVER UINT64_MAX

/* What a unit reports and asks; every call is set. `tick` is its own. */
struct fake_calls {
    void (*step)(void *context, uint64_t tick, int32_t position, bool forward);
    void (*direction)(void *context, uint64_t tick, bool forward);
    void (*motion)(void *context, uint64_t tick, bool moving);
    void (*position)(void *context, uint64_t tick, int32_t position); /* that no step led to */
    void (*limit)(void *context, uint64_t tick, bool hit);            /* the limit switch has ended a motion */
    void (*output)(void *context, uint64_t tick, bool on);
    bool (*load)(void *context, uint8_t data[4]);       /* from the flash; false: it failed */
    bool (*save)(void *context, const uint8_t data[4]); /* erase, then program */
};

/* A unit. Plain data: a copy is a snapshot. */
struct fake_unit {
    const struct fake_calls *calls;
    void *context;
    uint64_t now, due;       /* ticks; of the next step, FAKE_NEVER: none */
    int32_t position;
    uint32_t left, done;     /* steps of the motion */
    uint16_t rate;           /* steps/s */
    uint32_t inputs;         /* input 1 is bit 0 */
    uint8_t address;
    bool forward, output, limit;
    bool silent;             /* messages end with a silence */
    uint64_t silence;        /* tick at which the one that it waits for is over; FAKE_NEVER: it waits for none */
    uint8_t sum;             /* of the bytes of the request */
    bool addressed;          /* the request that comes in is for this unit */
    uint8_t length, answer_length, answer_sent;
    char text[FAKE_TEXT_MAX + 2], answer[FAKE_TEXT_MAX + 1];
    uint32_t frames, requests, answers; /* ended on the wires; of these, for this unit; sent */
};

void fake_begin(struct fake_unit *unit, uint8_t address, const struct fake_calls *calls, void *context);
void fake_advance(struct fake_unit *unit, uint64_t ticks);
uint64_t fake_end(const struct fake_unit *unit);  /* tick of the last step of the motion; FAKE_NEVER */
size_t fake_receive(struct fake_unit *unit, const uint8_t *bytes, size_t length);
size_t fake_send(struct fake_unit *unit, uint8_t *bytes, size_t room);
void fake_set_inputs(struct fake_unit *unit, uint32_t mask);
const char *fake_obey(struct fake_unit *unit, const char *text); /* returns the answer, valid until the next call */

#endif
