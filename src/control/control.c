/* SPDX-License-Identifier: MIT */
#include "control.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "control_inside.h"
#include "line/line.h"

#define BACKLOG 128
#define BUDGET 500000u   /* ns a turn of the loop for the lines of all clients; a unit waits no longer */
#define CHECK_MS 200     /* how soon it is noticed that a client which had ended its sending has gone */
#define ENDING_MS 1000   /* how long the answer to shutdown waits to be read */

/* ---- Turns of the loop ---------------------------------------------------------------------------------------------- */

static void call_shutdown(struct control *control)
{
    control->ender = NULL;
    control->calls.shutdown(control->calls.context);
}

static void on_turn(uv_prepare_t *handle)
{
    struct control *control = handle->data;
    for (struct control_client *client = control->clients, *next; client; client = next) {
        next = client->next;
        connection_flush(&client->connection);
    }
    if (control->ender && connection_unread(&control->ender->connection) == 0)
        call_shutdown(control);
}

static void on_ending(uv_timer_t *handle)
{
    struct control *control = handle->data;
    if (control->ender)
        call_shutdown(control);
}

void control_end(struct control_client *client)
{
    struct control *control = client->control;
    if (control->ender)
        return;
    control->ender = client;
    uv_timer_start(&control->ending, on_ending, ENDING_MS, 0);
}

/* Lines that could not be dealt with at once, each client in its turn. */
static void on_work(uv_idle_t *handle)
{
    struct control *control = handle->data;
    unsigned count = control->client_count > 0 ? control->client_count : 1;
    bool more = false;
    for (struct control_client *client = control->clients, *next; client; client = next) {
        next = client->next;
        client->connection.blocked = false;
        if (connection_serve(&client->connection, BUDGET / count))
            more = true;
    }
    if (more || !control->working)
        return;
    control->working = false;
    uv_idle_stop(&control->work);
}

void control_schedule_lines(struct control *control)
{
    if (!control->open)
        return;
    control->working = true;
    uv_idle_start(&control->work, on_work);
}

static void on_check(uv_timer_t *handle)
{
    struct control *control = handle->data;
    bool more = false;
    for (struct control_client *client = control->clients, *next; client; client = next) {
        next = client->next;
        if (client->connection.leaving && connection_is_gone(&client->connection))
            connection_close(&client->connection);
        else
            more = more || client->connection.leaving;
    }
    if (!more)
        uv_timer_stop(&control->check);
}

static void start_checking(struct control *control)
{
    if (control->open && !uv_is_active((uv_handle_t *)&control->check))
        uv_timer_start(&control->check, on_check, CHECK_MS, CHECK_MS);
}

/* ---- Clients -------------------------------------------------------------------------------------------------------- */

static void remove_client(struct control_client *client)
{
    struct control *control = client->control;
    control_time_remove_client(client);
    control_subscribe_remove_client(client);
    control_restore_remove_client(client);
    if (control->ender == client && control->open)
        call_shutdown(control);
    for (struct control_client **at = &control->clients; *at; at = &(*at)->next) {
        if (*at == client) {
            *at = client->next;
            control->client_count--;
            if (control->open)
                control->calls.presence(control->calls.context);
            break;
        }
    }
}

/* Tell a client beyond the limit so, and close its connection. */
static void refuse_client(struct control_client *client)
{
    struct refusal refusal;
    refuse(&refusal, REFUSED_STATE, "too many clients: expected at most %u at a time", CONTROL_CLIENTS);
    control_refuse(client, json_null(), &refusal);
    connection_flush(&client->connection);
    connection_close(&client->connection);
}

/* The connection is the first member of its client. */
static struct control_client *client_of(const struct connection *connection)
{
    return (struct control_client *)connection;
}

static bool on_line(struct connection *connection, const char *line, size_t length)
{
    return control_handle_line(client_of(connection), line, length);
}

static void on_bad_line(struct connection *connection, int code, const char *text)
{
    control_refuse_line(client_of(connection), code, text);
}

static bool is_held(const struct connection *connection)
{
    return client_of(connection)->advance || client_of(connection)->restores;
}

static bool is_expecting(const struct connection *connection)
{
    const struct control_client *client = client_of(connection);
    return client->calls || client->restores || client->subscriptions;
}

static bool is_queued(const struct connection *connection)
{
    return client_of(connection)->control->working;
}

static void on_lines_left(struct connection *connection)
{
    control_schedule_lines(client_of(connection)->control);
}

static void on_leaving(struct connection *connection)
{
    start_checking(client_of(connection)->control);
}

static void on_flushed(struct connection *connection)
{
    control_time_continue(client_of(connection));
}

static void on_gone(struct connection *connection)
{
    remove_client(client_of(connection));
}

static void on_closed(struct connection *connection)
{
    free(client_of(connection));
}

static const struct connection_calls connection_calls = {
    .handle_line = on_line,
    .refuse = on_bad_line,
    .is_held = is_held,
    .is_expecting = is_expecting,
    .is_queued = is_queued,
    .more = on_lines_left,
    .leaving = on_leaving,
    .flushed = on_flushed,
    .gone = on_gone,
    .closed = on_closed,
};

/* Returns NULL if out of memory, or there is no client. */
static struct control_client *accept_client(struct control *control, uv_stream_t *listener)
{
    struct control_client *client = calloc(1, sizeof *client);
    if (!client)
        return NULL;
    client->control = control;
    return connection_accept(&client->connection, control->loop, listener, &connection_calls) ? client : NULL;
}

static void on_connection(uv_stream_t *listener, int status)
{
    struct control *control = listener->data;
    struct control_client *client = status == 0 ? accept_client(control, listener) : NULL;
    if (!client)
        return;
    if (control->client_count == CONTROL_CLIENTS) {
        refuse_client(client);
        return;
    }
    client->next = control->clients;
    control->clients = client;
    control->client_count++;
    control->calls.presence(control->calls.context);
    connection_start(&client->connection);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool listen_at(struct control *control, int fd)
{
    int error = uv_pipe_open(&control->listener, fd);
    if (error == 0)
        error = uv_listen((uv_stream_t *)&control->listener, BACKLOG, on_connection);
    if (error != 0)
        log_error("cannot listen at the control socket %s: %s", control->socket.path, uv_strerror(error));
    return error == 0;
}

static void make_handles(struct control *control)
{
    uv_prepare_init(control->loop, &control->turn);
    uv_idle_init(control->loop, &control->work);
    uv_idle_init(control->loop, &control->restoring);
    uv_timer_init(control->loop, &control->check);
    uv_timer_init(control->loop, &control->ending);
    control->turn.data = control->work.data = control->restoring.data = control->check.data = control->ending.data = control;
    control->open = true;
    uv_prepare_start(&control->turn, on_turn);
    uv_unref((uv_handle_t *)&control->turn);
}

static void on_listener_closed(uv_handle_t *listener)
{
    free(listener->data);
}

struct control *control_open(uv_loop_t *loop, const char *path, struct bus *const *buses, unsigned lines,
                             const struct control_calls *calls)
{
    struct control *control = calloc(1, sizeof *control);
    if (!control) {
        log_error("out of memory");
        return NULL;
    }
    control->loop = loop;
    control->buses = buses;
    control->lines = lines;
    control->calls = *calls;
    if (!control_socket_open(&control->socket, path)) {
        free(control);
        return NULL;
    }
    uv_pipe_init(loop, &control->listener, 0);
    control->listener.data = control;
    if (!listen_at(control, control->socket.fd)) {
        control_socket_release(&control->socket);
        uv_close((uv_handle_t *)&control->listener, on_listener_closed);
        return NULL;
    }
    make_handles(control);
    return control;
}

const char *control_path(const struct control *control)
{
    return control ? control->socket.path : NULL;
}

unsigned control_clients(const struct control *control)
{
    return control ? control->client_count : 0;
}

void control_close(struct control *control)
{
    if (!control || !control->open)
        return;
    control->open = false;
    control_socket_release(&control->socket);
    while (control->clients)
        connection_close(&control->clients->connection);
    control_trace_end(control);
    uv_close((uv_handle_t *)&control->listener, NULL);
    uv_close((uv_handle_t *)&control->turn, NULL);
    uv_close((uv_handle_t *)&control->work, NULL);
    uv_close((uv_handle_t *)&control->restoring, NULL);
    uv_close((uv_handle_t *)&control->check, NULL);
    uv_close((uv_handle_t *)&control->ending, NULL);
}

void control_free(struct control *control)
{
    free(control);
}
