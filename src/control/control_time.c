/* SPDX-License-Identifier: MIT */
/* wait and advance: answers that come when something has come true.
 *
 * An `advance` of a client that subscribes is done in slices, and goes on only when the client has read what it led to: nothing
 * is lost however fast time runs. */
#include <inttypes.h>
#include <stdlib.h>

#include "control_inside.h"

#define HOUR UINT64_C(3600000000) /* ticks */
#define SLICE 50000u              /* ticks: at 16 000 steps/s and motor some 400 KB of events */

/* A request that is not yet answered. */
struct control_call {
    struct control_client *client;
    struct bus *bus;
    json_t *id;            /* NULL: it is not to be answered */
    struct bus_waiter waiter;
    uint64_t limit;        /* tick; waiter.limit may be a slice on the way to it */
    bool moves;            /* it is an `advance` */
    bool pausing;          /* between two slices, until the client has read */
    struct control_call *next; /* of the same client */
};

/* ---- The end of a call ---------------------------------------------------------------------------------------------- */

static void remove_call(struct control_call *call)
{
    struct control_client *client = call->client;
    for (struct control_call **at = &client->calls; *at; at = &(*at)->next) {
        if (*at == call) {
            *at = call->next;
            break;
        }
    }
    if (call->moves)
        client->advance = NULL;
    else
        client->waits--;
    control_schedule_lines(client->control); /* those who wanted to move the same clock, and what stands behind this call */
}

static void free_call(struct control_call *call)
{
    condition_free(call->waiter.condition);
    json_decref(call->id);
    free(call);
}

static json_t *call_result(const struct control_call *call, bool holds)
{
    json_t *result = json_pack("{s:I}", "t_us", (json_int_t)sim_now(&call->bus->sim));
    struct condition *condition = call->waiter.condition;
    if (!condition)
        return result;
    json_object_set_new(result, "holds", json_boolean(holds));
    if (!holds) {
        char *text = condition_text(condition);
        json_object_set_new(result, "text", json_string(text ? text : ""));
        free(text);
    }
    return result;
}

static void finish_call(struct control_call *call, bool holds)
{
    remove_call(call);
    control_answer(call->client, call->id, call_result(call, holds));
    free_call(call);
}

void control_time_remove_client(struct control_client *client)
{
    while (client->calls) {
        struct control_call *call = client->calls;
        if (!call->pausing)
            bus_cancel_wait(call->bus, &call->waiter);
        remove_call(call);
        free_call(call);
    }
}

/* ---- On the way ----------------------------------------------------------------------------------------------------- */

/* The end of a slice that begins now. A while in which nothing happens does not count. */
static uint64_t slice_end(const struct sim *sim)
{
    uint64_t event = sim_next_event(sim), byte = sim_due(sim);
    uint64_t from = event < byte ? event : byte;
    if (from < sim_now(sim))
        from = sim_now(sim);
    return from > DEVICE_NEVER - SLICE ? DEVICE_NEVER : from + SLICE;
}

/* Let time run: to the limit, or to the end of a slice. Returns false if the clock no longer stands. */
static bool continue_call(struct control_call *call)
{
    uint64_t end = call->client->subscriptions ? slice_end(&call->bus->sim) : DEVICE_NEVER;
    call->waiter.limit = end < call->limit ? end : call->limit;
    call->pausing = false;
    return bus_advance(call->bus, &call->waiter);
}

static void on_done(struct bus_waiter *waiter, bool holds)
{
    struct control_call *call = waiter->context;
    if (holds || sim_now(&call->bus->sim) >= call->limit) {
        finish_call(call, holds);
        return;
    }
    call->pausing = true;
    if (connection_unread(&call->client->connection) <= CONNECTION_QUEUE_SMALL && !continue_call(call))
        finish_call(call, false);
}

void control_time_continue(struct control_client *client)
{
    struct control_call *call = client->advance;
    if (!call || !call->pausing || connection_unread(&client->connection) > CONNECTION_QUEUE_SMALL)
        return;
    control_schedule_lines(client->control); /* what this leads to is sent in the next turn */
    if (!continue_call(call))
        finish_call(call, false);
}

/* ---- The methods ---------------------------------------------------------------------------------------------------- */

static struct control_call *new_call(struct control_context *context, struct condition *condition, uint64_t limit, bool moves)
{
    struct control_call *call = calloc(1, sizeof *call);
    if (!call)
        return NULL;
    struct control_client *client = context->client;
    uint64_t now = sim_now(&context->bus->sim);
    call->client = client;
    call->bus = context->bus;
    call->id = json_incref((json_t *)context->request->id);
    call->limit = limit > SIM_TIME_MAX - now ? SIM_TIME_MAX : now + limit;
    call->moves = moves;
    call->waiter = (struct bus_waiter){.condition = condition, .limit = call->limit, .done = on_done, .context = call};
    call->next = client->calls;
    client->calls = call;
    if (moves)
        client->advance = call;
    else
        client->waits++;
    if (condition)
        condition_arm(condition);
    return call;
}

static struct condition *read_until(struct control_context *context, struct refusal *refusal)
{
    const json_t *until = json_object_get(context->request->params, "until");
    if (!until) {
        refuse(refusal, REFUSED_PARAMS, "until: missing: expected a condition, as in {\"motor\": 1, \"state\": \"idle\"}");
        return NULL;
    }
    return condition_read(bus_sim(context->bus), until, refusal);
}

json_t *control_wait(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"until", "limit", NULL};
    const json_t *params = context->request->params;
    uint64_t limit = DEVICE_NEVER;
    if (!params_known(params, names, refusal) ||
        (json_object_get(params, "limit") && !param_time(params, "limit", 0, &limit, refusal)))
        return NULL;
    if (context->client->waits == CONTROL_WAITS)
        return refuse(refusal, REFUSED_STATE, "too many waits: expected at most %u per client", CONTROL_WAITS);
    struct condition *condition = read_until(context, refusal);
    struct control_call *call = condition ? new_call(context, condition, limit, false) : NULL;
    if (!call) {
        condition_free(condition);
        return NULL;
    }
    context->later = true;
    bus_wait(context->bus, &call->waiter);
    return NULL;
}

/* What `advance` is to do: either of `ticks`, `until`. */
static bool read_advance(struct control_context *context, struct condition **condition, uint64_t *ticks, struct refusal *refusal)
{
    static const char *const names[] = {"ticks", "until", "limit", NULL};
    const json_t *params = context->request->params;
    bool until = json_object_get(params, "until") != NULL, given = json_object_get(params, "ticks") != NULL;
    if (!params_known(params, names, refusal))
        return false;
    if (until == given || (given && json_object_get(params, "limit"))) {
        refuse(refusal, REFUSED_PARAMS, "expected either ticks, a time, or until, a condition, with limit, a time");
        return false;
    }
    if (given)
        return param_time(params, "ticks", DEVICE_NEVER, ticks, refusal);
    if (!param_time(params, "limit", HOUR, ticks, refusal))
        return false;
    *condition = read_until(context, refusal);
    return *condition != NULL;
}

bool control_time_is_moved(const struct control *control, const struct bus *bus)
{
    for (const struct control_client *client = control->clients; client; client = client->next)
        if (client->advance && client->advance->bus == bus)
            return true;
    return bus->time.advancing != NULL;
}

json_t *control_advance(struct control_context *context, struct refusal *refusal)
{
    struct condition *condition = NULL;
    uint64_t ticks;
    if (!bus_is_stepped(context->bus))
        return refuse(refusal, REFUSED_STATE, "the clock runs by itself (%s): set it to stepped with clock, or use wait",
                      context->bus->time.clock_text);
    context->again = control_time_is_moved(context->client->control, context->bus);
    if (context->again || !read_advance(context, &condition, &ticks, refusal))
        return NULL;
    uint64_t left = SIM_TIME_MAX - sim_now(&context->bus->sim);
    if (left == 0 || (!condition && ticks > left)) {
        condition_free(condition);
        return refuse(refusal, REFUSED_STATE, "virtual time ends at %" PRIu64 " us: expected at most %" PRIu64 " us more",
                      SIM_TIME_MAX, left);
    }
    struct control_call *call = new_call(context, condition, ticks, true);
    if (!call) {
        condition_free(condition);
        return NULL;
    }
    context->later = true;
    if (!continue_call(call))
        finish_call(call, false);
    return NULL;
}
