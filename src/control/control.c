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
    for (struct peer *peer = control->peers, *next; peer; peer = next) {
        next = peer->next;
        peer_pump(peer);
    }
    if (control->ender && peer_queue(control->ender) == 0)
        end_now(control);
}

static void on_ending(uv_timer_t *handle)
{
    struct control *control = handle->data;
    if (control->ender)
        end_now(control);
}

void control_end(struct peer *peer)
{
    struct control *control = peer->control;
    if (control->ender)
        return;
    control->ender = peer;
    uv_timer_start(&control->ending, on_ending, ENDING_MS, 0);
}

/* Lines that could not be dealt with at once, each client in its turn. */
static void on_work(uv_idle_t *handle)
{
    struct control *control = handle->data;
    unsigned count = control->clients > 0 ? control->clients : 1;
    bool more = false;
    for (struct peer *peer = control->peers, *next; peer; peer = next) {
        next = peer->next;
        peer->blocked = false;
        if (peer_serve(peer, BUDGET / count))
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
    for (struct peer *peer = control->peers, *next; peer; peer = next) {
        next = peer->next;
        if (peer->leaving && peer_gone(peer))
            peer_close(peer);
        else
            more = more || peer->leaving;
    }
    if (!more)
        uv_timer_stop(&control->look);
}

void control_look(struct control *control)
{
    if (control->open && !uv_is_active((uv_handle_t *)&control->look))
        uv_timer_start(&control->look, on_look, LOOK_MS, LOOK_MS);
}

/* ---- Clients -------------------------------------------------------------------------------------------------------- */

void control_forget(struct peer *peer)
{
    struct control *control = peer->control;
    control_time_forget(peer);
    control_subscribe_forget(peer);
    control_restore_forget(peer);
    if (control->ender == peer && control->open)
        end_now(control);
    for (struct peer **at = &control->peers; *at; at = &(*at)->next) {
        if (*at == peer) {
            *at = peer->next;
            control->clients--;
            if (control->open)
                control->calls.presence(control->calls.context);
            break;
        }
    }
}

/* One too many is told so, and let go. */
static void turn_away(struct peer *peer)
{
    struct refusal refusal;
    refuse(&refusal, REFUSED_STATE, "too many clients: expected at most %u at a time", CONTROL_CLIENTS);
    control_refuse(peer, json_null(), &refusal);
    peer_pump(peer);
    peer_close(peer);
}

static void on_connection(uv_stream_t *listener, int status)
{
    struct control *control = listener->data;
    struct peer *peer = status == 0 ? peer_accept(control, listener) : NULL;
    if (!peer)
        return;
    if (control->clients == CONTROL_CLIENTS) {
        turn_away(peer);
        return;
    }
    peer->next = control->peers;
    control->peers = peer;
    control->clients++;
    control->calls.presence(control->calls.context);
    peer_start(peer);
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
    return control ? control->clients : 0;
}

void control_close(struct control *control)
{
    if (!control || !control->open)
        return;
    control->open = false;
    control_socket_release(&control->socket);
    while (control->peers)
        peer_close(control->peers);
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
