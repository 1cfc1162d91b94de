/* SPDX-License-Identifier: MIT */
/* motion.h: the life of a motor's motion: begin, pulses, stop, hold, rest, end (C5, C12, C13, section 6). All act at
 * unit->now, which is a slot. */
#ifndef RKM04_SRC_MOTION_H
#define RKM04_SRC_MOTION_H

#include <rkm04/unit.h>

/* Begin a motion. Those without steps, or stopped by a guard at once, are over when these return. */
void motion_begin_steps(struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t steps, bool forward);
void motion_begin_compound(struct rkm04_unit *unit, struct rkm04_motor *motor);
void motion_begin_endless(struct rkm04_unit *unit, struct rkm04_motor *motor, bool forward);
void motion_begin_limit(struct rkm04_unit *unit, struct rkm04_motor *motor, bool forward, unsigned input);

/* Can the Y table be computed (E1)? */
bool motion_compound_possible(const struct rkm04_motor *motor);

/* Send the pulses due up to and including tick `limit`, and end the motion at its last one. Stops short of the pulse that sets
 * outputs (C12). */
void motion_run(struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t limit);

/* A tick before which the motor reports nothing to the port; RKM04_NEVER: it does not move. */
uint64_t motion_next_report(const struct rkm04_unit *unit, const struct rkm04_motor *motor);

/* Tick of the pulse that motion_run() stopped short of; RKM04_NEVER: none. */
uint64_t motion_mark_due(const struct rkm04_motor *motor);

/* Send that pulse and set its outputs. */
void motion_pass_mark(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Decelerate to a stop (R5); what comes after it is in motor->after. */
void motion_stop(struct rkm04_unit *unit, struct rkm04_motor *motor, enum rkm04_after after);

/* Check M, N and the input of a limit move in this slot (C5). */
void motion_check_inputs(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Continue with the rest of a held motion (C3). */
void motion_resume(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Stop at once, without a ramp (C1). The motion is dropped. */
void motion_abort(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* First tick at which the next command or motion may begin: the last pulse has ended (K4, R7). */
uint64_t motion_free_from(const struct rkm04_unit *unit, const struct rkm04_motor *motor);

#endif
