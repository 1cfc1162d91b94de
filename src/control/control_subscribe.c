/* SPDX-License-Identifier: MIT */
/* subscribe, collected and unsubscribe: what happens on a line, as notifications, or what cells were until the client asks. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "trace/trace.h"

#define HEAD "{\"jsonrpc\":\"2.0\",\"method\":\"event\",\"params\":{\"subscription\":%u,"
#define TAIL "}}\n"

/* What a cell was since the client has asked. */
struct collected_cell {
    uint64_t changes; /* events; 0: it was as it is */
    int64_t value, least, greatest; /* the last one, of all of them */
};

struct subscription {
    struct control_client *client;
    struct bus *bus;
    unsigned number;
    struct watcher watcher;
    struct event_filter filter;
    struct collected_cell *collected; /* by the place in struct watch, WATCH_CELLS_MAX of them; NULL: events are sent */
    size_t head_length;
    char head[96];
    struct subscription *next; /* of the same client */
};

static void collect(struct collected_cell *cell, int64_t value)
{
    cell->least = cell->changes == 0 || value < cell->least ? value : cell->least;
    cell->greatest = cell->changes == 0 || value > cell->greatest ? value : cell->greatest;
    cell->value = value;
    cell->changes++;
}

static void on_event(void *context, const struct watch_event *event)
{
    struct subscription *subscription = context;
    if (!event_filter_passes(&subscription->filter, &subscription->bus->sim, &subscription->watcher, event))
        return;
    if (subscription->collected) {
        collect(&subscription->collected[event->number], event->cell);
        return;
    }
    size_t room = subscription->head_length + event_json_room(event) + sizeof TAIL;
    char *at = connection_begin_event(&subscription->client->connection, room, event->tick);
    if (!at)
        return;
    memcpy(at, subscription->head, subscription->head_length);
    at = event_json(at + subscription->head_length, &subscription->bus->sim, event);
    memcpy(at, TAIL, sizeof TAIL - 1);
    connection_end_event(&subscription->client->connection, at + sizeof TAIL - 1);
}

/* ---- The methods ---------------------------------------------------------------------------------------------------- */

/* `collect`: true: no events are sent. Returns false: refused. */
static bool read_collect(struct subscription *new, const json_t *params, struct refusal *refusal)
{
    const json_t *collect = json_object_get(params, "collect");
    if (collect && !json_is_boolean(collect))
        return refuse(refusal, REFUSED_PARAMS, "collect: expected true or false") != NULL;
    if (!json_is_true(collect))
        return true;
    if (new->filter.kinds != WATCH_BIT(WATCH_CELL))
        return refuse(refusal, REFUSED_PARAMS, "collect: expected cells, and no kinds") != NULL;
    new->collected = calloc(WATCH_CELLS_MAX, sizeof *new->collected);
    return new->collected != NULL;
}

json_t *control_subscribe(struct control_context *context, struct refusal *refusal)
{
    struct control_client *client = context->client;
    struct sim *sim = bus_sim(context->bus);
    struct subscription new = {.client = client, .bus = context->bus};
    unsigned count = 0;
    if (!event_filter_read(&new.filter, sim, context->request->params, refusal))
        return NULL;
    for (const struct subscription *other = client->subscriptions; other; other = other->next)
        count++;
    if (count == CONTROL_SUBSCRIPTIONS)
        return refuse(refusal, REFUSED_STATE, "too many subscriptions: expected at most %u per client",
                      CONTROL_SUBSCRIPTIONS);
    if (!read_collect(&new, context->request->params, refusal))
        return NULL;
    struct subscription *subscription = malloc(sizeof *subscription);
    if (!subscription) {
        free(new.collected);
        return NULL;
    }
    new.number = client->subscribed + 1u;
    new.head_length = (size_t)snprintf(new.head, sizeof new.head, HEAD, new.number);
    new.next = client->subscriptions;
    *subscription = new;
    subscription->watcher.on_event = on_event;
    subscription->watcher.context = subscription;
    json_t *answer = event_watch(sim, &subscription->watcher, &new.filter, new.number, context->request->params, refusal);
    if (!answer) {
        free(subscription->collected);
        free(subscription);
        return NULL;
    }
    client->subscriptions = subscription;
    client->subscribed = new.number;
    /* Answered before the line looks again: no event comes before the number of its subscription is known. */
    context->later = true;
    control_answer(client, context->request->id, answer);
    bus_changed(context->bus); /* it advances the units more often while there are watchers */
    return NULL;
}

static void end_subscription(struct subscription **at)
{
    struct subscription *subscription = *at;
    *at = subscription->next;
    sim_unwatch(&subscription->bus->sim, &subscription->watcher);
    free(subscription->collected);
    free(subscription);
}

/* The place of the subscription that the request names, which has been given all that has happened so far; NULL: refused. */
static struct subscription **find_subscription(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"subscription", NULL};
    const json_t *params = context->request->params;
    int64_t number;
    if (!params_known(params, names, refusal) || !param_integer(params, "subscription", 1, INT32_MAX, &number, refusal))
        return NULL;
    for (struct subscription **at = &context->client->subscriptions; *at; at = &(*at)->next)
        if ((*at)->number == number) {
            bus_sim((*at)->bus);
            return at;
        }
    refuse(refusal, REFUSED_PARAMS, "subscription: this connection has no subscription %lld", (long long)number);
    return NULL;
}

json_t *control_collected(struct control_context *context, struct refusal *refusal)
{
    struct subscription **at = find_subscription(context, refusal), *subscription = at ? *at : NULL;
    if (!subscription)
        return NULL;
    if (!subscription->collected)
        return refuse(refusal, REFUSED_PARAMS, "subscription: %u sends events: expected one with `collect'",
                      subscription->number);
    const struct watch *watch = &subscription->bus->sim.watch;
    json_t *cells = json_object();
    for (unsigned place = 0; place < watch->cell_count; place++) {
        const struct collected_cell *cell = &subscription->collected[place];
        if (watch->cells[place].owner == &subscription->watcher && cell->changes > 0)
            json_object_set_new(cells, watch->cells[place].name,
                                json_pack("{s:I, s:I, s:I, s:I}", "value", (json_int_t)cell->value, "changes",
                                          (json_int_t)cell->changes, "least", (json_int_t)cell->least, "greatest",
                                          (json_int_t)cell->greatest));
    }
    memset(subscription->collected, 0, WATCH_CELLS_MAX * sizeof *subscription->collected);
    return json_pack("{s:I, s:o}", "t_us", (json_int_t)sim_now(&subscription->bus->sim), "cells", cells);
}

json_t *control_unsubscribe(struct control_context *context, struct refusal *refusal)
{
    struct subscription **at = find_subscription(context, refusal);
    if (!at)
        return NULL;
    const json_int_t now = (json_int_t)sim_now(&(*at)->bus->sim);
    end_subscription(at);
    return json_pack("{s:I}", "t_us", now);
}

void control_subscribe_remove_client(struct control_client *client)
{
    while (client->subscriptions)
        end_subscription(&client->subscriptions);
}
