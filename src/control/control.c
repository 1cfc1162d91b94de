/* SPDX-License-Identifier: MIT */
#include "control.h"

#include <stdlib.h>
#include <string.h>

#include "control_inside.h"
#include "control_socket.h"
#include "control_system.h"

#define BACKLOG 128
#define BUDGET 500000u   /* ns a turn of the loop for the lines of all clients; a unit waits no longer */
#define CHECK_MS 200     /* how soon it is noticed that a client which had ended its sending has gone */
#define ENDING_MS 1000   /* how long the answer to shutdown waits to be read */

/* ---- Turns of the loop ---------------------------------------------------------------------------------------------- */

static void call_shutdown(struct control *control)
{
    control->last = control->ender;
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
            connection_forsake(&client->connection);
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
    if (control_door_remove(client))
        return;
    if (control->ender == client && control->open)
        call_shutdown(control);
    if (control->last == client)
        control->last = NULL;
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
    refuse(&refusal, REFUSED_STATE, CONTROL_TOO_MANY, CONTROL_CLIENTS);
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
    struct control_client *client = client_of(connection);
    if (!connection->stranger)
        return control_handle_line(client, line, length);
    control_door_line(client, line, length);
    return true;
}

static void on_bad_line(struct connection *connection, int code, const char *text)
{
    if (connection->stranger)
        control_door_refuse(client_of(connection));
    else
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
    return !connection->stranger && client_of(connection)->control->working;
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

void control_add_client(struct control_client *client)
{
    struct control *control = client->control;
    client->next = control->clients;
    control->clients = client;
    control->client_count++;
    control->calls.presence(control->calls.context);
}

static void on_connection(uv_stream_t *listener, int status)
{
    struct control *control = listener->data;
    struct control_client *client = status == 0 ? accept_client(control, listener) : NULL;
    if (!client)
        return;
    if (client->connection.stranger) {
        control_door_add(client);
    } else if (control->client_count < CONTROL_CLIENTS) {
        control_add_client(client);
    } else {
        refuse_client(client);
        return;
    }
    connection_start(&client->connection);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool is_loopback(const char *digits)
{
    return strncmp(digits, "127.", 4) == 0 || strncmp(digits, "[::1]:", 6) == 0;
}

bool control_tcp_valid(const char *address)
{
    bool port = strchr(address, ':') == NULL || address[0] == ':';
    return net_address_valid(address) && (port || is_loopback(address) || strncmp(address, "localhost:", 10) == 0);
}

/* Listen first: a client that finds the file can use it. */
static bool listen_tcp(struct control *control, const char *path, const char *tcp)
{
    uv_tcp_init(control->loop, &control->listener.tcp);
    const char *wrong = is_loopback(tcp) ? net_listen(&control->listener.tcp, tcp, on_connection, control->address)
                                         : "it is not an address of the loopback interface";
    if (wrong)
        log_error("the control socket cannot listen at %s: %s", tcp, wrong);
    return !wrong && control_file_token(control->token) &&
           control_file_write(&control->place, path, control->address, control->token);
}

static bool listen_unix(struct control *control, const char *path)
{
    uv_pipe_init(control->loop, &control->listener.pipe, 0);
    int fd = control_socket_open(&control->place, path);
    if (fd < 0)
        return false;
    int error = uv_pipe_open(&control->listener.pipe, fd);
    if (error == 0)
        error = uv_listen(&control->listener.stream, BACKLOG, on_connection);
    if (error == 0)
        return true;
    log_error("cannot listen at the control socket %s: %s", path, uv_strerror(error));
    control_place_release(&control->place);
    return false;
}

static void make_handles(struct control *control)
{
    uv_prepare_init(control->loop, &control->turn);
    uv_idle_init(control->loop, &control->work);
    uv_idle_init(control->loop, &control->restoring);
    uv_timer_init(control->loop, &control->check);
    uv_timer_init(control->loop, &control->ending);
    uv_timer_init(control->loop, &control->door);
    control->turn.data = control->work.data = control->restoring.data = control->check.data = control->ending.data = control;
    control->door.data = control;
    control->open = true;
    uv_prepare_start(&control->turn, on_turn);
    uv_unref((uv_handle_t *)&control->turn);
}

static void on_listener_closed(uv_handle_t *listener)
{
    free(listener->data);
}

struct control *control_open(uv_loop_t *loop, const char *path, const char *tcp, struct bus *const *buses, unsigned lines,
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
    control->place.lock = -1;
    if (!tcp)
        tcp = control_system_instead();
    bool ok = tcp ? listen_tcp(control, path, tcp) : listen_unix(control, path);
    control->listener.handle.data = control;
    if (!ok) {
        uv_close(&control->listener.handle, on_listener_closed);
        return NULL;
    }
    make_handles(control);
    return control;
}

const char *control_path(const struct control *control)
{
    return control ? control->place.path : NULL;
}

const char *control_address(const struct control *control)
{
    return control && control->address[0] ? control->address : NULL;
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
    control_place_release(&control->place);
    struct control_client *last = control->last;
    if (last && !last->connection.closing)
        connection_abandon(&last->connection);
    control->last = last;
    while (control->clients)
        connection_close(&control->clients->connection);
    while (control->strangers)
        connection_close(&control->strangers->connection);
    control_trace_end(control);
    uv_close(&control->listener.handle, NULL);
    uv_close((uv_handle_t *)&control->turn, NULL);
    uv_close((uv_handle_t *)&control->work, NULL);
    uv_close((uv_handle_t *)&control->restoring, NULL);
    uv_close((uv_handle_t *)&control->check, NULL);
    uv_close((uv_handle_t *)&control->ending, NULL);
    uv_close((uv_handle_t *)&control->door, NULL);
}

void control_hang_up(struct control *control)
{
    if (control && control->last)
        connection_hang_up(&control->last->connection);
}

void control_free(struct control *control)
{
    free(control);
}
