/* SPDX-License-Identifier: MIT */
/* execute.h: what each command does (section 5). Part of the interpreter; acts at unit->now, which is a slot. */
#ifndef RKM04_SRC_EXECUTE_H
#define RKM04_SRC_EXECUTE_H

#include <rkm04/unit.h>

/* Execute motor->command, whose number is motor->number; motor->next stands behind it, motor->due one slot later. */
void execute_command(struct rkm04_unit *unit, struct rkm04_motor *motor);

/* Motor in O, Z or `[`: is what it waits for there? */
bool execute_wait_is_over(const struct rkm04_unit *unit, const struct rkm04_motor *motor);

#endif
