/* SPDX-License-Identifier: MIT */
#include "watch.h"

#include <stdlib.h>
#include <string.h>

#include "wire/wire.h"

#define ORDER_PHASE 52u /* bit of the phase in watch_event.order */
#define ROOM_AT_FIRST 256u

static const char *const names[WATCH_KINDS] = {
    [WATCH_STEP] = "step",
    [WATCH_DIRECTION] = "direction",
    [WATCH_MOTION] = "motion",
    [WATCH_COMMAND] = "command",
    [WATCH_LED] = "led",
    [WATCH_FAULT] = "fault",
    [WATCH_POSITION] = "position",
    [WATCH_INPUTS] = "inputs",
    [WATCH_OUTPUTS] = "outputs",
    [WATCH_VARIABLES] = "variables",
    [WATCH_POWER] = "power",
    [WATCH_BYTE] = "byte",
    [WATCH_MESSAGE] = "message",
    [WATCH_PLANT] = "plant",
    [WATCH_INJECTED] = "injected",
    [WATCH_SERVICE] = "service",
    [WATCH_VALUE] = "value",
    [WATCH_NOTE] = "note",
    [WATCH_CELL] = "cell",
};

const char *watch_kind_name(enum watch_kind kind)
{
    return (unsigned)kind < WATCH_KINDS ? names[kind] : "?";
}

enum watch_kind watch_kind_named(const char *name)
{
    unsigned kind = 0;
    while (kind < WATCH_KINDS && strcmp(names[kind], name) != 0)
        kind++;
    return (enum watch_kind)kind;
}

/* What an event owns. */
static void free_event(const struct watch_event *event)
{
    if (event->kind == WATCH_MESSAGE)
        free((void *)event->message);
    else if (event->kind == WATCH_PLANT || event->kind == WATCH_INJECTED || event->kind == WATCH_NOTE)
        free((void *)event->text);
    else if (event->kind == WATCH_SERVICE)
        free((void *)event->service);
}

const char *watch_service_act_name(enum watch_service_act act)
{
    static const char *const acts[] = {"open", "closed", "received", "sent"};
    return (unsigned)act < sizeof acts / sizeof acts[0] ? acts[act] : "?";
}

static bool make_room(struct watch *watch)
{
    if (watch->count < watch->room)
        return true;
    size_t room = watch->room > 0 ? 2 * watch->room : ROOM_AT_FIRST;
    struct watch_event *events = realloc(watch->events, room * sizeof *events);
    if (!events)
        return false;
    watch->events = events;
    watch->room = room;
    return true;
}

void watch_add(struct watch *watch, enum watch_phase phase, const struct watch_event *event)
{
    if ((watch->kinds & WATCH_BIT(event->kind)) == 0) {
        free_event(event);
        return;
    }
    if (!make_room(watch)) {
        watch->short_of_memory = true;
        free_event(event);
        return;
    }
    struct watch_event *copy = &watch->events[watch->count++];
    *copy = *event;
    copy->order = event->order << WATCH_ORDER_NS | (uint64_t)phase << ORDER_PHASE | watch->sequence++;
}

static int compare_events(const void *left, const void *right)
{
    const struct watch_event *a = left, *b = right;
    if (a->tick != b->tick)
        return a->tick < b->tick ? -1 : 1;
    return a->order < b->order ? -1 : a->order > b->order;
}

void watch_deliver(struct watch *watch, uint64_t tick)
{
    size_t done = 0;
    if (watch->count == 0)
        return;
    qsort(watch->events, watch->count, sizeof watch->events[0], compare_events);
    for (; done < watch->count && watch->events[done].tick < tick; done++) {
        const struct watch_event *event = &watch->events[done];
        for (struct watcher *watcher = watch->watchers; watcher; watcher = watcher->next)
            if (watcher->kinds & WATCH_BIT(event->kind))
                watcher->on_event(watcher->context, event);
        free_event(event);
    }
    watch->count -= done;
    memmove(watch->events, watch->events + done, watch->count * sizeof watch->events[0]);
}

void watch_end(struct watch *watch)
{
    for (size_t i = 0; i < watch->count; i++)
        free_event(&watch->events[i]);
    free(watch->events);
    free(watch->cells);
    *watch = (struct watch){0};
}

static void sum_kinds(struct watch *watch)
{
    watch->kinds = 0;
    for (const struct watcher *watcher = watch->watchers; watcher; watcher = watcher->next)
        watch->kinds |= watcher->kinds;
}

/* After those that are there: who came first sees everything first. */
void watch_add_watcher(struct watch *watch, struct watcher *watcher)
{
    struct watcher **at = &watch->watchers;
    while (*at)
        at = &(*at)->next;
    watcher->next = NULL;
    *at = watcher;
    sum_kinds(watch);
}

/* Its cells, and what has been gathered about them. */
static void remove_cells(struct watch *watch, const struct watcher *watcher)
{
    size_t kept = 0;
    if (watch->cell_count == 0)
        return;
    for (size_t i = 0; i < watch->count; i++)
        if (watch->events[i].kind != WATCH_CELL || watch->cells[watch->events[i].number].owner != watcher)
            watch->events[kept++] = watch->events[i];
    watch->count = kept;
    for (unsigned at = 0; at < watch->cell_count; at++)
        if (watch->cells[at].owner == watcher)
            watch->cells[at].owner = NULL;
    while (watch->cell_count > 0 && !watch->cells[watch->cell_count - 1u].owner)
        watch->cell_count--;
}

void watch_remove_watcher(struct watch *watch, struct watcher *watcher)
{
    remove_cells(watch, watcher);
    for (struct watcher **at = &watch->watchers; *at; at = &(*at)->next) {
        if (*at == watcher) {
            *at = watcher->next;
            break;
        }
    }
    sum_kinds(watch);
}
