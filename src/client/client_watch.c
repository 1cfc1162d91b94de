/* SPDX-License-Identifier: MIT */
#include "client_watch.h"

#include <curses.h>
#include <err.h>
#include <langinfo.h>
#include <locale.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "client_panel.h"
#include "client_port.h"
#include "client_terminal.h"

#define PERIOD_US 100000 /* from frame to frame */
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
    uint64_t next;   /* when to ask again */
    SCREEN *screen;
    bool coloured;
};

static volatile sig_atomic_t told_to_end, resized;

static void on_signal(int number)
{
    if (number == SIGWINCH)
        resized = 1;
    else
        told_to_end = number;
}

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

/* ---- The terminal ----------------------------------------------------------------------------------------------------- */

static const struct {
    attr_t attributes;
    short pair, colour;
} styles[PANEL_STYLES] = {
    [PANEL_PLAIN] = {A_NORMAL, 0, 0},        [PANEL_TITLE] = {A_REVERSE, 0, 0},
    [PANEL_HEAD] = {A_UNDERLINE, 0, 0},      [PANEL_LIT] = {A_BOLD, 1, COLOR_GREEN},
    [PANEL_DARK] = {A_NORMAL, 0, 0},         [PANEL_WRONG] = {A_BOLD, 2, COLOR_RED},
};

/* Take the terminal over. Returns false if it cannot be used (reported). */
static bool open_screen(struct watching *w)
{
    const char *no_color = getenv("NO_COLOR");
    w->screen = client_terminal_is_usable() ? newterm(NULL, stdout, stdin) : NULL;
    if (w->screen == NULL)
        return false;
    cbreak();
    noecho();
    nonl();
    keypad(stdscr, TRUE);
    nodelay(stdscr, TRUE);
    curs_set(0);
    w->coloured = has_colors() && (no_color == NULL || no_color[0] == '\0') && start_color() == OK && use_default_colors() == OK;
    for (size_t i = 0; w->coloured && i < PANEL_STYLES; i++) {
        if (styles[i].pair > 0)
            init_pair(styles[i].pair, styles[i].colour, -1);
    }
    w->job->rpc.quiet = true;
    return true;
}

static void close_screen(struct watching *w)
{
    endwin();
    delscreen(w->screen);
    w->job->rpc.quiet = false;
    if (w->job->rpc.trouble[0] != '\0')
        warnx("%s", w->job->rpc.trouble);
}

static void draw(const struct watching *w)
{
    static struct panel panel;
    struct panel_view view = make_view(w, json_array_size(w->units) > 1 ? KEYS_UNITS : KEYS);
    erase();
    client_panel_draw(&panel, &view, LINES, COLS);
    for (int row = 0; row < panel.rows; row++) {
        for (int column = 0; column < panel.columns; column++) {
            const struct panel_cell *cell = &panel.cell[row][column];
            wchar_t text[2] = {cell->character, L'\0'};
            cchar_t character;
            short pair = w->coloured ? styles[cell->style].pair : 0;
            setcchar(&character, text, styles[cell->style].attributes, pair, NULL);
            mvadd_wch(row, column, &character);
        }
    }
    refresh();
}

/* The terminal has another size. Everything is painted again: what it showed may be gone, even if the size is what it was. */
static void resize_screen(const struct watching *w)
{
    struct winsize size;
    resized = 0;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0)
        resizeterm(size.ws_row, size.ws_col);
    clearok(curscr, TRUE);
    draw(w);
}

/* ---- The loop --------------------------------------------------------------------------------------------------------- */

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
    int key;
    while ((key = getch()) != ERR) {
        switch (key) {
        case 'q':
        case 'Q':
            return false;
        case '\t':
        case 'n':
        case KEY_RIGHT:
        case KEY_DOWN:
            select_unit(w, 1);
            break;
        case KEY_BTAB:
        case 'p':
        case KEY_LEFT:
        case KEY_UP:
            select_unit(w, json_array_size(w->units) - 1);
            break;
        case '\f':
            resize_screen(w);
            break;
        default:
            break;
        }
    }
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
        w->next = client_now() + PERIOD_US;
    }
    return CLIENT_RPC_NOTHING;
}

/* Wait for a key, an answer, or the next frame. Returns false if the terminal has gone. */
static bool wait_for_input(const struct watching *w)
{
    struct pollfd ready[] = {{.fd = STDIN_FILENO, .events = POLLIN}, {.fd = w->job->rpc.fd, .events = POLLIN}};
    uint64_t now = client_now();
    int left = w->asked ? 1000 : w->next > now ? (int)((w->next - now) / 1000u) + 1 : 0;
    poll(ready, 2, left);
    return (ready[0].revents & (POLLHUP | POLLERR | POLLNVAL)) == 0;
}

static enum exit_status show_live(struct watching *w)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGWINCH};
    struct sigaction action = {.sa_handler = on_signal};
    enum client_rpc_outcome outcome = CLIENT_RPC_NOTHING;
    json_t *json = NULL;
    for (size_t i = 0; i < sizeof signals / sizeof *signals; i++)
        sigaction(signals[i], &action, NULL);
    if (!open_screen(w))
        return STATUS_FAILURE;
    while (told_to_end == 0 && (outcome = update_state(w, &json)) == CLIENT_RPC_NOTHING && wait_for_input(w) && handle_keys(w)) {
        if (resized)
            resize_screen(w);
    }
    close_screen(w);
    enum exit_status status = outcome == CLIENT_RPC_NOTHING ? STATUS_SUCCESS : client_job_outcome(w->job, outcome, json);
    json_decref(json);
    if (told_to_end != 0 && told_to_end != SIGINT) { /* Ctrl-C is as good as q; by the others one is ended */
        signal(told_to_end, SIG_DFL);
        raise(told_to_end);
    }
    return status;
}

enum exit_status client_watch(struct client_job *job)
{
    struct watching w = {.job = job};
    setlocale(LC_CTYPE, "");
    w.plain = strcmp(nl_langinfo(CODESET), "UTF-8") != 0;
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
