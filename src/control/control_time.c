/* SPDX-License-Identifier: MIT */
/* wait and advance: answers that come when something has come true.
 *
 * An `advance` of a client that subscribes is done in slices, and continues only when the client has read what it led to: nothing
 * is lost however fast time runs. */
#include <stdlib.h>

#include "control_inside.h"

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
    struct exchange exchange; /* whose answer it is; all zero: none, the time is */
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
    control_schedule_lines(client->control); /* those who wanted to move the same clock, and what follows this call */
}

static void free_call(struct control_call *call)
{
    condition_free(call->waiter.condition);
    exchange_drop(&call->exchange);
    json_decref(call->id);
    free(call);
}

static void finish_call(struct control_call *call, bool holds)
{
    struct refusal refusal;
    remove_call(call);
    const bool is_exchange = call->exchange.get != NULL;
    json_t *answer = is_exchange ? exchange_answer(&call->exchange, &call->bus->sim, &refusal)
                                 : until_answer(&call->bus->sim, call->waiter.condition, holds);
    if (answer || !is_exchange)
        control_answer(call->client, call->id, answer);
    else
        control_refuse(call->client, call->id, &refusal);
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

/* Let time run: to the limit, or to the end of a slice. Returns false if the clock is no longer stopped. */
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

static struct control_call *new_call(struct control_context *context, struct until until, bool moves)
{
    struct control_call *call = calloc(1, sizeof *call);
    if (!call)
        return condition_free(until.condition), NULL;
    struct control_client *client = context->client;
    call->client = client;
    call->bus = context->bus;
    call->id = json_incref((json_t *)context->request->id);
    call->limit = until.end;
    call->moves = moves;
    call->waiter = (struct bus_waiter){.condition = until.condition, .limit = until.end, .done = on_done, .context = call};
    call->next = client->calls;
    client->calls = call;
    if (moves)
        client->advance = call;
    else
        client->waits++;
    if (until.condition)
        condition_arm(until.condition);
    return call;
}

json_t *control_wait(struct control_context *context, struct refusal *refusal)
{
    struct until until;
    if (context->client->waits == CONTROL_WAITS)
        return refuse(refusal, REFUSED_STATE, "too many waits: expected at most %u per client", CONTROL_WAITS);
    if (!until_read_wait(&until, bus_sim(context->bus), context->request->params, refusal))
        return NULL;
    struct control_call *call = new_call(context, until, false);
    if (!call)
        return NULL;
    context->later = true;
    bus_wait(context->bus, &call->waiter);
    return NULL;
}

bool control_time_is_moved(const struct control *control, const struct bus *bus)
{
    for (const struct control_client *client = control->clients; client; client = client->next)
        if (client->advance && client->advance->bus == bus)
            return true;
    return bus->time.advancing != NULL;
}

static bool is_stepped(const struct control_context *context, struct refusal *refusal)
{
    if (!bus_is_stepped(context->bus))
        refuse(refusal, REFUSED_STATE, "the clock runs by itself (%s): set it to stepped with clock, or use wait",
               context->bus->time.clock_text);
    return bus_is_stepped(context->bus);
}

json_t *control_advance(struct control_context *context, struct refusal *refusal)
{
    struct until until;
    if (!is_stepped(context, refusal))
        return NULL;
    context->again = control_time_is_moved(context->client->control, context->bus);
    if (context->again || !until_read_advance(&until, bus_sim(context->bus), context->request->params, refusal))
        return NULL;
    struct control_call *call = new_call(context, until, true);
    if (!call)
        return NULL;
    context->later = true;
    if (!continue_call(call))
        finish_call(call, false);
    return NULL;
}

/* ---- The exchange of a device (condition.h) ---------------------------------------------------------------------------- */

json_t *control_exchange(struct control_context *context, struct refusal *refusal)
{
    struct sim *sim = bus_sim(context->bus);
    struct exchange exchange;
    if (!is_stepped(context, refusal))
        return NULL;
    context->again = control_time_is_moved(context->client->control, context->bus);
    if (context->again || !exchange_begin(&exchange, sim, context->request->params, refusal))
        return NULL;
    struct control_call *call = new_call(context, (struct until){NULL, exchange.end}, true);
    if (!call) {
        exchange_drop(&exchange);
        return NULL;
    }
    bus_changed(context->bus);
    call->exchange = exchange;
    context->later = true;
    if (exchange.end <= sim_now(sim) || !continue_call(call))
        finish_call(call, false);
    return NULL;
}
