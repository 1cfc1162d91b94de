/* SPDX-License-Identifier: MIT */
/* subscribe and unsubscribe: what happens on a line, as notifications. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "trace/trace.h"

#define HEAD "{\"jsonrpc\":\"2.0\",\"method\":\"event\",\"params\":{\"subscription\":%u,"
#define TAIL "}}\n"
#define ALL_MOTORS 0x1Eu
#define ALL_UNITS 0x1FFFEu

struct subscription {
    struct control_client *client;
    struct bus *bus;
    unsigned number;
    struct watcher watcher;
    uint32_t motors, units; /* bit n: number n */
    size_t head_length;
    char head[96];
    struct subscription *next; /* of the same client */
};

static void on_event(void *context, const struct watch_event *event)
{
    struct subscription *subscription = context;
    if ((event->motor && !(subscription->motors >> event->motor & 1u)) ||
        (event->unit && !(subscription->units >> event->unit & 1u)))
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

/* ---- What is chosen ------------------------------------------------------------------------------------------------- */

static bool read_kinds(const json_t *kinds, uint32_t *chosen, struct refusal *refusal)
{
    size_t i;
    const json_t *kind;
    if (!kinds)
        return true;
    if (!json_is_array(kinds) || json_array_size(kinds) == 0) {
        refuse(refusal, REFUSED_PARAMS, "kinds: expected a list of names, as in [\"motion\", \"outputs\"]");
        return false;
    }
    *chosen = 0;
    json_array_foreach(kinds, i, kind) {
        enum watch_kind found = json_is_string(kind) ? watch_kind_named(json_string_value(kind)) : WATCH_KINDS;
        if (found == WATCH_KINDS) {
            char list[200] = "";
            for (unsigned k = 0; k < WATCH_KINDS; k++)
                snprintf(list + strlen(list), sizeof list - strlen(list), k > 0 ? ", %s" : "%s",
                         watch_kind_name((enum watch_kind)k));
            refuse(refusal, REFUSED_PARAMS, "kinds: unknown event kind `%.40s'; kinds are: %s",
                   json_is_string(kind) ? json_string_value(kind) : "?", list);
            return false;
        }
        *chosen |= WATCH_BIT(found);
    }
    return true;
}

static bool add_motor(struct sim *sim, const json_t *motor, uint32_t *chosen, struct refusal *refusal)
{
    const unsigned axes = sim_device(sim)->axes;
    if (json_is_integer(motor) && json_integer_value(motor) >= 1 && json_integer_value(motor) <= axes) {
        *chosen |= 1u << (unsigned)json_integer_value(motor);
        return true;
    }
    refuse(refusal, REFUSED_PARAMS, "motor: expected a number from 1 to %u, or a list of them", axes);
    return false;
}

static bool add_unit(struct sim *sim, const json_t *unit, uint32_t *chosen, struct refusal *refusal)
{
    json_t *params = json_pack("{s:O}", "unit", unit);
    unsigned number = param_unit(sim, params, refusal);
    json_decref(params);
    *chosen |= 1u << number;
    return number > 0;
}

/* One or a list of them; left out: all. */
static bool read_one_or_list(struct sim *sim, const json_t *given,
                      bool (*add)(struct sim *sim, const json_t *one, uint32_t *chosen, struct refusal *refusal),
                      uint32_t *chosen, struct refusal *refusal)
{
    size_t i;
    const json_t *one;
    if (!given)
        return true;
    *chosen = 0;
    if (!json_is_array(given) || json_array_size(given) == 0)
        return add(sim, given, chosen, refusal);
    json_array_foreach(given, i, one) {
        if (!add(sim, one, chosen, refusal))
            return false;
    }
    return true;
}

/* ---- The methods ---------------------------------------------------------------------------------------------------- */

json_t *control_subscribe(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"kinds", "motor", "unit", NULL};
    struct control_client *client = context->client;
    const json_t *params = context->request->params;
    struct sim *sim = bus_sim(context->bus);
    struct subscription new = {.client = client, .bus = context->bus, .motors = ALL_MOTORS, .units = ALL_UNITS};
    unsigned count = 0;
    new.watcher.kinds = WATCH_ALL;
    if (!params_known(params, names, refusal) || !read_kinds(json_object_get(params, "kinds"), &new.watcher.kinds, refusal) ||
        !read_one_or_list(sim, json_object_get(params, "motor"), add_motor, &new.motors, refusal) ||
        !read_one_or_list(sim, json_object_get(params, "unit"), add_unit, &new.units, refusal))
        return NULL;
    for (const struct subscription *other = client->subscriptions; other; other = other->next)
        count++;
    if (count == CONTROL_SUBSCRIPTIONS)
        return refuse(refusal, REFUSED_STATE, "too many subscriptions: expected at most %u per client",
                      CONTROL_SUBSCRIPTIONS);
    struct subscription *subscription = malloc(sizeof *subscription);
    if (!subscription)
        return NULL;
    new.number = ++client->subscribed;
    new.head_length = (size_t)snprintf(new.head, sizeof new.head, HEAD, new.number);
    new.next = client->subscriptions;
    *subscription = new;
    subscription->watcher.see = on_event;
    subscription->watcher.context = subscription;
    client->subscriptions = subscription;
    sim_watch(sim, &subscription->watcher);
    /* Answered before the line looks again: no event comes before the number of its subscription is known. */
    context->later = true;
    control_answer(client, context->request->id, json_pack("{s:I, s:i}", "t_us", (json_int_t)sim_now(sim), "subscription",
                                                         (int)subscription->number));
    bus_changed(context->bus); /* it looks more often while somebody watches */
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
    bus_sim(context->bus); /* what has happened so far is told */
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
