/* SPDX-License-Identifier: MIT */
/* scenario_model.h: what a scenario is made of. Inside: scenario_read.c and scenario_step.c build it, scenario_run.c and
 * scenario_do.c do it. */
#ifndef RKM04_SCENARIO_MODEL_H
#define RKM04_SCENARIO_MODEL_H

#include "condition/condition.h"
#include "scenario.h"
#include "scenario_bytes.h"
#include "text/text.h"

enum scenario_action {
    ACTION_SET,     /* a program text */
    ACTION_MESSAGE, /* framed */
    ACTION_BYTES,   /* as they are */
    ACTION_WAIT,
    ACTION_EXPECT,
    ACTION_STAYS,
    ACTION_ADVANCE,
    ACTION_PULSES,
    ACTION_CALL     /* a command of command.h */
};

enum scenario_answer {
    ANSWER_UNASKED, /* continues without waiting for it */
    ANSWER_NONE,    /* none must come */
    ANSWER_ANY,
    ANSWER_THIS
};

#define BOUNDS_MAX 6

/* What a number must be. */
struct scenario_bounds {
    unsigned count; /* 0: it does not matter */
    struct {
        uint8_t relation; /* enum term_relation */
        int64_t value;
    } bound[BOUNDS_MAX];
};

struct scenario_pulses {
    uint8_t motor;
    bool since_last;
    struct scenario_bounds count, forward, back;
};

struct scenario_step {
    const struct config_node *node; /* where it is in the file */
    const char *label;              /* NULL: none */
    uint8_t action;                 /* enum scenario_action */
    uint8_t unit;                   /* its number; 0: all */
    uint8_t flag;                   /* of the answer to a program */
    uint8_t answer;                 /* enum scenario_answer */
    uint64_t at;                    /* DEVICE_NEVER: when the step before is done */
    uint64_t within, not_before;    /* ticks */
    uint64_t time;                  /* ticks to let pass */
    const char *method;             /* of a command */
    json_t *json;                   /* a condition, or parameters of a command */
    json_t *result;                 /* what members of its result have to be; NULL: anything */
    struct scenario_bytes bytes, wanted;
    char *wrong;                    /* of a program: what a unit will refuse in it; NULL: nothing */
    struct scenario_pulses pulses;
};

struct scenario_stimulus {
    struct scenario_step step; /* step.at: its time, or DEVICE_NEVER */
    json_t *when;              /* NULL: none */
    uint64_t after;
};

#define SCENARIO_FILES_MAX 8u

struct scenario {
    struct config_tree *tree;
    const char *name;
    struct sim_config config;
    unsigned files;
    char *flash; /* its image at first; NULL: erased */
    char *file[SCENARIO_FILES_MAX]; /* texts that options of the device name */
    char *plant;             /* text of the plant; NULL: none */
    char *plant_name;        /* for messages */
    size_t plant_length;
    json_t *di;              /* inputs and levels; NULL: none */
    uint64_t timeout;
    bool allow_faults;
    bool count_pulses;       /* a step asks for them */
    const struct config_node *always_node;
    json_t *always;          /* list of conditions; NULL: none */
    size_t stimuli, steps;
    struct scenario_stimulus *stimulus;
    struct scenario_step *step;
};

/* What reading needs. */
struct scenario_reader {
    const char *name; /* of the file */
    struct scenario *scenario;
    const struct scenario_files *files;
    FILE *errors;
    struct sim *sim; /* one to try out on what is read; nothing of it is seen */
};

/* Read a step. Errors are reported. */
bool scenario_step_read(struct scenario_reader *reader, const struct config_node *node, struct scenario_step *step);
bool scenario_stimulus_read(struct scenario_reader *reader, const struct config_node *node, struct scenario_stimulus *stimulus);
void scenario_step_free(struct scenario_step *step);

/* Check a condition; `waits`: it is waited for, so it may ask for messages, which pass. Returns it as JSON, or NULL: reported. */
json_t *scenario_condition(struct scenario_reader *reader, const struct config_node *node, unsigned unit, bool waits);

/* Read a file that the scenario names, next to it. *path, where it is, and the text are to be freed; NULL: reported at `node`. */
char *scenario_file(struct scenario_reader *reader, const struct config_node *node, char **path, size_t *length);

/* Power up a line as the scenario has it, with its plant. Returns false if out of memory, or the plant is wrong, which is
 * reported. sim_end() is due in either case. */
bool scenario_power_up(const struct scenario *scenario, struct sim *sim, FILE *errors);

/* Set the inputs of all units at the beginning. Returns false: refused. */
bool scenario_begin_inputs(const struct scenario *scenario, struct sim *sim, struct refusal *refusal);

#endif
