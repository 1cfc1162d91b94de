/* SPDX-License-Identifier: MIT */
/* rkm04_repeat.h: does a unit's state repeat? Then what it does repeats without end, as long as nothing comes from outside.
 *
 * States are compared as plain copies of the whole unit (Brent: with a copy that is renewed after 1, 2, 4, … looks). What does
 * not decide what follows is taken out before: times count from the present tick; counters of motors whose programs have no G and
 * no H are left out; of an endless motion at its constant speed nothing is compared but that it continues. What remains has to be
 * equal to the byte, so a state that is called the same is the same; one that is the same may be overlooked. */
#ifndef RKM04_DEVICE_RKM04_REPEAT_H
#define RKM04_DEVICE_RKM04_REPEAT_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/unit.h>

struct rkm04_repeat {
    uint64_t looks, power; /* since the copy was taken; how many until it is renewed. 0: there is none */
    uint64_t key, tick;    /* of the copy */
    struct rkm04_unit copy, present;
};

/* Call it for a unit again and again. *repeat must be zero at first. Returns after how many ticks its state has repeated; 0: it
 * has not. */
uint64_t rkm04_repeat_check(struct rkm04_repeat *repeat, const struct rkm04_unit *unit);

#endif
