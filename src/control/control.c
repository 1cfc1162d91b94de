/* SPDX-License-Identifier: MIT */
#include "control.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "control_inside.h"
#include "line/line.h"

#define BACKLOG 128
#define BUDGET 500000u   /* ns a turn of the loop for the lines of all clients; a unit waits no longer */
#define LOOK_MS 200      /* how soon it is noticed that a client which had ended its sending has gone */
#define ENDING_MS 1000   /* how long the answer to shutdown waits to be read */

/* ---- Turns of the loop ---------------------------------------------------------------------------------------------- */

static void end_now(struct control *control)
{
    control->ender = NULL;
    control->calls.shutdown(control->calls.context);
}

static void on_turn(uv_prepare_t *handle)
{
    struct control *control = handle->data;
    for (struct control_client *client = control->clients, *next; client; client = next) {
        next = client->next;
        peer_pump(&client->peer);
    }
    if (control->ender && peer_queue(&control->ender->peer) == 0)
        end_now(control);
}

static void on_ending(uv_timer_t *handle)
{
    struct control *control = handle->data;
    if (control->ender)
        end_now(control);
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
        client->peer.blocked = false;
        if (peer_serve(&client->peer, BUDGET / count))
            more = true;
    }
    if (more || !control->working)
        return;
    control->working = false;
    uv_idle_stop(&control->work);
}

void control_work(struct control *control)
{
    if (!control->open)
        return;
    control->working = true;
    uv_idle_start(&control->work, on_work);
}

static void on_look(uv_timer_t *handle)
{
    struct control *control = handle->data;
    bool more = false;
    for (struct control_client *client = control->clients, *next; client; client = next) {
        next = client->next;
        if (client->peer.leaving && peer_gone(&client->peer))
            peer_close(&client->peer);
        else
            more = more || client->peer.leaving;
    }
    if (!more)
        uv_timer_stop(&control->look);
}

static void look_for_gone(struct control *control)
{
    if (control->open && !uv_is_active((uv_handle_t *)&control->look))
        uv_timer_start(&control->look, on_look, LOOK_MS, LOOK_MS);
}

/* ---- Clients -------------------------------------------------------------------------------------------------------- */

static void forget(struct control_client *client)
{
    struct control *control = client->control;
    control_time_forget(client);
    control_subscribe_forget(client);
    control_restore_forget(client);
    if (control->ender == client && control->open)
        end_now(control);
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

/* One too many is told so, and let go. */
static void turn_away(struct control_client *client)
{
    struct refusal refusal;
    refuse(&refusal, REFUSED_STATE, "too many clients: expected at most %u at a time", CONTROL_CLIENTS);
    control_refuse(client, json_null(), &refusal);
    peer_pump(&client->peer);
    peer_close(&client->peer);
}

/* The peer is the first member of its client. */
static struct control_client *client_of(const struct peer *peer)
{
    return (struct control_client *)peer;
}

static bool on_line(struct peer *peer, const char *line, size_t length)
{
    return control_obey(client_of(peer), line, length);
}

static void on_bad_line(struct peer *peer, int code, const char *text)
{
    control_refuse_line(client_of(peer), code, text);
}

static bool is_held(const struct peer *peer)
{
    return client_of(peer)->advance || client_of(peer)->restores;
}

static bool is_expecting(const struct peer *peer)
{
    const struct control_client *client = client_of(peer);
    return client->calls || client->restores || client->subscriptions;
}

static bool is_queued(const struct peer *peer)
{
    return client_of(peer)->control->working;
}

static void on_more(struct peer *peer)
{
    control_work(client_of(peer)->control);
}

static void on_leaving(struct peer *peer)
{
    look_for_gone(client_of(peer)->control);
}

static void on_pumped(struct peer *peer)
{
    control_time_go_on(client_of(peer));
}

static void on_gone(struct peer *peer)
{
    forget(client_of(peer));
}

static void on_closed(struct peer *peer)
{
    free(client_of(peer));
}

static const struct peer_calls peer_calls = {
    .obey = on_line,
    .refuse = on_bad_line,
    .is_held = is_held,
    .is_expecting = is_expecting,
    .is_queued = is_queued,
    .more = on_more,
    .leaving = on_leaving,
    .pumped = on_pumped,
    .gone = on_gone,
    .closed = on_closed,
};

/* Returns NULL if out of memory, or nobody is there. */
static struct control_client *accept_client(struct control *control, uv_stream_t *listener)
{
    struct control_client *client = calloc(1, sizeof *client);
    if (!client)
        return NULL;
    client->control = control;
    return peer_accept(&client->peer, control->loop, listener, &peer_calls) ? client : NULL;
}

static void on_connection(uv_stream_t *listener, int status)
{
    struct control *control = listener->data;
    struct control_client *client = status == 0 ? accept_client(control, listener) : NULL;
    if (!client)
        return;
    if (control->client_count == CONTROL_CLIENTS) {
        turn_away(client);
        return;
    }
    client->next = control->clients;
    control->clients = client;
    control->client_count++;
    control->calls.presence(control->calls.context);
    peer_start(&client->peer);
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
    uv_timer_init(control->loop, &control->look);
    uv_timer_init(control->loop, &control->ending);
    control->turn.data = control->work.data = control->restoring.data = control->look.data = control->ending.data = control;
    control->open = true;
    uv_prepare_start(&control->turn, on_turn);
    uv_unref((uv_handle_t *)&control->turn);
}

static void on_abandoned(uv_handle_t *listener)
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
        uv_close((uv_handle_t *)&control->listener, on_abandoned);
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
        peer_close(&control->clients->peer);
    control_trace_end(control);
    uv_close((uv_handle_t *)&control->listener, NULL);
    uv_close((uv_handle_t *)&control->turn, NULL);
    uv_close((uv_handle_t *)&control->work, NULL);
    uv_close((uv_handle_t *)&control->restoring, NULL);
    uv_close((uv_handle_t *)&control->look, NULL);
    uv_close((uv_handle_t *)&control->ending, NULL);
}

void control_free(struct control *control)
{
    free(control);
}
