/* SPDX-License-Identifier: MIT */
/* rig.h: one unit on a test bench: recorder, flash, short calls, and the closed forms of specification section 6 to compare with.
 *
 *     static struct rig rig;
 *     rig_power_up(&rig, NULL);
 *     rig_set(&rig, '1', "F1000 R");        // at tick 0: F in slot 1000, R in slot 2000
 *     rig_to(&rig, 1500000);                // all ticks before 1 500 000 are done
 *     rig_expect_motion(&rig, 1, 1, 2000, 2000 + move_ticks(100, 1000, 2000, 1000), 1000, true); */
#ifndef RKM04_TESTS_RIG_H
#define RKM04_TESTS_RIG_H

#include <check.h>
#include <rkm04/unit.h>

#include "flash_fake.h"
#include "recorder.h"

#define MS UINT64_C(1000)     /* ticks */
#define SECOND UINT64_C(1000000)

struct rig {
    struct rkm04_unit unit;
    struct recorder record;
    struct flash_fake flash;
};

/* A new unit with an erased flash, at tick 0. config NULL: node 1, everything else as delivered. */
void rig_power_up(struct rig *rig, const struct rkm04_config *config);

/* Power off and on: tick 0 again, the flash stays, the record begins again. */
void rig_power_cycle(struct rig *rig);

void rig_free(struct rig *rig);

/* Set Command for motor '0'..'4' at the present tick. Returns the flag; rig_accept insists on flag 0. */
int rig_set(struct rig *rig, char motor, const char *text);
void rig_accept(struct rig *rig, char motor, const char *text);

/* Advance until all ticks before `tick` are done; it must not lie in the past. */
void rig_to(struct rig *rig, uint64_t tick);

/* The same, then set one input (1..8), or send motor 1 a text that must be accepted. */
void rig_input_at(struct rig *rig, uint64_t tick, unsigned input, bool level);
void rig_accept_at(struct rig *rig, uint64_t tick, const char *text);

struct rkm04_motor_state rig_motor(const struct rig *rig, unsigned motor);

/* The motor is in this state; a failure names both. */
void rig_expect_state(const struct rig *rig, unsigned motor, enum rkm04_state state);

/* The program in memory as Get Command answers it; valid until the next call. */
const char *rig_program(struct rig *rig, unsigned motor);

/* The body of the answer to message 5, 6 or 7, without its two leading bytes; valid until the next call. */
const char *rig_ask(struct rig *rig, uint8_t message, unsigned motor);

/* Tick at which motor 1 executed the command at `place` for the n-th (1..) time; RKM04_NEVER if it did not. */
uint64_t rig_ran(const struct rig *rig, unsigned place, size_t n);

/* Tick at which the outputs took this value for the n-th time; RKM04_NEVER if they did not. */
uint64_t rig_outputs_became(const struct rig *rig, uint8_t mask, size_t n);

/* Motions of a motor with steps that have begun (a resumed one counts again). */
size_t rig_motions(const struct rig *rig, unsigned motor);

/* The n-th (1..) motion began and ended at these ticks, with the last pulse at `end` and exactly `steps` pulses, all of them
 * after `begin` and in this direction. */
void rig_expect_motion(const struct rig *rig, unsigned motor, size_t n, uint64_t begin, uint64_t end, size_t steps, bool forward);

/* The same with its last pulse up to one tick beside `end` (R2: compounds, stops, changes of speed). */
void rig_expect_motion_near(const struct rig *rig, unsigned motor, size_t n, uint64_t begin, uint64_t end, size_t steps,
                            bool forward);

/* Ticks of `steps` steps from rest to rest (R1, R3): ceil(10^6 T). */
uint64_t move_ticks(uint64_t s, uint64_t v, uint64_t a, uint64_t steps);

/* Ticks to pulse k of the rising ramp, ceil(10^6 (sqrt(s^2 + 2ak) - s) / a). */
uint64_t rise_ticks(uint64_t s, uint64_t a, uint64_t k);

/* Run one suite and say how to run a part of it alone. Returns what main returns. */
int rig_run(Suite *suite, const char *program);

/* The slot in which the command after a motion with its last pulse at `end` is executed (K4). */
uint64_t slot_behind(uint64_t end);

#endif
