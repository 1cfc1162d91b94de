/* SPDX-License-Identifier: MIT */
/* exec_inputs.h: what `rkm04 exec` and `rkm04 plot` run: the arguments [M=]FILE and a stimulus file. All of it is read and
 * checked before anything is run or written. */
#ifndef RKM04_RUN_EXEC_INPUTS_H
#define RKM04_RUN_EXEC_INPUTS_H

#include <argp.h>
#include <stdbool.h>

#include "device/device.h"
#include "exec_run.h"
#include "stimulus.h"
#include "text/text.h"

/* A file of the command line. */
struct exec_file {
    const char *name; /* for messages: as given, "<stdin>" for "-" */
    struct program_text text;
};

/* A program text for a motor. */
struct exec_program {
    const char *argument; /* as given */
    unsigned motor;       /* 0: all */
    const char *path;
    struct exec_file file;
};

struct exec_inputs {
    const char *command;          /* for messages: "rkm04 exec" */
    struct exec_program *program; /* in the order of the command line */
    size_t programs;
    const char *stimulus;         /* path of the stimulus file; NULL: none */
    struct exec_file stimulus_file;
    struct stimuli stimuli;
    bool stdin_taken;
};

/* Room for as many programs as there are arguments. Returns false if out of memory; exec_inputs_free() is due in any case. */
bool exec_inputs_begin(struct exec_inputs *inputs, const char *command, int argc);

/* Take an argument [M=]FILE, the option --stimulus. */
void exec_inputs_argument(struct exec_inputs *inputs, const char *text);
void exec_inputs_stimulus(struct exec_inputs *inputs, const char *path);

/* At the end of the command line, when the device is known: which motors, which files. What is wrong ends the program by
 * argp_error(). */
void exec_inputs_complete(struct exec_inputs *inputs, const struct device_kind *device, struct argp_state *state);

/* Was neither given? */
bool exec_inputs_are_none(const struct exec_inputs *inputs);

/* Read all files and check the texts as a unit with these settings does. What is wrong is reported on stderr.
 * Returns false then. */
bool exec_inputs_read(struct exec_inputs *inputs, const struct device_kind *device, const struct device_config *config);

/* Store the programs. What is too long is reported on stderr. */
void exec_inputs_store(const struct exec_inputs *inputs, struct exec_run *run);

void exec_inputs_free(struct exec_inputs *inputs);

#endif
