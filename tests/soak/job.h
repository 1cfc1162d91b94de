/* SPDX-License-Identifier: MIT */
/* job.h: random programs whose outcome is known: a model that counts (steps, outputs, variables) and knows nothing of slots,
 * ramps and ticks runs them beforehand. */
#ifndef RKM04_TESTS_SOAK_JOB_H
#define RKM04_TESTS_SOAK_JOB_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define JOB_OPS 200u
#define JOB_TEXT 2400u /* characters, the blanks and the end included */
#define JOB_SPEED_MIN 100 /* steps/s: no motion of a job is slower */

struct dice {
    uint64_t state;
};

/* A number low..high; one whose order of magnitude is random. */
int64_t dice_roll(struct dice *dice, int64_t low, int64_t high);
int64_t dice_scale(struct dice *dice, int64_t low, int64_t high);
bool dice_chance(struct dice *dice, unsigned percent);

/* A command: op as in the text; 'c' is C100; I has a level and a label. */
struct job_op {
    char op;
    uint8_t level, label;
    int32_t argument;
};

struct job {
    unsigned count; /* commands; 0: no program */
    struct job_op op[JOB_OPS];
    char text[JOB_TEXT]; /* canonical (P8) */
};

/* What there is of a motor; outputs and variables only those that are its own. */
struct job_state {
    int64_t position;
    uint8_t outputs;
    uint16_t variables;
};

/* What a job does on its way. */
struct job_way {
    int64_t lowest, highest; /* positions, beginning and end included */
    int64_t steps;           /* pulses in all */
    uint64_t ticks;          /* it takes no longer */
};

/* A random job of motor 1..4 that from `state` takes at most `steps` and `ticks`. */
void job_make(struct job *job, struct dice *dice, unsigned motor, const struct job_state *state, int64_t steps, uint64_t ticks);

/* Run it: *state becomes what it leads to. Returns false if it takes more than `steps` or `ticks`. */
bool job_run(const struct job *job, struct job_state *state, int64_t steps, uint64_t ticks, struct job_way *way);

#endif
