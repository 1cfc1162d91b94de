/* exec_run.h: a unit in virtual time, from power-up to the end of the run. */
#ifndef RKM04_HOST_EXEC_RUN_H
#define RKM04_HOST_EXEC_RUN_H

#include <stdbool.h>
#include <stdint.h>

#include <rkm04/unit.h>

#include "stimulus.h"
#include "trace.h"

enum exec_end {
    EXEC_DONE,        /* nothing is due any more: every motor idle, stopped, or waiting for what can never come */
    EXEC_UNTIL,       /* the tick of `until` has been done */
    EXEC_INTERRUPTED, /* by exec_run_interrupt() */
    EXEC_NO_TRACE     /* the trace could not be written */
};

struct exec_run {
    struct rkm04_unit unit;
    const struct stimuli *stimuli;
    const char *stimulus_name; /* for messages */
    struct trace *trace;       /* NULL: none */
    uint64_t until;            /* last tick to be done; RKM04_NEVER: no limit */
    bool progress;             /* show a line on stderr while it takes long */
    /* Called with what the unit answered to a message of the stimulus; length 0: nothing. */
    void (*answered)(void *context, uint64_t tick, const struct stimulus *stimulus, const uint8_t *answer, size_t length);
    void *context;

    uint64_t reached; /* out: the last tick in which something was done */
    bool delivering;  /* inside: rows of the trace belong to what comes from outside */
    size_t next;      /* inside: stimuli delivered */
    uint8_t flash[RKM04_FLASH_BLOCKS][RKM04_FLASH_BLOCK_SIZE]; /* lives as long as the run */
};

/* Power up at tick 0 with empty flash. All members of the first part must be set. */
void exec_run_begin(struct exec_run *run);

/* Store a text for motor '0'..'4' at the present tick. Returns the flag of P1. */
int exec_run_set(struct exec_run *run, char motor, const void *text, size_t length);

/* Run to the end. */
enum exec_end exec_run(struct exec_run *run);

/* End the run soon; may be called from a signal handler. */
void exec_run_interrupt(int signal_number);

#endif
