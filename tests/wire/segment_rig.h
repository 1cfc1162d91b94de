/* SPDX-License-Identifier: MIT */
/* segment_rig.h: one RS485 line with a host that keeps all it receives, for tests. */
#ifndef RKM04_TESTS_SEGMENT_RIG_H
#define RKM04_TESTS_SEGMENT_RIG_H

#include "core/rig.h"
#include "wire/segment.h"

#define LINE_BYTES_MAX 60000
#define REQUEST_MAX 64 /* bytes of a message of line_ask() */

/* What has reached the host. */
struct line_bytes {
    size_t count;
    uint8_t byte[LINE_BYTES_MAX];
    uint64_t tick[LINE_BYTES_MAX];
};

struct line_rig {
    struct segment segment;
    const struct rkm04_framing *framing; /* of all units and the host */
    struct line_bytes host;
    struct segment_byte monitor[LINE_BYTES_MAX]; /* what passed on the line */
    size_t monitored;
};

extern struct line_rig line_rig;

/* The settings of a line in time, with the default turnaround. */
struct segment_config line_timed(void);

/* A line with units of these addresses, ended by 0; the callbacks of `config` are replaced by the rig's. framing NULL: hdlc. */
void line_begin(const struct segment_config *config, const uint8_t *nodes, const struct rkm04_framing *framing);

/* The frame of a message to `dnode`. Returns its length. */
size_t line_frame(uint8_t dnode, const void *message, size_t length, uint8_t *out);

/* Bring the segment to `tick` and hand over a request there. Returns its length on the line. */
size_t line_ask(uint8_t dnode, const void *message, size_t length, uint64_t tick);

/* Set Command, as line_ask(). */
size_t line_set(uint8_t dnode, char motor, const char *text, uint64_t tick);

/* Bring the segment to the tick at which nothing is under way any more. Returns that tick. */
uint64_t line_settle(void);

/* Tick at which `bytes` bytes without a gap have passed that began at `tick`. */
uint64_t line_passed(uint64_t tick, size_t bytes);

/* Whole, well-checked answers of unit address `node` with this message number that the host has got. hdlc. */
unsigned line_answers(uint8_t node, uint8_t number);

/* All whole answers of whomever, and frames that were dropped. Any framing. */
struct line_count {
    unsigned whole, dropped;
} line_count(void);

struct rkm04_counters line_unit_counters(unsigned number);

/* Motor 1..4 of a unit. */
struct rkm04_motor_state line_motor(unsigned number, unsigned motor);

#endif
