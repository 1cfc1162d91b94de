/* SPDX-License-Identifier: MIT */
/* power_rig.h: a unit whose power is cut in the middle of a store, and what it finds when the power is back.
 *
 *     power_prepare(&sequence);                         // old programs in flash, new ones in memory
 *     power_cut(&(struct cut){.fault = FLASH_CUT_BITS, .operation = 3, .seed = 7});
 *
 * Everything goes through the unit: message 3 stores, rkm04_init loads. */
#ifndef RKM04_TESTS_POWER_RIG_H
#define RKM04_TESTS_POWER_RIG_H

#include "store_rig.h"

/* What a host does with a flash, and what is wrong with the flash. */
struct sequence {
    const char *name;
    enum contents old, new;     /* `old` NOTHING: never stored */
    unsigned motor;             /* of Store Flash; 0: all */
    unsigned times;             /* the old programs were stored so often */
    unsigned stores;            /* requests for the new programs, whatever is answered; 0 counts as 1 */
    enum flash_wear wear;       /* of the block that the store has to take (with all motors: that of motor 2) */
    enum flash_fault first;     /* the first operation fails so: FLASH_FAIL_* */
    bool garbage;               /* a flash that was never ours */
    bool last_generation;       /* the generation before 0 */
};

/* One cut: at an erase or program, or at a read. */
struct cut {
    enum flash_fault fault;     /* FLASH_CUT_* */
    unsigned operation;         /* 1..; 0: none */
    unsigned read;              /* 1..; 0: none */
    unsigned border;            /* where it is torn, as in struct flash_fake */
    uint32_t seed;
};

/* Cuts made so far, by all processes of the test program. */
void power_count_begin(void);
unsigned long power_cuts(void);

/* Is this the long form? (RKM04_TEST_LONG) */
bool power_long(void);

/* Bring a unit and its flash to where the sequence begins. */
void power_prepare(const struct sequence *sequence);

/* From there: operations and reads that the stores take when nothing is cut. Sees to it that what was answered is what is
 * found after a restart. */
void power_uncut(unsigned *operations, unsigned *reads);

/* From there: do the stores, cut the power, restart. Every slot holds its old or its new program entire, those of motors that
 * were not asked for are untouched to the byte, what was answered with err 0 is there, and the slot can be stored to again.
 * Returns the length of the operation that was cut. */
unsigned power_cut(const struct cut *cut);

/* The same without a second store; what was found is where the next power_cut begins, as its old programs. */
void power_cut_and_stay(const struct cut *cut);

#endif
