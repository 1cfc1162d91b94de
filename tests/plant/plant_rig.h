/* SPDX-License-Identifier: MIT */
/* plant_rig.h: a line of one unit with a plant, for tests: what moves, what is reported. */
#ifndef RKM04_TESTS_PLANT_RIG_H
#define RKM04_TESTS_PLANT_RIG_H

#include "command/command.h"
#include "sim/sim.h"

#define RIG_INPUTS 4096u /* changes of inputs that are kept */
#define RIG_NEWS 64u

struct plant_rig {
    struct sim sim;
    struct watcher watcher;
    char errors[2000];         /* what sim_configure_plants() said */
    unsigned inputs, news;
    struct {
        uint64_t tick;
        uint8_t mask;
    } input[RIG_INPUTS];
    struct {
        uint64_t tick;
        unsigned motor;
        enum plant_event what;
        char text[PLANT_TEXT_SIZE];
    } report[RIG_NEWS];
};

/* Power up units with these addresses; the plant comes at tick 0 (NULL: none). What is wrong with it is in `errors`. Returns
 * whether it was taken. */
bool plant_rig_begin(struct plant_rig *rig, const char *nodes, const char *plant);
void plant_rig_end(struct plant_rig *rig);

/* Another plant. */
bool plant_rig_configure(struct plant_rig *rig, const char *plant);

/* Store a program for motor '1'..'4' of unit `number`, which must be all right. */
void plant_rig_program(struct plant_rig *rig, unsigned number, char motor, const char *text);

/* Run for so many ticks. */
void plant_rig_run(struct plant_rig *rig, uint64_t ticks);

/* True position and counter of a motor of the first unit. */
int64_t true_position(const struct plant_rig *rig, unsigned motor);
int32_t counter(struct plant_rig *rig, unsigned motor);

/* Inputs of the first unit, as the firmware sees them. */
uint8_t inputs(struct plant_rig *rig);

/* A command, its parameters as JSON; the result as compact JSON with sorted keys, or "CODE TEXT". Static memory. */
const char *plant_rig_command(struct plant_rig *rig, const char *method, const char *params);

#endif
