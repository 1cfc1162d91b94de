/* SPDX-License-Identifier: MIT */
/* window_command.c: the command line of the window. */
#include "window.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>

#include "client/client.h"
#include "options/options.h"
#include "window_requests.h"
#include "window_system.h"

enum { KEY_HTTP = 0x100, KEY_OPEN, KEY_BOUND };

static const struct argp_option table[] = {
    {"port", 'p', "PORT", 0,
     "Open this port at the start: serial device, pseudo terminal, or tcp:HOST:PORT; otherwise choose one in the page", 0},
    {"control", 'c', "PATH", 0, "Show the units of the emulator with this control socket", 0},
    {"http", KEY_HTTP, "ADDRESS:PORT", 0, "Where to serve the page (default 127.0.0.1:0; port 0: any that is free)", 0},
    {"open", KEY_OPEN, NULL, 0, "Open the page in the browser", 0},
    {"bound", KEY_BOUND, NULL, OPTION_HIDDEN, "Begin when a byte comes on stdin; end when stdin ends", 0},
    {0},
};

static const char doc[] =
    "Serve the service program's window to a browser on this machine, for real and virtual units. Started as `rkmctl window'. "
    "The address is printed as WINDOW http://...; whoever has its token can use the window."
    "\v"
    "Examples:\n"
    "%s"
    "\n"
    "Exit status: 0 ended by %s; 1 the address cannot be served; 2 wrong usage.";

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct window_options *options = state->input;
    switch (key) {
    case 'p':
        options->port = text;
        return 0;
    case 'c':
        options->control = text;
        return 0;
    case KEY_HTTP:
        options->http = text;
        return 0;
    case KEY_OPEN:
        options->open = true;
        return 0;
    case KEY_BOUND:
        if (window_option_text("bound", "") == NULL)
            argp_error(state, "--bound: not in the program for this system");
        options->bound = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "expected no argument, found '%s'", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

enum exit_status window_command(int argc, char **argv)
{
    static struct argp_option options[sizeof table / sizeof table[0]];
    char help[1024];
    struct argp argp = {.options = options, .parser = parse_option, .doc = help};
    const char *usual = getenv("RKM04_TIMEOUT");
    struct window_options wanted = {.http = "127.0.0.1:0", .timeout_ms = WINDOW_TIMEOUT_MS};
    snprintf(help, sizeof help, doc, window_examples, window_ended_by);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        options[i] = table[i];
        if (table[i].name != NULL)
            options[i].doc = window_option_text(table[i].name, table[i].doc);
    }
    argp_err_exit_status = STATUS_USAGE;
    arguments_parse(&argp, argc, argv, &wanted);
    if (usual != NULL && usual[0] != '\0' &&
        !client_usage_number("RKM04_TIMEOUT", usual, 1, WINDOW_TIMEOUT_MS_MAX, &wanted.timeout_ms))
        return STATUS_USAGE;
    return window_run(&wanted);
}
