/* SPDX-License-Identifier: MIT */
/* trace.start and trace.stop: files begun and ended while the emulator runs. */
#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "line/line.h"
#include "trace/trace.h"

/* End a file. Returns 0 or the errno of the first failure. */
static int end_trace(struct control_trace *trace)
{
    int error = trace->trace ? trace_file_end(trace->trace) : wire_file_end(trace->wire);
    free(trace->path);
    *trace = (struct control_trace){0};
    return error;
}

void control_trace_end(struct control *control)
{
    for (unsigned i = 0; i < CONTROL_TRACES; i++) {
        struct control_trace *trace = &control->traces[i];
        if (trace->number == 0)
            continue;
        bus_sim(control->buses[trace->line]);
        char *path = strdup(trace->path);
        int error = end_trace(trace);
        if (error != 0)
            log_error("cannot write %s: %s", path ? path : "a trace", strerror(error));
        free(path);
    }
}

/* ---- Begin ---------------------------------------------------------------------------------------------------------- */

static struct control_trace *find_free_trace(struct control *control)
{
    for (unsigned i = 0; i < CONTROL_TRACES; i++)
        if (control->traces[i].number == 0)
            return &control->traces[i];
    return NULL;
}

static bool begin_trace(struct control_trace *trace, struct sim *sim, const char *path, unsigned flags,
                  struct refusal *refusal)
{
    char *error = NULL;
    if (trace_file_named(path))
        trace->trace = trace_file_begin(sim, path, flags, &error);
    else
        trace->wire = wire_file_begin(sim, path, flags, &error);
    if (trace->trace || trace->wire)
        return true;
    if (error)
        refuse(refusal, REFUSED_STATE, "%s", error);
    free(error);
    return false;
}

json_t *control_trace_start(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"file", "force", NULL};
    struct control *control = context->client->control;
    const json_t *params = context->request->params;
    const char *path = params_known(params, names, refusal) ? param_string(params, "file", refusal) : NULL;
    bool force;
    if (!path || !param_flag(params, "force", &force, refusal))
        return NULL;
    if (!trace_file_named(path) && !wire_file_named(path))
        return refuse(refusal, REFUSED_PARAMS, "file: expected %s, or %s", TRACE_FILE_EXPECTED, WIRE_FILE_EXPECTED);
    struct control_trace *trace = find_free_trace(control);
    if (!trace)
        return refuse(refusal, REFUSED_STATE, "too many traces: expected at most %u at a time", CONTROL_TRACES);
    char *copy = strdup(path);
    struct sim *sim = bus_sim(context->bus);
    if (!copy || !begin_trace(trace, sim, path, OUTPUT_REQUESTED | (force ? OUTPUT_FORCE : 0u), refusal)) {
        free(copy);
        return NULL;
    }
    trace->number = ++control->last_trace;
    trace->line = context->request->line;
    trace->path = copy;
    bus_changed(context->bus); /* it looks more often while somebody watches */
    return json_pack("{s:I, s:i, s:s}", "t_us", (json_int_t)sim_now(sim), "trace", (int)trace->number, "file", trace->path);
}

/* ---- End ------------------------------------------------------------------------------------------------------------ */

/* The trace that is meant: by its number, or the only one. */
static struct control_trace *find_trace(struct control *control, const json_t *params, struct refusal *refusal)
{
    int64_t number;
    struct control_trace *found = NULL;
    unsigned count = 0;
    if (!param_integer_or(params, "trace", 1, INT32_MAX, 0, &number, refusal))
        return NULL;
    for (unsigned i = 0; i < CONTROL_TRACES; i++) {
        struct control_trace *trace = &control->traces[i];
        if (trace->number != 0 && (number == 0 || trace->number == number)) {
            found = trace;
            count++;
        }
    }
    if (count == 1)
        return found;
    if (number != 0)
        return refuse(refusal, REFUSED_PARAMS, "trace: there is no trace %lld", (long long)number), NULL;
    return refuse(refusal, REFUSED_PARAMS, count == 0 ? "there is no trace" : "trace: missing: several traces are running"), NULL;
}

json_t *control_trace_stop(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"trace", NULL};
    struct control *control = context->client->control;
    const json_t *params = context->request->params;
    struct control_trace *trace = params_known(params, names, refusal) ? find_trace(control, params, refusal) : NULL;
    if (!trace)
        return NULL;
    struct sim *sim = bus_sim(control->buses[trace->line]);
    json_t *result = json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(sim), "file", trace->path);
    int error = end_trace(trace);
    if (error == 0)
        return result;
    refuse(refusal, REFUSED_STATE, "cannot write %.200s: %s", json_string_value(json_object_get(result, "file")),
           strerror(error));
    json_decref(result);
    return NULL;
}
