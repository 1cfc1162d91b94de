/* SPDX-License-Identifier: MIT */
/* cib_rig.h: a CIB module whose pulses, MCSTAT and outputs are kept with their ticks. Ticks of a test count from BASE, the
 * slot in which its first motion command acts. */
#ifndef RKM04_TESTS_CIB_RIG_H
#define RKM04_TESTS_CIB_RIG_H

#include "cib/cib.h"

#define BASE 1000

enum drive_name { A, B };

extern struct cib_unit cib;

/* Drives with s 100, maximum speed 1000, a 200, d 100 and mode 20, as in the worked examples. */
extern const struct cib_config cib_example;

/* Power up; the unit is at tick 0. */
void cib_power_up(const struct cib_config *config);

/* Change what is reported: by one pulse at a time with the outputs, in blocks, or not at all. */
enum seen { SEEN_ALL, SEEN_STEPS, SEEN_NOTHING };
void cib_see(enum seen seen);

/* Advance to a tick: what a test delivers then comes in it. run: in microseconds from BASE on. */
void cib_advance_to(uint64_t tick);
void at(int64_t t);

/* A message with a new SEQ and a command for a drive. */
void command(enum drive_name drive, uint16_t number, int32_t p1, uint16_t p2);

uint16_t in(uint16_t address);  /* input register */
uint16_t out(uint16_t address); /* holding register */
int32_t position(void);         /* of drive A, from its registers */
void set(uint16_t address, uint16_t value); /* by a message of its own that has to be good */

/* ---- What has been kept of drive A ---- */

unsigned pulses(void);
void expect_pulse(unsigned number, int64_t t, int64_t late);  /* the number-th from 1 came at t, or up to `late` off */
void expect_reached(int32_t position, int64_t t, int64_t late); /* the last pulse to that position came then */
void expect_position(int64_t t, int32_t position); /* after tick t */
void expect_status(int64_t t, unsigned status);    /* after tick t */
void expect_speed(int32_t speed);                  /* in front of the tick that `at` has come to */
void expect_driven(int64_t t, unsigned driven);    /* outputs as reported, after tick t */
unsigned driven_at_pulse(unsigned number);         /* outputs behind the number-th pulse */

/* Edges of PWM, as reported: the n-th from 0. */
unsigned edges(void);
uint64_t edge_tick(unsigned n);
uint16_t edge_driven(unsigned n);

/* Events of a kind: how many; value of the last one. */
unsigned events(enum cib_event what);
uint32_t last_event(enum cib_event what);

#endif
