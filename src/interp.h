/* SPDX-License-Identifier: MIT */
/* interp.h: the interpreter of one motor (section 5, K2, K4). */
#ifndef RKM04_SRC_INTERP_H
#define RKM04_SRC_INTERP_H

#include <rkm04/unit.h>

/* `\`: the motor's start values; program, stacks, guards, table, functions, motion are gone (C1). */
void interp_reset(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* What arrives: the caller sees to it that the next slot has a turn (unit->touched). */

/* Commands from number `first` on have been appended to the program: go there, or end a hold with them (C2, C3). */
void interp_note_stored(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint64_t first);

/* K ('K') or C75 ('C') has arrived; it acts in the next slot (C3). */
void interp_request(struct rkm04_motor *motor, char request);

/* A stand-alone V has arrived. Returns false if it is an ordinary command: no motion in progress (C4). */
bool interp_change_speed(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint16_t speed);

/* The motor's turn in the slot unit->now. */
void interp_turn(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* The first slot at or after `tick`. */
uint64_t interp_slot(uint64_t tick);

/* Place 1..700 of the command being executed; 0 when idle or ended (P9). */
unsigned interp_index(const struct rkm04_motor *motor);

#endif
