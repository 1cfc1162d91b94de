/* SPDX-License-Identifier: MIT */
/* What clients can ask for: the methods that have to do with this process and its clocks. Everything else is a command of the
 * line (src/command/command.c). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "text/text.h"

/* ---- Answers -------------------------------------------------------------------------------------------------------- */

static void send_text(struct control_client *client, char *text)
{
    if (text)
        connection_send(&client->connection, text, strlen(text));
    else
        client->connection.failed = true; /* it waits for an answer that cannot be given */
    free(text);
}

void control_answer(struct control_client *client, const json_t *id, json_t *result)
{
    if (id)
        send_text(client, rpc_result(id, result));
    else
        json_decref(result);
}

void control_refuse(struct control_client *client, const json_t *id, const struct refusal *refusal)
{
    if (id)
        send_text(client, rpc_error(id, refusal));
}

void control_refuse_line(struct control_client *client, int code, const char *text)
{
    struct refusal refusal;
    refuse(&refusal, code, "%s", text);
    control_refuse(client, json_null(), &refusal);
}

/* ---- Methods -------------------------------------------------------------------------------------------------------- */

/* Where everything is: what READY said, as it is now. */
static json_t *ready_result(struct control_context *context, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    const struct control_calls *calls = &context->client->control->calls;
    return params_known(context->request->params, none, refusal) ? calls->ready(calls->context) : NULL;
}

/* Of one line, or of all: then of none if one of them is being advanced. */
static bool set_clocks(const struct control_context *context, const char *text, struct refusal *refusal)
{
    const struct control *control = context->client->control;
    unsigned first = context->request->line, end = context->request->line_given ? first + 1 : control->lines;
    for (unsigned line = first; line < end; line++) {
        if (control_time_is_moved(control, control->buses[line])) {
            refuse(refusal, REFUSED_STATE, "a client is advancing the clock: change it when that has ended");
            return false;
        }
    }
    for (unsigned line = first; line < end; line++)
        if (!bus_set_clock(control->buses[line], text, refusal))
            return false;
    return true;
}

static json_t *set_clock(struct control_context *context, struct refusal *refusal)
{
    static const char *const names[] = {"clock", NULL};
    const json_t *params = context->request->params;
    if (!params_known(params, names, refusal))
        return NULL;
    if (json_object_get(params, "clock")) {
        const char *text = param_string(params, "clock", refusal);
        if (!text || !set_clocks(context, text, refusal))
            return NULL;
    }
    return json_pack("{s:I, s:s}", "t_us", (json_int_t)sim_now(bus_sim(context->bus)), "clock", context->bus->time.clock_text);
}

static json_t *shut_down(struct control_context *context, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    if (!params_known(context->request->params, none, refusal))
        return NULL;
    control_end(context->client);
    return json_pack("{s:I}", "t_us", (json_int_t)sim_now(bus_sim(context->bus)));
}

static const struct {
    const char *name;
    control_method *function;
} methods[] = {
    {"ready", ready_result},
    {"clock", set_clock},
    {"shutdown", shut_down},
    {"wait", control_wait},
    {"advance", control_advance},
    {"subscribe", control_subscribe},
    {"collected", control_collected},
    {"unsubscribe", control_unsubscribe},
    {"trace.start", control_trace_start},
    {"trace.stop", control_trace_stop},
};

static control_method *find(const char *name)
{
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        if (strcmp(methods[i].name, name) == 0)
            return methods[i].function;
    return NULL;
}

/* Names of the methods that are not commands of a sim, for hints. */
static const char *names_of_methods(void)
{
    static char names[256];
    size_t length = 0;
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++)
        length += (size_t)snprintf(names + length, sizeof names - length, "%s, ", methods[i].name);
    return names;
}

/* A command of the line, at its present tick. What it leads to is checked at once. */
static json_t *command(struct control_context *context, struct refusal *refusal)
{
    const struct rpc_request *request = context->request;
    struct sim *sim = bus_sim(context->bus);
    uint64_t tick = sim_now(sim);
    sim->outer_methods = names_of_methods();
    json_t *result = sim_command(sim, request->method, request->params, refusal);
    if (!result)
        return NULL;
    bus_changed(context->bus);
    if (!json_object_get(result, "t_us"))
        json_object_set_new(result, "t_us", json_integer((json_int_t)tick));
    if (strcmp(request->method, "state") == 0)
        json_object_set_new(result, "clock", json_string(context->bus->time.clock_text));
    if (strcmp(request->method, "units") == 0)
        json_object_set_new(result, "lines", json_integer(context->client->control->lines));
    return result;
}

/* Files outside some folders are out of reach (serve_sandbox.h), with the errno of files that belong to others. */
static void explain_denied(const struct control *control, struct refusal *refusal)
{
    static const char denied[] = "Permission denied";
    size_t length = strlen(refusal->text), tail = sizeof denied - 1;
    if (control->buses[0]->options->no_sandbox || length < tail || strcmp(refusal->text + length - tail, denied) != 0)
        return;
    snprintf(refusal->text + length, sizeof refusal->text - length,
             "; to use files in other folders, start the emulator with --allow-folder");
}

bool control_handle_line(struct control_client *client, const char *line, size_t length)
{
    struct control *control = client->control;
    struct rpc_request request;
    struct refusal refusal = {.code = REFUSED_MEMORY, .text = "out of memory"};
    struct control_context context = {.client = client, .request = &request};
    json_t *result = NULL;
    bool ok = rpc_read(&request, line, length, control->lines, &refusal);
    if (ok) {
        const bool is_exchange = exchange_is_named(bus_sim(control->buses[request.line]), request.method);
        control_method *method = is_exchange ? control_exchange : find(request.method);
        if (strcmp(request.method, "restore") == 0 && json_object_get(request.params, "file"))
            method = control_restore;
        context.bus = control->buses[request.line];
        result = method ? method(&context, &refusal) : command(&context, &refusal);
    }
    if (result) {
        control_answer(client, request.id, result);
    } else if (!context.later && !context.again) {
        explain_denied(control, &refusal);
        control_refuse(client, request.id, &refusal);
    }
    rpc_end(&request);
    return !context.again;
}
