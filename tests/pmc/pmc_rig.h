/* SPDX-License-Identifier: MIT */
/* pmc_rig.h: a PMC with what it reports, switches at its axes, and a flash.
 *
 *     pmc_rig_begin(&(struct pmc_config){.axes = 2});
 *     ask(PMC_MOVE_BY, 1, 1000, 0);
 *     run_slots(100);                  // to the tick before slot now + 100
 *     ck_assert_uint_eq(pulses[0], 1000); */
#ifndef TESTS_PMC_RIG_H
#define TESTS_PMC_RIG_H

#include <check.h>

#include "core/flash_fake.h"
#include "pmc/pmc.h"

#define SLOT ((uint64_t)PMC_SLOT_TICKS)
#define PULSES_MAX 2000000u
#define HAPPENINGS_MAX 4096u

extern struct pmc_unit unit;
extern struct flash_fake flash;

/* Pulses of each axis: their number and ticks; the counter after the last one, as reported. */
extern size_t pulses[PMC_AXES];
extern uint64_t *pulse[PMC_AXES];
extern int32_t reported[PMC_AXES];

/* What else was reported. */
enum happening_kind { HAPPENED_EVENT, HAPPENED_OUTPUTS, HAPPENED_DIRECTION };
struct happening {
    uint64_t tick;
    enum happening_kind kind;
    unsigned axis, what; /* of an event */
    uint32_t value;
};
extern struct happening happening[HAPPENINGS_MAX];
extern size_t happenings;

/* A switch at an axis: active between `from` and `to` of the true position; once it is, so much further. */
struct rig_switch {
    uint8_t input; /* enum pmc_input; 0: none */
    int32_t from, to, hysteresis;
};
#define RIG_FAR INT32_MAX
#define RIG_SWITCHES 4u

/* Power up with an erased flash, or with the one there is, and with no switches. */
void pmc_rig_begin(const struct pmc_config *config);
void pmc_rig_restart(const struct pmc_config *config);

/* The true position of an axis, and its switches. */
void rig_plant(unsigned axis, int32_t position, const struct rig_switch *switches, size_t count);
int32_t rig_true(unsigned axis);

/* Levels of inputs that no switch drives. */
void rig_inputs(uint16_t levels);

/* A request. */
enum pmc_answer ask(enum pmc_request_kind kind, unsigned axes, int32_t x, int32_t y);

/* A request that must be taken. */
void must(enum pmc_request_kind kind, unsigned axes, int32_t x, int32_t y);

/* Write a parameter, a register; must be taken. */
void set(unsigned axis, enum pmc_parameter which, int32_t value);
void reg(unsigned axis, unsigned number, struct pmc_command command);

/* Go on to `tick`: all before it is done. Switches change with pulses; what a pulse before a slot does is seen in it. */
void run_to(uint64_t tick);

/* Go on to the tick of slot `number`, or to the one behind it: that slot is done. */
void run_to_slot(uint64_t number);
void run_through_slot(uint64_t number);

/* Go on until the axis is not busy, a minute of virtual time at most. */
void run_until_idle(unsigned axis);

struct pmc_axis_state axis_state(unsigned axis);

/* The slot in which a register was executed for the n-th time (from 0); 0: it was not. */
uint64_t slot_of_reg(unsigned axis, unsigned number, unsigned n);

#endif
