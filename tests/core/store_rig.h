/* SPDX-License-Identifier: MIT */
/* store_rig.h: four slots on a flash that breaks on demand, and programs to store there. */
#ifndef RKM04_TESTS_STORE_RIG_H
#define RKM04_TESTS_STORE_RIG_H

#include <check.h>

#include "flash_fake.h"
#include "program.h"
#include "store.h"

extern const struct rkm04_port store_port; /* the three flash functions; its context is a struct flash_fake */
extern struct flash_fake flash;

/* The programs that are stored over one another. */
enum contents { NOTHING, EMPTY, ONE, SHORT, FULL, WRAPPED, CONTENTS };
extern struct rkm04_program programs[CONTENTS];

/* Make a program of `count` commands of all kinds; another `first`, other commands. */
void fill(struct rkm04_program *program, unsigned first, unsigned count);

/* Do two memories hold the same commands, wherever in the ring? */
bool same(const struct rkm04_program *a, const struct rkm04_program *b);

/* store_save and store_load on `flash`. What `load` is given is not clean. */
int save(unsigned motor, const struct rkm04_program *program);
enum rkm04_slot load(unsigned motor, struct rkm04_program *program);

/* After a power-up the slot of the motor holds this program, or is reported as not to be trusted and holds none. */
void assert_slot(unsigned motor, const struct rkm04_program *expected);
void assert_untrusted(unsigned motor);

/* A test case on a new flash that ends with no rule of the flash broken. */
TCase *add_store_case(Suite *suite, const char *name, double seconds);

#endif
