/* SPDX-License-Identifier: MIT */
/* subscribe and unsubscribe: events gathered as lines of JSON until they are taken. */
#include <stdlib.h>
#include <string.h>

#include "handle.h"

#define ROOM_FIRST 4096u /* bytes */

static char *make_room(struct handle_subscription *subscription, size_t more)
{
    size_t room = subscription->room > 0 ? subscription->room : ROOM_FIRST;
    while (room - subscription->length < more && room < HANDLE_EVENTS_MAX)
        room *= 2u;
    if (room - subscription->length < more)
        return NULL;
    if (room > subscription->room) {
        char *text = realloc(subscription->text, room);
        if (!text)
            return NULL;
        subscription->text = text;
        subscription->room = room;
    }
    return subscription->text + subscription->length;
}

static void on_event(void *context, const struct watch_event *event)
{
    struct handle_subscription *subscription = context;
    if (!event_filter_passes(&subscription->filter, subscription->sim, &subscription->watcher, event))
        return;
    char *at = subscription->lost == 0 ? make_room(subscription, event_json_room(event) + 3u) : NULL;
    if (!at) {
        subscription->lost_since = subscription->lost == 0 ? event->tick : subscription->lost_since;
        subscription->lost++;
        return;
    }
    *at++ = '{';
    at = event_json(at, subscription->sim, event);
    *at++ = '}';
    *at++ = '\n';
    subscription->length = (size_t)(at - subscription->text);
}

json_t *handle_subscribe(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    struct sim *sim = &handle->sim;
    struct event_filter filter;
    if (!event_filter_read(&filter, sim, params, refusal))
        return NULL;
    if (json_object_get(params, "collect"))
        return refuse(refusal, REFUSED_PARAMS, "collect: expected a client of the control socket");
    struct handle_subscription *subscription = handle_subscription(handle, 0);
    if (!subscription)
        return refuse(refusal, REFUSED_STATE, "too many subscriptions: expected at most %u", HANDLE_SUBSCRIPTIONS);
    *subscription = (struct handle_subscription){
        .sim = sim, .filter = filter, .watcher = {.on_event = on_event, .context = subscription}};
    json_t *answer = event_watch(sim, &subscription->watcher, &filter, handle->subscribed + 1u, params, refusal);
    if (answer)
        subscription->number = ++handle->subscribed;
    return answer;
}

static void end(struct handle_subscription *subscription)
{
    sim_unwatch(subscription->sim, &subscription->watcher);
    free(subscription->text);
    *subscription = (struct handle_subscription){0};
}

json_t *handle_unsubscribe(struct handle *handle, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"subscription", NULL};
    int64_t number;
    if (!params_known(params, names, refusal) || !param_integer(params, "subscription", 1, INT32_MAX, &number, refusal))
        return NULL;
    struct handle_subscription *subscription = handle_subscription(handle, (unsigned)number);
    if (!subscription)
        return refuse(refusal, REFUSED_PARAMS, "subscription: there is no subscription %lld", (long long)number);
    end(subscription);
    return json_pack("{s:I}", "t_us", (json_int_t)sim_now(&handle->sim));
}

struct handle_subscription *handle_subscription(struct handle *handle, unsigned number)
{
    for (unsigned i = 0; i < HANDLE_SUBSCRIPTIONS; i++)
        if (handle->subscription[i].number == number)
            return &handle->subscription[i];
    return NULL;
}

void handle_free_subscriptions(struct handle *handle)
{
    for (unsigned i = 0; i < HANDLE_SUBSCRIPTIONS; i++)
        if (handle->subscription[i].number != 0)
            end(&handle->subscription[i]);
}
