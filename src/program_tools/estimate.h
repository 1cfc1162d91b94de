/* SPDX-License-Identifier: MIT */
/* estimate.h: how long programs take, how far and how fast they move: run by the core in virtual time, exact to the
 * microsecond. */
#ifndef RKM04_PROGRAM_TOOLS_ESTIMATE_H
#define RKM04_PROGRAM_TOOLS_ESTIMATE_H

#include <stdint.h>
#include <stdio.h>

#include <rkm04/limits.h>
#include <rkm04/readings.h>
#include <rkm04/text.h>

#include "diagnostic.h"
#include "planner.h"

#define ESTIMATE_COMMANDS_MAX 2000000u /* executed; a program that takes more is not followed to its end */
#define ESTIMATE_COLLISIONS_MAX 100u   /* kept */

struct estimate_options {
    struct rkm04_readings readings;
    bool pass_inputs;         /* an input that everything waits for comes at once */
    uint32_t commands_max;    /* executed, further ones are not followed; 0: ESTIMATE_COMMANDS_MAX */
    const char *plant;        /* YAML text of a plant (docs/PLANT.md); NULL: none */
    size_t plant_length;
    const char *plant_name;   /* for messages */
    FILE *errors;             /* where errors of the plant go */
};

/* Where a command is. */
struct estimate_place {
    unsigned motor;           /* 1..4 */
    size_t source, offset, length, line, column;
    struct rkm04_command command;
};

/* What a command that moves has done. */
struct estimate_motion {
    struct estimate_place place;
    uint64_t times;           /* it was executed; of a program with a round: in a round */
    bool in_round;            /* it belongs to the round */
    bool varies;              /* not each time the same steps and duration */
    bool endless;             /* it has no end of its own */
    uint64_t steps, duration; /* the last time; us from the slot of the command to the last pulse */
    uint64_t all_steps, all_duration;
    uint32_t peak;            /* steps/s, the highest of all times, rounded down */
    size_t point_count;       /* as Get Tabul Run shows them, the last time */
    struct planner_point points[PLANNER_POINTS_MAX];
};

/* A motor that waits when the estimate ends. */
struct estimate_wait {
    struct estimate_place place; /* O, Z, [, a jump without label, a limit move */
    uint64_t since;              /* us */
    bool driven;                 /* for an input that the plant drives */
};

struct estimate_collision {
    uint64_t at; /* us */
    unsigned motor;
    char *text;  /* what happened */
};

enum estimate_end {
    ESTIMATE_DONE,    /* all motors are idle */
    ESTIMATE_STOPPED, /* a motor has a fault */
    ESTIMATE_WAITS,   /* for what nothing here brings */
    ESTIMATE_ROUND,   /* an endless loop */
    ESTIMATE_ENDLESS, /* a motion without an end */
    ESTIMATE_LIMIT    /* commands_max, or the end of virtual time */
};

struct estimate {
    enum estimate_end end;
    uint64_t duration;  /* us from the first slot to the last thing done */
    uint64_t round;     /* us of a round; 0: none */
    uint64_t steps[RKM04_MOTORS]; /* of each motor, in both directions; with a round: in a round */
    int32_t position[RKM04_MOTORS];
    uint32_t peak;      /* steps/s */
    uint32_t assumed;   /* inputs that came because they were waited for: bit 0 is DI 01 */
    struct estimate_motion *motions; /* in the order of the texts */
    size_t motion_count;
    struct estimate_wait waits[RKM04_MOTORS];
    size_t wait_count;
    bool deadlock;      /* motors wait for variables that no motor sets any more */
    uint64_t deadlock_at; /* us from which two of them do, or the only one */
    struct estimate_collision *collisions;
    size_t collision_count; /* kept */
    uint64_t collisions_all;
};

enum estimate_result {
    ESTIMATE_OK,
    ESTIMATE_REFUSED,  /* a text has an error: check_programs() says which */
    ESTIMATE_NO_PLANT, /* the plant has an error, which was reported */
    ESTIMATE_NO_MEMORY
};

/* Run the programs of a unit from power-up. estimate_free() is due in any case. */
enum estimate_result estimate_programs(const struct program_source *sources, size_t count, const struct estimate_options *options,
                                       struct estimate *estimate);
void estimate_free(struct estimate *estimate);

/* "done", "stopped", "waits", "round", "endless", "limit" */
const char *estimate_end_name(enum estimate_end end);

#endif
