/* SPDX-License-Identifier: MIT */
/* estimate_run.h: an estimate under way. For the files of the estimate. */
#ifndef RKM04_PROGRAM_TOOLS_ESTIMATE_RUN_H
#define RKM04_PROGRAM_TOOLS_ESTIMATE_RUN_H

#include "code.h"
#include "estimate.h"
#include "sim/sim.h"

/* What is known of a motor. */
struct estimate_motor {
    struct code code;
    size_t *row;            /* of each command: its motion, SIZE_MAX: none */
    size_t index;           /* of the command being executed; code.count: none */
    uint64_t since;         /* tick at which it began */
    size_t moving;          /* the command of the present motion */
    uint64_t begin, end;    /* ticks of the motion */
    uint64_t pulses;        /* of the present motion, where they are counted */
    bool began, ended, stopping, in_motion;
    size_t point_count;
    struct planner_point points[PLANNER_POINTS_MAX];
};

struct estimate_run {
    struct sim sim;
    struct watcher watcher;
    const struct program_source *sources;
    size_t count;
    const struct estimate_options *options;
    struct estimate *estimate;
    char **texts;           /* of the sources, mapped in place */
    struct estimate_motor motor[RKM04_MOTORS];
    void *repeat;
    uint64_t commands;      /* executed */
    uint64_t drift_from;    /* tick at which a round first ended elsewhere on the plant; 0: none has */
    uint64_t last;          /* tick of the last thing that happened */
    size_t motion_room;
    bool no_memory;
};

/* estimate_watch.c: take down what happens, and after each leap what has become of it. */
void estimate_watch(struct estimate_run *run);
void estimate_update(struct estimate_run *run);

/* The place of a command of a motor 1..4. */
struct estimate_place estimate_place_of(const struct estimate_run *run, unsigned motor, size_t index);

#endif
