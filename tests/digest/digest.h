/* SPDX-License-Identifier: MIT */
/* digest.h: the same pulses on every machine. Sessions with a unit, the manual's and random ones, and a digest of each: over
 * every pulse, direction, output and event with its tick, every byte of every answer, every byte that comes to be in flash,
 * and what can be seen of the unit at the end.
 *
 * Needs nothing but the core and a compiler: no C library, no heap. One main_*.c a surrounding prints the lines. */
#ifndef RKM04_TESTS_DIGEST_H
#define RKM04_TESTS_DIGEST_H

#include <rkm04/unit.h>

#include "text.h"

#define MS UINT64_C(1000)
#define SECOND (1000 * MS)

/* ---- The whole ---- */

/* Run all sessions. A line each goes to `say`, zero-terminated and without a newline: name, digest, number of pulses. The
 * last one is "all", over all the others. */
void digest_run(void (*say)(const char *line));

/* ---- A session; one at a time ---- */

struct session {
    uint8_t node;                        /* DNode 1..16 */
    uint16_t latency;                    /* ms, of C4 */
    const struct rkm04_framing *framing;
    bool quiet; /* no pulses are asked for: the port has no `step`, so that motions of any length cost nothing */
};

/* An RKM04 with an erased flash is powered up. */
void session_begin(const struct session *session);

/* Power goes off and on; the flash stays. */
void session_power_cycle(void);

/* The first tick that is not yet done. */
uint64_t session_now(void);

/* Time passes up to a tick, which is not yet done then. */
void session_to(uint64_t tick);

/* From the present tick on the inputs are these; bit 0 is DI 01. */
void session_inputs(uint8_t mask);

/* A request comes in from the host. While an answer is going out the unit takes no more, so that is fetched first, as far as
 * is needed. */
void session_request(const void *message, size_t length);

/* Request 2, Set Command, to motor '0'..'4'; at most SESSION_TEXT_MAX characters. */
#define SESSION_TEXT_MAX 1000
void session_set(char motor, const char *text, size_t length);

/* A request of two bytes, such as 4, Get Position. */
void session_ask(uint8_t number, char motor);

/* Bytes come in as they are. */
void session_bytes(const uint8_t *bytes, size_t length);

/* Fetch up to so many bytes of the answer. */
void session_fetch(size_t bytes);

/* What is left of an answer is fetched, and the unit looked at. Prints the session's line. */
void session_end(const char *name);

/* ---- Sessions of a kind ---- */

/* The manual's examples of chapters 4.6, 5.3, 7 and 9, and motions at the limits. */
void run_manual(void);

/* So many random ones. */
#define STORIES 500
void run_stories(void);

#endif
