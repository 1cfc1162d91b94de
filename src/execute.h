/* SPDX-License-Identifier: MIT */
/* execute.h: what each command does (section 5). Part of the interpreter; acts at unit->now, which is a slot. */
#ifndef RKM04_SRC_EXECUTE_H
#define RKM04_SRC_EXECUTE_H

#include <rkm04/unit.h>

/* Execute motor->command, whose number is motor->number; motor->next follows it, motor->due one slot later. */
void execute_command(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Motor in O, Z, `[` or before a label that is not in memory: continue if what it waits for is there. Returns whether it is. */
bool execute_wait_is_over(const struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Do nothing for so many slots. */
void execute_dwell(const struct rkm04_unit *unit, struct rkm04_motor *motor, uint32_t slots);

/* Switch simulation mode: the terminals step, direction and DO go to 0 and come back (C11). */
void execute_simulate(struct rkm04_unit *unit, bool on);

#endif
