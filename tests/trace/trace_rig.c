/* SPDX-License-Identifier: MIT */
#include "device/rkm04_device.h"
#include "trace_rig.h"

#include <check.h>
#include <stdlib.h>
#include <string.h>

static struct sim sim;
static struct trace_file *trace;
static FILE *out;
static char *text;
static size_t length;

void trace_rig_begin(const char *nodes, enum trace_format format)
{
    struct sim_config config = {.timed = false};
    ck_assert(node_list_read(&config.nodes, nodes));
    ck_assert(sim_begin(&sim, &config));
    trace_rig_begin_trace(format);
}

void trace_rig_begin_trace(enum trace_format format)
{
    out = open_memstream(&text, &length);
    ck_assert_ptr_nonnull(out);
    trace = trace_file_begin_on(&sim, out, format);
    ck_assert_ptr_nonnull(trace);
}

void trace_rig_end_trace(void)
{
    if (trace)
        ck_assert_int_eq(trace_file_end(trace), 0);
    trace = NULL;
    if (out)
        fclose(out);
    out = NULL;
    free(text);
    text = NULL;
}

void trace_rig_end(void)
{
    trace_rig_end_trace();
    sim_end(&sim);
    memset(&sim, 0, sizeof sim);
}

struct sim *trace_rig_sim(void)
{
    return &sim;
}

void trace_rig_set(unsigned number, char motor, const char *program)
{
    ck_assert_int_eq(rkm04_set_command(rkm04_of(sim_core(&sim, number)), motor, program, strlen(program), NULL), 0);
}

void happens(uint64_t tick, enum watch_phase phase, unsigned motor, enum watch_kind kind, int32_t value)
{
    struct watch_event event = {
        .tick = tick, .value = value, .kind = (uint8_t)kind, .unit = 1, .motor = (uint8_t)motor};
    sim_report(&sim, phase, &event);
}

const char *trace_rig_so_far(void)
{
    trace_file_flush(trace);
    return text;
}

const char *trace_rig_text(void)
{
    watch_deliver(&sim.watch, RKM04_NEVER);
    ck_assert_int_eq(trace_file_end(trace), 0);
    trace = NULL;
    fclose(out);
    out = NULL;
    return text;
}
