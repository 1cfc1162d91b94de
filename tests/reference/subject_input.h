/* SPDX-License-Identifier: MIT */
/* subject_input.h: a program that executes standard input with a rig. Rigs assert: they need a test of Check around them. */
#ifndef RKM04_TESTS_SUBJECT_INPUT_H
#define RKM04_TESTS_SUBJECT_INPUT_H

/* Run `obey` as the only test of a program; what failed goes to standard error. Returns the exit status. */
int run_subject(const char *name, void (*obey)(void));

#endif
