/* trace.h: what a unit did, as CSV in the order of time.
 *
 * Header `t_us,source,event,value`; a row has the tick, `unit` or `m1`..`m4`, what happened, and its value.
 *
 * A unit reports the happenings of one motor in order, those of different motors only within a tick of a slot. The trace
 * keeps the rows of the present slot and puts them in order: a few dozen, whatever the length of the run. */
#ifndef RKM04_HOST_TRACE_H
#define RKM04_HOST_TRACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#define TRACE_ROOM 1024 /* rows kept; four motors make about 100 a slot */

enum trace_event {
    TRACE_STEP,        /* value: position after the pulse */
    TRACE_DIRECTION,   /* 1 forward, -1 back */
    TRACE_MOTION,      /* 1 begin, 0 end */
    TRACE_LED,         /* enum rkm04_led */
    TRACE_COMMAND,     /* place in memory, 0 when the motor went idle */
    TRACE_INPUTS,      /* the unit's DI, DO, VAR: masks, the first one in bit 0 */
    TRACE_OUTPUTS,
    TRACE_VARIABLES
};

/* Order of rows within a tick (K2). */
enum trace_phase {
    TRACE_DELIVERED, /* what the host delivered, and what it led to at once */
    TRACE_PULSES,
    TRACE_TURNS      /* ends of motions, and the motors' turns */
};

struct trace_row {
    uint64_t tick;
    int32_t value;
    uint8_t motor; /* 1..4, 0 for the unit */
    uint8_t event; /* enum trace_event */
    uint8_t phase; /* enum trace_phase */
};

struct trace {
    FILE *out;
    bool failed; /* writing failed: nothing more is written */
    int error;   /* errno of the first failure */
    size_t count;
    struct trace_row row[TRACE_ROOM]; /* in order */
};

/* Begin a trace on `out` with the header. `out` stays the caller's. */
void trace_begin(struct trace *trace, FILE *out);

/* Add a row, in order behind those of the same tick and phase. With no room left the oldest row is written. */
void trace_add(struct trace *trace, uint64_t tick, enum trace_phase phase, unsigned motor, enum trace_event event,
               int32_t value);

/* Write all rows before `tick`: nothing earlier will be added. */
void trace_write_before(struct trace *trace, uint64_t tick);

/* Write all that is left and flush. Returns 0, or the errno of the first failure of the whole trace. */
int trace_finish(struct trace *trace);

#endif
