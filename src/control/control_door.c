/* SPDX-License-Identifier: MIT */
/* control_door.c: clients of the TCP port that have not shown the token yet. Any program of this machine can connect, so they are
 * few, have little time, and a new one takes the place of the oldest: idle connections do not keep others out. */
#include <string.h>

#include "control_inside.h"

#define STRANGER_MS 5000

static void start_timer(struct control *control);

/* The oldest is the last of the list. */
static struct control_client *oldest(const struct control *control)
{
    struct control_client *client = control->strangers;
    while (client && client->next)
        client = client->next;
    return client;
}

static void on_time(uv_timer_t *handle)
{
    struct control *control = handle->data;
    struct control_client *client;
    while ((client = oldest(control)) != NULL && client->deadline <= uv_now(control->loop))
        connection_close(&client->connection);
    start_timer(control);
}

static void start_timer(struct control *control)
{
    const struct control_client *client = oldest(control);
    uint64_t now = uv_now(control->loop);
    if (client)
        uv_timer_start(&control->door, on_time, client->deadline > now ? client->deadline - now : 0, 0);
}

void control_door_add(struct control_client *client)
{
    struct control *control = client->control;
    if (control->stranger_count == CONTROL_STRANGERS)
        connection_close(&oldest(control)->connection);
    client->deadline = uv_now(control->loop) + STRANGER_MS;
    client->next = control->strangers;
    control->strangers = client;
    control->stranger_count++;
    if (!client->next)
        start_timer(control);
}

bool control_door_remove(struct control_client *client)
{
    struct control *control = client->control;
    for (struct control_client **at = &control->strangers; *at; at = &(*at)->next) {
        if (*at == client) {
            *at = client->next;
            control->stranger_count--;
            return true;
        }
    }
    return false;
}

/* Returns true if it is the request to be let in, with the right token. */
static bool has_token(const struct control *control, const struct rpc_request *request, struct refusal *refusal)
{
    const json_t *token = json_object_get(request->params, "token");
    if (strcmp(request->method, "authenticate") != 0 || !json_is_string(token) || json_object_size(request->params) != 1)
        refuse(refusal, RPC_NO_TOKEN, "expected the method `authenticate' with the token of the control file first");
    else if (!control_file_is_token(control->token, json_string_value(token), json_string_length(token)))
        refuse(refusal, RPC_NO_TOKEN, "token: wrong: expected that of the control file");
    else
        return true;
    return false;
}

void control_door_line(struct control_client *client, const char *line, size_t length)
{
    const struct control *control = client->control;
    struct rpc_request request;
    struct refusal refusal;
    bool ok = rpc_read(&request, line, length, control->lines, &refusal) && has_token(control, &request, &refusal);
    if (ok && control->client_count == CONTROL_CLIENTS) {
        refuse(&refusal, REFUSED_STATE, CONTROL_TOO_MANY, CONTROL_CLIENTS);
        ok = false;
    }
    if (ok) {
        control_door_remove(client);
        connection_admit(&client->connection);
        control_add_client(client);
        control_answer(client, request.id, json_object());
    } else {
        control_refuse(client, request.id ? request.id : json_null(), &refusal);
        connection_turn_away(&client->connection);
    }
    rpc_end(&request);
}

void control_door_refuse(struct control_client *client)
{
    struct refusal refusal;
    refuse(&refusal, RPC_NO_TOKEN, "expected the method `authenticate' with the token of the control file first, in a line of at "
           "most %u bytes", CONNECTION_FIRST_MAX);
    control_refuse(client, json_null(), &refusal);
    connection_turn_away(&client->connection);
}
