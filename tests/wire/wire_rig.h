/* SPDX-License-Identifier: MIT */
/* wire_rig.h: a line whose messages are taken down in words, for tests. */
#ifndef RKM04_TESTS_WIRE_RIG_H
#define RKM04_TESTS_WIRE_RIG_H

#include <check.h>

#include "sim/sim.h"

#define WIRE_RIG_LINES 64
#define WIRE_RIG_COLUMNS 400

struct wire_rig {
    struct sim sim;
    struct watcher watcher;
    unsigned lines;
    char line[WIRE_RIG_LINES][WIRE_RIG_COLUMNS]; /* "master > 3: 1 Version", cut to that length */
    struct wire_message message[WIRE_RIG_LINES]; /* without what its pointers point to */
};

extern struct wire_rig wire_rig;

/* A new line with these units ("3,5"), in time. framing NULL: hdlc. What was before ends. */
void wire_rig_begin(const char *nodes, const struct rkm04_framing *framing);
void wire_rig_end(void);

/* The same with bytes that take no time; with this turnaround (ticks). */
void wire_rig_begin_untimed(const char *nodes, const struct rkm04_framing *framing);
void wire_rig_begin_slow(const char *nodes, const struct rkm04_framing *framing, uint32_t turnaround);

/* The host sends bytes at the present tick, "7E 03 00". */
void wire_rig_bytes(const char *hex);

/* The frame of a message. Returns its length. */
size_t wire_rig_frame(uint8_t dnode, uint8_t snode, const void *message, size_t length, uint8_t *out);

/* The host sends a whole frame from node 0 at the present tick. */
void wire_rig_send(uint8_t dnode, const void *message, size_t length);

/* The same, then the line comes to rest. */
void wire_rig_ask(uint8_t dnode, const void *message, size_t length);

/* Time continues: until nothing is under way; so many ticks. */
void wire_rig_settle(void);
void wire_rig_pass(uint64_t ticks);

/* The next line that was taken down and not checked yet is this one; and there is none more. */
void wire_rig_says(const char *line);
void wire_rig_says_no_more(void);

#endif
