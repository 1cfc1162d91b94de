/* SPDX-License-Identifier: MIT */
/* fault_rig.h: a line with faults, and a host that keeps all it receives, for tests. */
#ifndef RKM04_TESTS_FAULT_RIG_H
#define RKM04_TESTS_FAULT_RIG_H

#include <check.h>

#include "command/command.h"
#include "sim/sim.h"

#define RIG_BYTES 8192u
#define RIG_NEWS 512u
#define VERSION "\1"

/* Bytes with their ticks. */
struct heard {
    size_t count;
    uint8_t byte[RIG_BYTES];
    uint64_t tick[RIG_BYTES];
};

struct fault_rig {
    struct sim sim;
    struct watcher watcher;
    struct heard host;    /* what has reached the host */
    struct heard line;    /* what has passed on the line, with what was lost of it */
    size_t lost;          /* of these */
    size_t news;          /* WATCH_INJECTED */
    struct {
        uint64_t tick;
        unsigned unit;
        char text[160];
    } told[RIG_NEWS];
    unsigned plugs;       /* how often the adapter was unplugged or plugged in */
    struct {
        uint64_t tick;
        bool plugged;
    } plug[64];
    char refusal[660];    /* of the last refused(), "CODE TEXT" */
};

extern struct fault_rig rig;

/* Power up units 1 to `units` (the address is the number) at tick 0. framing NULL: hdlc. */
void rig_begin_with(bool timed, unsigned units, uint64_t seed, const struct rkm04_framing *framing);
void rig_begin(bool timed, unsigned units);
void rig_end(void);

/* fault.inject with these parameters (printf-like; ' stands for "). Returns the id. */
uint32_t inject(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Any command, which must be executed. Returns the result, which is to be freed. */
json_t *run_command(const char *method, const char *params);

/* Any command, which must be refused. Returns "CODE TEXT". */
const char *refused(const char *method, const char *params);

/* Send a message to `dnode` at the present tick. Returns the length of its frame. */
size_t ask(uint8_t dnode, const void *message, size_t length);

/* Set Command for motor 1. */
size_t set(uint8_t dnode, const char *text);

/* Let time pass until nothing is under way on the line. */
void settle(void);

/* ask(), settle(). Forgets what was received before. Returns how many whole, well-checked answers the host has got. */
unsigned answers_to(uint8_t dnode, const void *message, size_t length);

void forget(void);

/* Look at a byte of the last whole answer that answers_to() has counted. */
uint8_t answer_byte(size_t at);

/* Let so many ticks pass. */
void run(uint64_t ticks);

struct rkm04_counters counters(unsigned number);

/* What was reported to the watchers, from 0 on. */
#define assert_news(at, string) ck_assert_str_eq(rig.told[at].text, string)

#endif
