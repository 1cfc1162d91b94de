/* SPDX-License-Identifier: MIT */
#include "trace_set.h"

#include <stdlib.h>
#include <string.h>

#include "trace_file.h"
#include "wire_file.h"

static struct trace_entry *free_place(struct trace_set *set)
{
    for (unsigned i = 0; i < TRACE_SET_MAX; i++)
        if (set->entry[i].number == 0)
            return &set->entry[i];
    return NULL;
}

static bool begin(struct trace_entry *trace, struct sim *sim, const char *path, unsigned flags,
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

json_t *trace_set_start(struct trace_set *set, struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"file", "force", NULL};
    const char *path = params_known(params, names, refusal) ? param_string(params, "file", refusal) : NULL;
    bool force;
    if (!path || !param_flag(params, "force", &force, refusal))
        return NULL;
    if (!trace_file_named(path) && !wire_file_named(path))
        return refuse(refusal, REFUSED_PARAMS, "file: expected %s, or %s", TRACE_FILE_EXPECTED, WIRE_FILE_EXPECTED);
    struct trace_entry *entry = free_place(set);
    if (!entry)
        return refuse(refusal, REFUSED_STATE, "too many traces: expected at most %u at a time", TRACE_SET_MAX);
    char *copy = strdup(path);
    if (!copy || !begin(entry, sim, path, OUTPUT_REQUESTED | (force ? OUTPUT_FORCE : 0u), refusal)) {
        free(copy);
        return NULL;
    }
    entry->number = ++set->last;
    entry->sim = sim;
    entry->path = copy;
    return json_pack("{s:I, s:i, s:s}", "t_us", (json_int_t)sim_now(sim), "trace", (int)entry->number, "file", copy);
}

struct trace_entry *trace_set_find(struct trace_set *set, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"trace", NULL};
    int64_t number;
    struct trace_entry *found = NULL;
    unsigned count = 0;
    if (!params_known(params, names, refusal) || !param_integer_or(params, "trace", 1, INT32_MAX, 0, &number, refusal))
        return NULL;
    for (unsigned i = 0; i < TRACE_SET_MAX; i++) {
        struct trace_entry *entry = &set->entry[i];
        if (entry->number != 0 && (number == 0 || entry->number == number)) {
            found = entry;
            count++;
        }
    }
    if (count == 1)
        return found;
    if (number != 0)
        return refuse(refusal, REFUSED_PARAMS, "trace: there is no trace %lld", (long long)number), NULL;
    return refuse(refusal, REFUSED_PARAMS, count == 0 ? "there is no trace" : "trace: missing: several traces are running"), NULL;
}

json_t *trace_set_stop(struct trace_entry *entry, struct refusal *refusal)
{
    json_t *result = json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(entry->sim), "file", entry->path);
    int error = entry->trace ? trace_file_end(entry->trace) : wire_file_end(entry->wire);
    if (error != 0)
        refuse(refusal, REFUSED_STATE, "cannot write %.200s: %s", entry->path, strerror(error));
    free(entry->path);
    *entry = (struct trace_entry){0};
    if (error == 0)
        return result;
    json_decref(result);
    return NULL;
}
