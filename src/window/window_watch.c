/* SPDX-License-Identifier: MIT */
#include "window_watch.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "window_control.h"
#include "window_page.h"

#define ROUND_MS 50u      /* between two rounds while something moves */
#define HEARTBEAT_MS 1000u
#define HEARTBEAT_CELLS_MS 100u /* of a device with cells, which change without an event */
#define MESSAGES_MAX 20u  /* of the bus, sent in one round */

enum { ID_UNITS = 1, ID_READY, ID_DEVICE, ID_SUBSCRIBE, ID_STATE = 100 };

static void on_timer(uv_timer_t *timer);

static void ask(struct window_watch *watch, int id, const char *method, json_t *params)
{
    if (params == NULL)
        params = json_object();
    json_object_set_new(params, "line", json_integer(watch->bus));
    json_t *request = json_pack("{s:s, s:i, s:s, s:o}", "jsonrpc", "2.0", "id", id, "method", method, "params", params);
    char *text = request != NULL ? json_dumps(request, JSON_COMPACT) : NULL;
    if (text != NULL)
        window_control_send(watch->control, text, strlen(text));
    free(text);
    json_decref(request);
}

json_t *window_watch_json(const struct window_watch *watch)
{
    json_t *units = json_array(), *path = json_string(watch->path), *trouble = json_string(watch->trouble);
    for (unsigned i = 0; i < watch->count; i++)
        json_array_append_new(units, json_string(watch->units[i]));
    return json_pack("{s:s, s:o, s:i, s:o, s:b, s:o, s:O?, s:O?}", "event", "emulator", "control",
                     path != NULL ? path : json_null(), "bus", watch->bus, "units", units, "connected",
                     watch->control != NULL && watch->count > 0, "trouble", trouble != NULL ? trouble : json_null(), "ready",
                     watch->about, "device", watch->device);
}

static bool is_watched(const struct pages *pages)
{
    for (const struct page *page = pages->first; page != NULL; page = page->next)
        if (page->watching)
            return true;
    return false;
}

/* ---- What comes ------------------------------------------------------------------------------------------------------- */

static void schedule(struct window_watch *watch)
{
    if (watch->asked > 0)
        return;
    uint64_t since = uv_now(watch->pages->loop) - watch->round;
    uint64_t rest = since < ROUND_MS ? ROUND_MS - since : 0;
    uint64_t beat = json_is_true(json_object_get(watch->device, "cells")) ? HEARTBEAT_CELLS_MS : HEARTBEAT_MS;
    uv_timer_start(&watch->timer, on_timer, watch->news || watch->moving ? rest : beat, 0);
}

static uint64_t sum_of(const char *text, size_t length)
{
    uint64_t sum = UINT64_C(14695981039346656037);
    for (size_t i = 0; i < length; i++)
        sum = (sum ^ (unsigned char)text[i]) * UINT64_C(1099511628211);
    return sum;
}

/* A state, as text: it is handed on without being read. */
static void take_state(struct window_watch *watch, unsigned unit, const char *state, size_t length)
{
    char head[64];
    const char *motors = strstr(state, "\"motors\""); /* after the time */
    if (motors == NULL || unit >= watch->count)
        return;
    uint64_t sum = sum_of(motors, length - (size_t)(motors - state));
    if (sum == watch->sums[unit])
        return;
    watch->moving = true;
    watch->sums[unit] = sum;
    int before = snprintf(head, sizeof head, "{\"event\":\"state\",\"unit\":\"%s\",\"state\":", watch->units[unit]);
    char *text = malloc((size_t)before + length + 2);
    if (text == NULL)
        return;
    memcpy(text, head, (size_t)before);
    memcpy(text + before, state, length);
    text[(size_t)before + length] = '}';
    for (struct page *page = watch->pages->first; page != NULL; page = page->next)
        if (page->watching)
            page_send_text(page, text, (size_t)before + length + 1, true);
    free(text);
}

static void take_units(struct window_watch *watch, const json_t *result)
{
    size_t i;
    json_t *name;
    watch->count = 0;
    json_array_foreach(json_object_get(result, "units"), i, name) {
        const char *text = json_string_value(name);
        if (text == NULL || strspn(text, "0123456789-") != strlen(text) || strlen(text) >= WATCH_NAME_SIZE ||
            watch->count == WATCH_UNITS_MAX)
            continue;
        watch->sums[watch->count] = 0;
        strcpy(watch->units[watch->count++], text);
    }
}

/* An event: a message on the bus is sent, anything else is a reason to look. */
static void take_event(struct window_watch *watch, const json_t *params)
{
    const char *kind = json_string_value(json_object_get(params, "kind"));
    watch->news = true;
    if (kind != NULL && (strcmp(kind, "message") == 0 || strcmp(kind, "plant") == 0 || strcmp(kind, "injected") == 0) &&
        watch->messages++ < MESSAGES_MAX) {
        json_t *event = json_pack("{s:s, s:O}", "event", "bus", "bus", params);
        for (struct page *page = watch->pages->first; page != NULL; page = page->next)
            if (page->watching && page->waiting < PAGE_FRAMES_MAX)
                page_send(page, json_incref(event));
        json_decref(event);
    }
    schedule(watch);
}

static void take_object(struct window_watch *watch, const char *line)
{
    json_t *object = json_loads(line, 0, NULL), *result = json_object_get(object, "result");
    switch (json_integer_value(json_object_get(object, "id"))) {
    case ID_UNITS:
        take_units(watch, result);
        watch->trouble[0] = '\0';
        if (watch->count == 0)
            snprintf(watch->trouble, sizeof watch->trouble, "there is no bus %d", watch->bus);
        pages_send(watch->pages, window_watch_json(watch));
        schedule(watch);
        break;
    case ID_DEVICE:
        json_decref(watch->device);
        watch->device = json_incref(result);
        break;
    case ID_READY:
        json_decref(watch->about);
        watch->about = json_incref(result);
        break;
    default:
        if (json_is_object(json_object_get(object, "params")))
            take_event(watch, json_object_get(object, "params"));
        break;
    }
    json_decref(object);
}

static void on_line(void *context, char *line, size_t length)
{
    struct window_watch *watch = context;
    static const char word[] = "\"result\":";
    const char *id = strstr(line, "\"id\":"), *result = strstr(line, word);
    long number = id != NULL ? strtol(id + 5, NULL, 10) : 0;
    if (number < ID_STATE || strstr(line, "\"method\"") != NULL) {
        take_object(watch, line);
        return;
    }
    if (watch->asked > 0)
        watch->asked--;
    if (result != NULL && line[length - 1] == '}')
        take_state(watch, (unsigned)(number - ID_STATE), result + sizeof word - 1,
                   length - (size_t)(result + sizeof word - 1 - line) - 1);
    schedule(watch);
}

/* ---- The connection --------------------------------------------------------------------------------------------------- */

static void disconnect(struct window_watch *watch)
{
    window_control_close(watch->control);
    watch->control = NULL;
    watch->count = watch->asked = 0;
    uv_timer_stop(&watch->timer);
}

static void on_ended(void *context)
{
    struct window_watch *watch = context;
    disconnect(watch);
    snprintf(watch->trouble, sizeof watch->trouble, "the emulator has ended");
    pages_send(watch->pages, window_watch_json(watch));
    uv_timer_start(&watch->timer, on_timer, HEARTBEAT_MS, 0);
}

static void connect_watch(struct window_watch *watch)
{
    static const char *const kinds[] = {"motion", "command", "led", "fault", "position", "inputs", "outputs", "variables",
                                        "power", "message", "plant", "injected"};
    const struct window_control_calls calls = {.line = on_line, .ended = on_ended, .context = watch};
    watch->control = window_control_open(watch->pages->loop, watch->path, &calls, watch->trouble);
    if (watch->control == NULL) {
        uv_timer_start(&watch->timer, on_timer, HEARTBEAT_MS, 0);
        return;
    }
    json_t *list = json_array();
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        json_array_append_new(list, json_string(kinds[i]));
    watch->moving = false;
    watch->news = true;
    ask(watch, ID_READY, "ready", NULL);
    ask(watch, ID_DEVICE, "device", NULL);
    ask(watch, ID_UNITS, "units", NULL);
    ask(watch, ID_SUBSCRIBE, "subscribe", json_pack("{s:o}", "kinds", list));
}

static void ask_states(struct window_watch *watch)
{
    watch->round = uv_now(watch->pages->loop);
    watch->moving = watch->news = false;
    watch->messages = 0;
    watch->asked = watch->count;
    for (unsigned i = 0; i < watch->count; i++)
        ask(watch, ID_STATE + (int)i, "state", json_pack("{s:s}", "unit", watch->units[i]));
}

static void on_timer(uv_timer_t *timer)
{
    struct window_watch *watch = timer->data;
    if (watch->path[0] == '\0' || !is_watched(watch->pages))
        return;
    if (watch->control == NULL)
        connect_watch(watch);
    else if (watch->asked == 0)
        ask_states(watch);
}

/* What is known of the emulator. */
static void forget(struct window_watch *watch)
{
    json_decref(watch->about);
    json_decref(watch->device);
    watch->about = watch->device = NULL;
}

bool window_watch_has_method(const struct window_watch *watch, const char *method)
{
    size_t i;
    json_t *name;
    json_array_foreach(json_object_get(watch->device, "methods"), i, name)
        if (json_is_string(name) && strcmp(json_string_value(name), method) == 0)
            return true;
    return false;
}

void window_watch_choose(struct window_watch *watch, const char *path, int bus)
{
    disconnect(watch);
    forget(watch);
    watch->trouble[0] = '\0';
    watch->bus = bus;
    snprintf(watch->path, sizeof watch->path, "%s", path != NULL ? path : "");
    for (struct page *page = watch->pages->first; page != NULL; page = page->next) {
        page_detach(page);
        page_send(page, json_pack("{s:s}", "event", "uncalled")); /* what has not been answered will not be */
    }
    window_watch_pages_changed(watch);
    pages_send(watch->pages, window_watch_json(watch));
}

void window_watch_pages_changed(struct window_watch *watch)
{
    memset(watch->sums, 0, sizeof watch->sums); /* a new page knows nothing */
    watch->news = true;
    if (watch->path[0] == '\0' || !is_watched(watch->pages))
        disconnect(watch);
    else if (watch->control == NULL)
        connect_watch(watch);
    else
        schedule(watch);
}

void window_watch_begin(struct window_watch *watch, struct pages *pages)
{
    watch->pages = pages;
    watch->timer.data = watch;
    uv_timer_init(pages->loop, &watch->timer);
}

void window_watch_end(struct window_watch *watch)
{
    disconnect(watch);
    watch->path[0] = '\0';
    forget(watch);
}
