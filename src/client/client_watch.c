/* SPDX-License-Identifier: MIT */
#include "client_watch.h"

#include <err.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "client_panel.h"
#include "client_port.h"
#include "client_screen.h"

#define PERIOD_US 100000  /* from frame to frame */
#define SILENCE_US 2000000 /* a state that is older is not taken for the present one */
#define TEXT_COLUMNS 100 /* of --once */
#define KEYS "q quit"
#define KEYS_UNITS "q quit   Tab, Shift-Tab: next unit, the one before"

struct watching {
    struct client_job *job;
    json_t *units;   /* their names */
    size_t shown;    /* which of them */
    json_t *state;   /* of that; NULL: not yet */
    bool asked;      /* for the state, not yet answered */
    bool plain;      /* nothing but ASCII */
    uint64_t since;  /* when it was */
    uint64_t next;   /* when to ask again */
};

/* ---- The units -------------------------------------------------------------------------------------------------------- */

static const char *shown_unit(const struct watching *w)
{
    return json_string_value(json_array_get(w->units, w->shown));
}

/* Get the names of the units and find the one to begin with. */
static enum exit_status find_units(struct watching *w)
{
    json_t *result;
    enum exit_status status = client_job_call(w->job, "units", NULL, false, &result);
    if (status != STATUS_SUCCESS)
        return status;
    w->units = json_incref(json_object_get(result, "units"));
    json_decref(result);
    if (w->job->unit == NULL)
        return STATUS_SUCCESS;
    for (w->shown = 0; w->shown < json_array_size(w->units); w->shown++) {
        const char *name = shown_unit(w);
        if (name != NULL && strcmp(name, w->job->unit) == 0)
            return STATUS_SUCCESS;
    }
    return client_usage("unknown unit %s: `rkmctl call units' lists the units", w->job->unit);
}

static json_t *state_params(const struct watching *w)
{
    json_t *params = json_object();
    if (shown_unit(w) != NULL)
        json_object_set_new(params, "unit", json_string(shown_unit(w)));
    return client_job_params(w->job, params, false);
}

static struct panel_view make_view(const struct watching *w, const char *keys)
{
    return (struct panel_view){.state = w->state, .units = w->units, .keys = keys, .round = !w->plain};
}

/* ---- Once ------------------------------------------------------------------------------------------------------------- */

static enum exit_status show_once(struct watching *w)
{
    static struct panel panel;
    enum exit_status status = client_job_call(w->job, "state", state_params(w), false, &w->state);
    if (status != STATUS_SUCCESS)
        return status;
    if (w->job->json)
        return client_print_json(json_incref(w->state));
    w->plain = true;
    struct panel_view view = make_view(w, NULL);
    client_panel_draw(&panel, &view, PANEL_ROWS, TEXT_COLUMNS);
    client_panel_print(&panel, stdout);
    return STATUS_SUCCESS;
}

/* ---- Live ------------------------------------------------------------------------------------------------------------- */

/* Has the emulator been asked and not answered for so long that it is to be seen? */
static bool is_silent(const struct watching *w)
{
    return w->asked && client_now() - w->since >= SILENCE_US;
}

static void draw(const struct watching *w)
{
    static struct panel panel;
    char silence[80];
    const char *keys = json_array_size(w->units) > 1 ? KEYS_UNITS : KEYS;
    snprintf(silence, sizeof silence, "no answer for %u s   %s", (unsigned)((client_now() - w->since) / 1000000u), keys);
    struct panel_view view = make_view(w, is_silent(w) ? silence : keys);
    int rows, columns;
    client_screen_size(&rows, &columns);
    client_panel_draw(&panel, &view, rows, columns);
    client_screen_draw(&panel);
}

static void select_unit(struct watching *w, size_t step)
{
    size_t count = json_array_size(w->units);
    if (count < 2)
        return;
    w->shown = (w->shown + step) % count;
    w->next = 0; /* at once */
}

/* Obey what has been pressed. Returns false if that is to end. */
static bool handle_keys(struct watching *w)
{
    int rows, columns;
    for (enum client_key key; (key = client_screen_key()) != CLIENT_KEY_NONE;) {
        if (key == CLIENT_KEY_QUIT)
            return false;
        if (key == CLIENT_KEY_NEXT)
            select_unit(w, 1);
        if (key == CLIENT_KEY_BEFORE)
            select_unit(w, json_array_size(w->units) - 1);
    }
    if (client_screen_size(&rows, &columns) || is_silent(w))
        draw(w);
    return true;
}

/* Ask for the state when it is time, and show it when it has come. */
static enum client_rpc_outcome update_state(struct watching *w, json_t **json)
{
    struct client_rpc *rpc = &w->job->rpc;
    *json = NULL;
    if (w->asked) {
        enum client_rpc_outcome outcome = client_rpc_receive(rpc, 0, json);
        if (outcome != CLIENT_RPC_RESULT)
            return outcome;
        w->asked = false;
        json_decref(w->state);
        w->state = *json;
        *json = NULL;
        draw(w);
    }
    if (!w->asked && client_now() >= w->next) {
        if (!client_rpc_send(rpc, "state", state_params(w)))
            return CLIENT_RPC_LOST;
        w->asked = true;
        w->since = client_now();
        w->next = w->since + PERIOD_US;
    }
    return CLIENT_RPC_NOTHING;
}

/* Wait for a key, an answer, or the next frame. Returns false if it is to end. */
static bool wait_for_input(const struct watching *w)
{
    uint64_t now = client_now();
    return client_screen_wait(w->job->rpc.fd, w->asked ? 1000 : w->next > now ? (int)((w->next - now) / 1000u) + 1 : 0);
}

static enum exit_status show_live(struct watching *w)
{
    enum client_rpc_outcome outcome = CLIENT_RPC_NOTHING;
    json_t *json = NULL;
    if (!client_screen_open())
        return STATUS_FAILURE;
    w->job->rpc.quiet = true;
    while ((outcome = update_state(w, &json)) == CLIENT_RPC_NOTHING && wait_for_input(w) && handle_keys(w))
        ;
    client_screen_close();
    w->job->rpc.quiet = false;
    if (w->job->rpc.trouble[0] != '\0')
        warnx("%s", w->job->rpc.trouble);
    enum exit_status status = outcome == CLIENT_RPC_NOTHING ? STATUS_SUCCESS : client_job_outcome(w->job, outcome, json);
    json_decref(json);
    client_screen_raise();
    return status;
}

enum exit_status client_watch(struct client_job *job)
{
    struct watching w = {.job = job, .plain = client_screen_is_plain()};
    bool live = !job->once && !job->json;
    if (live && (!isatty(STDIN_FILENO) || !isatty(STDOUT_FILENO)))
        return client_usage("watch: expected a terminal on standard input and output; --once prints one picture as text");
    enum exit_status status = find_units(&w);
    if (status == STATUS_SUCCESS)
        status = live ? show_live(&w) : show_once(&w);
    json_decref(w.units);
    json_decref(w.state);
    return status;
}
