/* SPDX-License-Identifier: MIT */
/* soak.h: sixteen units on a line in virtual time, a host that knows what every answer and every counter has to be, and
 * everything around them that goes wrong. */
#ifndef RKM04_TESTS_SOAK_SOAK_H
#define RKM04_TESTS_SOAK_SOAK_H

#include <stdarg.h>
#include <stdio.h>

#include "command/command.h"
#include "job.h"
#include "sim/sim.h"

#define SECOND ((uint64_t)RKM04_TICKS_PER_SECOND)
#define DAY (86400u * SECOND)
#define UNITS SEGMENT_UNITS

/* What a motor has to do and be. */
struct soak_motor {
    struct job job, slot;    /* in memory; stored */
    struct job_state end;    /* when the job is done */
    struct job_way way;
    uint64_t done;           /* the job has ended by this tick */
    int64_t pulses;          /* seen while `watched` */
};

/* What a unit must have counted since the round began. */
struct soak_unit {
    struct rkm04_counters begin;
    uint32_t requests, answers, others, dropped;
    struct soak_motor motor[RKM04_MOTORS];
};

struct soak {
    struct sim sim;
    struct dice dice;
    struct soak_unit unit[UNITS];
    struct watcher steps;
    bool watched;            /* pulses are counted */
    bool exact;              /* every byte and frame is accounted for */

    struct rkm04_receiver receiver;
    uint8_t answer[RKM04_MESSAGE_MAX];
    size_t heard;            /* length of the message in `answer`; 0: none yet */
    uint64_t out, in;        /* bytes sent and received by the host */
    uint64_t line_begin;     /* bytes on the line when the round began, and the master's */
    uint64_t host_begin;

    uint64_t requests, answers, rounds, jobs, steps_done, stores, garbage, faults, snapshots, resets; /* in all */
    char what[100];          /* is being done: for messages */
};

/* Report what is wrong, where and how to see it again; ends the program with status 1. */
_Noreturn void soak_fail(const struct soak *soak, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* ---- The host (host.c): unit 0..15, motor '0'..'4' ------------------------------------------------------------------ */

void host_receive(void *context, const uint8_t *bytes, size_t length);

/* Bytes as they are, taken by the line as it has room, and time until they have passed. */
void host_send(struct soak *soak, const uint8_t *bytes, size_t length);

/* Time until nothing moves on the line: answers have gone out to the end. */
void host_finish(struct soak *soak);

/* A frame with its check value. Returns its length. `frame` has room for twice the message and ten bytes. */
size_t host_frame(uint8_t node, uint8_t snode, const void *message, size_t length, uint8_t *frame);

/* A request that is answered; the answer is in soak->answer. Returns its length. */
size_t host_ask(struct soak *soak, unsigned unit, const void *message, size_t length);

/* A request to all units, which no unit answers. */
void host_send_all(struct soak *soak, const void *message, size_t length);

/* Set Command: is answered with this flag and character. */
void host_set(struct soak *soak, unsigned unit, char motor, const char *text, uint8_t flag, uint8_t character);

/* Something is asked at random, and the answer judged as far as it is known. */
void host_poll(struct soak *soak, unsigned unit);

/* Get Position of all motors: they stand where their jobs end. */
void host_check_ends(struct soak *soak, unsigned unit);

/* Count from now on what units and line have to count; they have. */
void counters_begin(struct soak *soak);
void counters_check(struct soak *soak);

/* ---- Rounds ------------------------------------------------------------------------------------------------------------- */

/* Jobs (rounds.c): given to motors, polled, stored, held, resumed, and done as the model has it. */
void round_jobs(struct soak *soak);
void round_power(struct soak *soak);   /* power off and on, reset: what was stored runs */
void round_garbage(struct soak *soak); /* broken frames, noise, floods: counted, and nothing else */

/* Everything goes wrong (chaos.c), and then the line is as before: by coming back to a snapshot, or by clearing up. */
void round_chaos(struct soak *soak);

/* All motors have done their jobs; nothing is left over from rounds before. Checked. */
void soak_settle(struct soak *soak);

/* All motors without a program, at 0, inputs and outputs 0. */
void soak_clear(struct soak *soak);

/* Obeyed. */
void soak_command(struct soak *soak, const char *method, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* A unit that has been powered up begins what its motors have stored. */
void soak_powered_up(struct soak *soak, unsigned unit);

#endif
