/* SPDX-License-Identifier: MIT */
/* trace.start and trace.stop: files begun and ended while the emulator runs. */
#include "control_inside.h"
#include "line/line.h"

/* Its bus, brought up to the present. */
static void bring_up(struct control *control, const struct trace_entry *entry)
{
    for (unsigned line = 0; line < control->lines; line++)
        if (&control->buses[line]->sim == entry->sim)
            bus_sim(control->buses[line]);
}

void control_trace_end(struct control *control)
{
    for (unsigned i = 0; i < TRACE_SET_MAX; i++) {
        struct trace_entry *entry = &control->traces.entry[i];
        struct refusal refusal;
        if (entry->number == 0)
            continue;
        bring_up(control, entry);
        json_t *result = trace_set_stop(entry, &refusal);
        if (!result)
            log_error("%s", refusal.text);
        json_decref(result);
    }
}

json_t *control_trace_start(struct control_context *context, struct refusal *refusal)
{
    struct control *control = context->client->control;
    json_t *result = trace_set_start(&control->traces, bus_sim(context->bus), context->request->params, refusal);
    if (result)
        bus_changed(context->bus); /* it advances the units more often while there are watchers */
    return result;
}

json_t *control_trace_stop(struct control_context *context, struct refusal *refusal)
{
    struct control *control = context->client->control;
    struct trace_entry *entry = trace_set_find(&control->traces, context->request->params, refusal);
    if (!entry)
        return NULL;
    bring_up(control, entry);
    return trace_set_stop(entry, refusal);
}
