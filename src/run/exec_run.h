/* SPDX-License-Identifier: MIT */
/* exec_run.h: a line with one unit in virtual time (sim.h), from power-up to the end of the run. */
#ifndef RKM04_RUN_EXEC_RUN_H
#define RKM04_RUN_EXEC_RUN_H

#include <stdbool.h>
#include <stdint.h>

#include "line/line.h"
#include "sim/sim.h"
#include "stimulus.h"
#include "trace/trace.h"

enum exec_end {
    EXEC_DONE,        /* nothing is due any more: every motor idle, stopped, or waiting for what can never come */
    EXEC_UNTIL,       /* the tick of `until` has been done */
    EXEC_ENDLESS,     /* there is no `until`, and the state has repeated: it would continue without end */
    EXEC_INTERRUPTED, /* by exec_run_interrupt() */
    EXEC_NO_TRACE     /* the trace could not be written */
};

struct exec_run {
    struct sim sim;
    const struct stimuli *stimuli;
    const char *stimulus_name;      /* for messages */
    const struct trace_file *trace; /* the run ends when it fails; NULL: none */
    uint64_t until;                 /* last tick to be done; DEVICE_NEVER: no limit */
    const struct device_kind *device; /* of the unit */
    struct device_config config;    /* of the unit */
    const char *flash_path;         /* file of its flash; NULL: memory, erased at first */
    bool progress;                  /* show a line on stderr while it takes long */
    /* Called with what the unit answered to a message of the stimulus; length 0: nothing. */
    void (*answered)(void *context, uint64_t tick, const struct stimulus *stimulus, const uint8_t *answer, size_t length);
    void (*advanced)(void *context); /* called after each advance; NULL: none */
    void *context;

    uint64_t period;  /* out, EXEC_ENDLESS: the state repeats after so many ticks */
    uint64_t reached; /* out: the last tick in which something was done */
    bool refused;     /* out: the device has refused a text */
    size_t next;      /* inside: stimuli delivered */
    bool open;        /* inside: there is no `until` */
    void *repeat;     /* inside: of device_kind.find_repeat */
    struct flash_file flash; /* inside: with `flash_path` */
};

/* Power up at tick 0. *run must be zero; the members of the first part must be set by exec_run(). Returns false if out of memory,
 * or if there is no flash file (reported); exec_run_end() is due in either case. */
bool exec_run_begin(struct exec_run *run);
void exec_run_end(struct exec_run *run);

/* A regular end: what the unit keeps is stored. Returns false if its file could not be written (reported). */
bool exec_run_store(struct exec_run *run);

/* The unit. */
struct device_unit *exec_run_unit(struct exec_run *run);

/* Does a motor continue of itself: it moves, or time will bring its next command? */
bool exec_run_is_running(struct exec_run *run);

/* Hand a text over to a motor from 1, or 0 for all, at the present tick. What is wrong is reported on stderr, with `place` in
 * front. Returns false if the device refuses it; a text that only fills its memory is taken. */
bool exec_run_set(struct exec_run *run, unsigned motor, const void *text, size_t length, const char *place);

/* Run to the end. */
enum exec_end exec_run(struct exec_run *run);

/* End the run soon; may be called from a signal handler. */
void exec_run_interrupt(int signal_number);

#endif
