/* SPDX-License-Identifier: MIT */
#include "window_requests.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "window_control.h"
#include "window_folder.h"
#include "window_inside.h"
#include "window_ports.h"
#include "window_tools.h"

#define MESSAGE_MIN 64u

static struct window *window_of(struct page *page)
{
    return page->pages->context;
}

/* ---- Parameters ------------------------------------------------------------------------------------------------------- */

/* A whole number low..high; `otherwise` if it is not there. Returns false if it is something else: refused. */
static bool read_number(struct page *page, const json_t *request, const char *name, unsigned low, unsigned high,
                        unsigned otherwise, unsigned *number)
{
    const json_t *value = json_object_get(request, name);
    *number = otherwise;
    if (value == NULL)
        return true;
    if (json_is_integer(value) && json_integer_value(value) >= low && json_integer_value(value) <= high) {
        *number = (unsigned)json_integer_value(value);
        return true;
    }
    page_refuse(page, request, "%s: expected a number %u to %u", name, low, high);
    return false;
}

static const char *read_string(struct page *page, const json_t *request, const char *name)
{
    const char *text = json_string_value(json_object_get(request, name));
    if (text == NULL)
        page_refuse(page, request, "%s: expected a string", name);
    return text;
}

/* A job for the port with node, motor, time; NULL: refused. */
static struct port_job *make_job(struct page *page, json_t *request, enum port_kind kind)
{
    unsigned node, motor, timeout;
    if (!read_number(page, request, "node", 0, RKM04_NODE_MAX, 1, &node) ||
        !read_number(page, request, "motor", 0, RKM04_MOTORS, 1, &motor) ||
        !read_number(page, request, "timeout_ms", 1, WINDOW_TIMEOUT_MS_MAX, window_of(page)->timeout_ms, &timeout))
        return NULL;
    struct port_job *job = port_job_new(kind, page->number, request);
    if (job == NULL)
        return NULL;
    job->node = node;
    job->motor = motor;
    job->timeout_ms = timeout;
    job->poll = json_is_true(json_object_get(request, "poll"));
    return job;
}

static void do_job(struct page *page, json_t *request, struct port_job *job)
{
    if (job != NULL && !window_port_do(&window_of(page)->port, job))
        page_refuse(page, request, "too many requests wait for the port");
}

/* ---- The port --------------------------------------------------------------------------------------------------------- */

static void do_open(struct page *page, json_t *request)
{
    const char *port = read_string(page, request, "port");
    const char *framing = json_string_value(json_object_get(request, "framing"));
    const struct rkm04_framing *named = rkm04_framing_named(framing != NULL ? framing : "hdlc");
    if (port == NULL)
        return;
    if (named == NULL || port[0] == '\0' || strlen(port) >= PATH_MAX) {
        page_refuse(page, request, "expected a port, and the framing hdlc or plain");
        return;
    }
    struct port_job *job = make_job(page, request, PORT_OPEN);
    if (job == NULL)
        return;
    job->framing = named;
    job->text = strdup(port);
    do_job(page, request, job);
}

static void do_close(struct page *page, json_t *request)
{
    do_job(page, request, make_job(page, request, PORT_CLOSE));
}

static void do_stop(struct page *page, json_t *request)
{
    do_job(page, request, make_job(page, request, PORT_STOP));
}

/* The bytes of a message as hexadecimal digits. Returns their number; 0: they are not. */
static size_t read_hex(const char *text, uint8_t *bytes)
{
    size_t length = strlen(text) / 2;
    if (strlen(text) % 2 != 0 || length > CLIENT_MESSAGE_MAX || text[strspn(text, "0123456789abcdefABCDEF")] != '\0')
        return 0;
    for (size_t i = 0; i < length; i++) {
        const char digits[] = {text[2 * i], text[2 * i + 1], '\0'};
        bytes[i] = (uint8_t)strtoul(digits, NULL, 16);
    }
    return length;
}

/* {"message": HEX}: one message, as it is. A page that polls leaves one out while the port is busy. Only messages that
 * ask are polled: nothing but a person's request moves a motor. */
static void do_request(struct page *page, json_t *request)
{
    const char *hex = read_string(page, request, "message");
    if (hex == NULL)
        return;
    struct port_job *job = make_job(page, request, PORT_REQUEST);
    if (job == NULL)
        return;
    job->message_length = read_hex(hex, job->message);
    if (job->message_length == 0) {
        page_refuse(page, request, "message: expected bytes in hexadecimal digits, at most %u", CLIENT_MESSAGE_MAX);
        port_job_free(job);
    } else if (job->poll && (job->message[0] < 4 || job->message[0] > 7)) {
        page_refuse(page, request, "poll: expected a message 4 to 7");
        port_job_free(job);
    } else if (job->poll && window_of(page)->port.waiting > 0) {
        page_answer(page, request, json_pack("{s:s}", "outcome", "busy"));
        port_job_free(job);
    } else {
        do_job(page, request, job);
    }
}

static void do_send(struct page *page, json_t *request)
{
    unsigned most;
    const char *text = read_string(page, request, "text");
    if (text == NULL || !read_number(page, request, "message_max", MESSAGE_MIN, CLIENT_MESSAGE_MAX, CLIENT_MESSAGE_MAX, &most))
        return;
    struct port_job *job = make_job(page, request, PORT_SEND);
    if (job == NULL)
        return;
    job->text = strdup(text);
    job->length = strlen(text);
    job->message_max = most;
    do_job(page, request, job);
}

/* ---- The emulator ----------------------------------------------------------------------------------------------------- */

static void do_attach(struct page *page, json_t *request)
{
    unsigned bus;
    const char *path = json_string_value(json_object_get(request, "control"));
    if (!read_number(page, request, "bus", 0, 255, 0, &bus))
        return;
    window_folder_remove(window_of(page)->folder);
    window_watch_choose(&window_of(page)->watch, path, (int)bus);
    page_answer(page, request, json_object());
}

static void do_watch(struct page *page, json_t *request)
{
    page->watching = json_is_true(json_object_get(request, "on"));
    window_watch_pages_changed(&window_of(page)->watch);
    page_answer(page, request, json_object());
}

/* An answer of the emulator goes to the page as it is: {"event": "called", "answer": …}. */
static void on_line(void *context, char *line, size_t length)
{
    static const char head[] = "{\"event\":\"called\",\"answer\":";
    struct page *page = context;
    char *text = malloc(sizeof head + length + 1);
    if (text == NULL)
        return;
    memcpy(text, head, sizeof head - 1);
    memcpy(text + sizeof head - 1, line, length);
    text[sizeof head - 1 + length] = '}';
    page_send_text(page, text, sizeof head + length, false);
    free(text);
}

static void on_ended(void *context)
{
    struct page *page = context;
    page_detach(page);
    page_send(page, json_pack("{s:s}", "event", "uncalled")); /* what has not been answered will not be */
}

/* Methods with which a page works, and those that the device brings along. What is subscribed to is collected: nothing comes to
 * the page unasked. */
static bool is_allowed(const struct window *window, const char *method, const json_t *params)
{
    static const char *const methods[] = {
        "units", "device", "state", "ready", "motor.program", "di.set", "reset", "power", "switch", "clock", "advance",
        "trace.start", "trace.stop", "plant.get", "plant.set", "fault.inject", "fault.clear", "fault.list", "fault.kinds",
        "snapshot", "restore", "collected", "unsubscribe",
    };
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        if (strcmp(methods[i], method) == 0)
            return true;
    if (strcmp(method, "subscribe") == 0)
        return json_is_true(json_object_get(params, "collect"));
    return window_watch_has_method(&window->watch, method);
}

/* Files of the emulator for this window lie in its folder. Returns false if that is not possible: refused. */
static bool place_file(struct page *page, const json_t *request, json_t *params)
{
    char path[PATH_MAX + 64];
    const char *file = json_string_value(json_object_get(params, "file"));
    if (json_object_get(params, "file") == NULL)
        return true;
    if (file == NULL || file[0] == '.' || strlen(file) > 60 ||
        file[strspn(file, "abcdefghijklmnopqrstuvwxyz0123456789.-")] != '\0') {
        page_refuse(page, request, "file: expected a name of small letters, digits, - and .");
        return false;
    }
    if (!window_folder_make(window_of(page)->folder, window_of(page)->watch.path)) {
        page_refuse(page, request, "cannot make a folder for files");
        return false;
    }
    snprintf(path, sizeof path, "%s/%s", window_of(page)->folder, file);
    json_object_set_new(params, "file", json_string(path));
    return true;
}

/* {"method", "params"}: a call of the control socket, as text with this id. NULL: refused. */
static char *make_call(struct page *page, const json_t *request, json_t *id)
{
    const struct window *window = window_of(page);
    const char *method = read_string(page, request, "method");
    json_t *params = json_deep_copy(json_object_get(request, "params"));
    if (method == NULL || (params != NULL && !json_is_object(params)) || !is_allowed(window, method, params)) {
        if (method != NULL)
            page_refuse(page, request, "unknown method, or params that are no object");
        json_decref(params);
        return NULL;
    }
    params = params != NULL ? params : json_object();
    if (!place_file(page, request, params)) {
        json_decref(params);
        return NULL;
    }
    json_object_set_new(params, "line", json_integer(window->watch.bus));
    json_t *call = json_pack("{s:s, s:O?, s:s, s:o}", "jsonrpc", "2.0", "id", id, "method", method, "params", params);
    char *text = call != NULL ? json_dumps(call, JSON_COMPACT) : NULL;
    if (text == NULL)
        page_refuse(page, request, "out of memory");
    json_decref(call);
    return text;
}

/* A method of the control socket. */
static void do_call(struct page *page, json_t *request)
{
    const struct window_control_calls calls = {.line = on_line, .ended = on_ended, .context = page};
    struct window *window = window_of(page);
    char trouble[256] = "no emulator is chosen";
    char *text = make_call(page, request, json_object_get(request, "id"));
    if (text == NULL)
        return;
    if (page->control == NULL && window->watch.path[0] != '\0')
        page->control = window_control_open(&window->loop, window->watch.path, &calls, trouble);
    if (page->control == NULL)
        page_refuse(page, request, "%s", trouble);
    else
        window_control_send(page->control, text, strlen(text));
    free(text);
}

/* What is called when the page goes: it lets keys go that are held. Without a method: nothing. */
static void do_leave(struct page *page, json_t *request)
{
    const bool is_call = json_object_get(request, "method") != NULL;
    char *text = is_call ? make_call(page, request, NULL) : NULL;
    if (is_call && text == NULL)
        return;
    free(page->leave);
    page->leave = text;
    page_answer(page, request, json_object());
}

/* ---- All -------------------------------------------------------------------------------------------------------------- */

static void do_hello(struct page *page, json_t *request)
{
    struct window *window = window_of(page);
    page_answer(page, request, json_pack("{s:s, s:I, s:o, s:o}", "version", RKM04_VERSION, "page", (json_int_t)page->number,
                                         "port", window_port_json(&window->port), "emulator",
                                         window_watch_json(&window->watch)));
}

void window_request(struct page *page, json_t *request)
{
    static const struct {
        const char *name;
        void (*act)(struct page *page, json_t *request);
    } requests[] = {
        {"hello", do_hello}, {"ports", window_ports_list}, {"open", do_open}, {"close", do_close}, {"request", do_request},
        {"send", do_send}, {"stop", do_stop}, {"check", tools_do}, {"format", tools_do}, {"attach", do_attach},
        {"watch", do_watch}, {"call", do_call}, {"leave", do_leave},
    };
    const char *name = json_string_value(json_object_get(request, "do"));
    for (size_t i = 0; name != NULL && i < sizeof requests / sizeof requests[0]; i++) {
        if (strcmp(requests[i].name, name) == 0) {
            requests[i].act(page, request);
            return;
        }
    }
    page_refuse(page, request, "unknown request");
}

void window_page_closed(struct page *page)
{
    page_detach(page);
    tools_drop(page->later);
    window_watch_pages_changed(&window_of(page)->watch);
}
