/* SPDX-License-Identifier: MIT */
/* program.h: the tape of a motor: 700 commands in a ring, and where its labels are (C2, C8, C9, C10).
 *
 * A command's number counts from 0 since the last reset and never comes again; its place is number % 700 + 1. */
#ifndef RKM04_SRC_PROGRAM_H
#define RKM04_SRC_PROGRAM_H

#include <rkm04/unit.h>

/* Empty the memory. */
void program_clear(struct rkm04_program *program);

/* Store one command, over the oldest if the memory is full. */
void program_append(struct rkm04_program *program, struct rkm04_command command);

/* Number of the oldest command left; equals program->written when the memory is empty. */
uint64_t program_oldest(const struct rkm04_program *program);

/* Commands in memory, 0..700. */
unsigned program_count(const struct rkm04_program *program);

/* The command with this number, oldest <= number < written. */
struct rkm04_command program_at(const struct rkm04_program *program, uint64_t number);

/* Place 1..700 of a number. */
unsigned program_place(uint64_t number);

/* Number of the label 1..80 written last. Returns false if it is not in memory. */
bool program_label(const struct rkm04_program *program, unsigned label, uint64_t *number);

/* Has a `]` arrived after this number? (C9) */
bool program_closed_after(const struct rkm04_program *program, uint64_t number);

#endif
