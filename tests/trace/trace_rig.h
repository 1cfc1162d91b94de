/* SPDX-License-Identifier: MIT */
/* trace_rig.h: a line whose trace goes to memory. */
#ifndef TRACE_RIG_H
#define TRACE_RIG_H

#include "trace/trace_file.h"

/* A line with these units ("1", "3,12,3"), bytes take no time, and a trace from tick 0. */
void trace_rig_begin(const char *nodes, enum trace_format format);
void trace_rig_end(void);

/* End the trace; begin another one now. */
void trace_rig_end_trace(void);
void trace_rig_begin_trace(enum trace_format format);

struct sim *trace_rig_sim(void);

/* A program for motor '0'..'4' of unit `number`. */
void trace_rig_set(unsigned number, char motor, const char *text);

/* Something happens to unit 1, or so it is reported to the watchers. */
void happens(uint64_t tick, enum watch_phase phase, unsigned motor, enum watch_kind kind, int32_t value);

/* What has been written up to now. */
const char *trace_rig_so_far(void);

/* Let everything be reported, end the trace, and return all of it. */
const char *trace_rig_text(void);

#endif
