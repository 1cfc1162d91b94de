/* SPDX-License-Identifier: MIT */
/* subscribe and unsubscribe: what happens on a line, as notifications. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "trace/trace.h"

#define HEAD "{\"jsonrpc\":\"2.0\",\"method\":\"event\",\"params\":{\"subscription\":%u,"
#define TAIL "}}\n"

struct subscription {
    struct control_client *client;
    struct bus *bus;
    unsigned number;
    struct watcher watcher;
    struct event_filter filter;
    size_t head_length;
    char head[96];
    struct subscription *next; /* of the same client */
};

static void on_event(void *context, const struct watch_event *event)
{
    struct subscription *subscription = context;
    if (!event_filter_passes(&subscription->filter, &subscription->bus->sim, &subscription->watcher, event))
        return;
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
    struct subscription *subscription = malloc(sizeof *subscription);
    if (!subscription)
        return NULL;
    new.number = client->subscribed + 1u;
    new.head_length = (size_t)snprintf(new.head, sizeof new.head, HEAD, new.number);
    new.next = client->subscriptions;
    *subscription = new;
    subscription->watcher.on_event = on_event;
    subscription->watcher.context = subscription;
    json_t *answer = event_watch(sim, &subscription->watcher, &new.filter, new.number, context->request->params, refusal);
    if (!answer) {
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
    free(subscription);
}

json_t *control_unsubscribe(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"subscription", NULL};
    const json_t *params = context->request->params;
    int64_t number;
    if (!params_known(params, names, refusal) || !param_integer(params, "subscription", 1, INT32_MAX, &number, refusal))
        return NULL;
    bus_sim(context->bus); /* what has happened so far is delivered */
    for (struct subscription **at = &context->client->subscriptions; *at; at = &(*at)->next) {
        if ((*at)->number == number) {
            struct sim *sim = &(*at)->bus->sim;
            end_subscription(at);
            return json_pack("{s:I}", "t_us", (json_int_t)sim_now(sim));
        }
    }
    return refuse(refusal, REFUSED_PARAMS, "subscription: this connection has no subscription %lld", (long long)number);
}

void control_subscribe_remove_client(struct control_client *client)
{
    while (client->subscriptions)
        end_subscription(&client->subscriptions);
}
