/* SPDX-License-Identifier: MIT */
/* rkm04-window: the service program's window, in a browser; `rkmctl window' and `rkm04 serve --window' start it. This file is its
 * command line. */
#include "window/window.h"

#include <argp.h>

#include "options/options.h"

__attribute__((visibility("default"))) const char *argp_program_version = "rkm04-window " RKM04_VERSION;

enum { KEY_HTTP = 0x100, KEY_OPEN, KEY_BOUND };

static const struct argp_option option_table[] = {
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
    "  rkmctl window --open\n"
    "  rkmctl window -p /dev/ttyUSB0\n"
    "  rkmctl window -c $XDG_RUNTIME_DIR/rkm04/bus0.control\n"
    "\n"
    "Exit status: 0 ended by SIGTERM, SIGINT or SIGHUP; 1 the address cannot be served; 2 wrong usage.";

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
        options->bound = true;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "expected no argument, found '%s'", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

int main(int argc, char **argv)
{
    static const struct argp argp = {.options = option_table, .parser = parse_option, .doc = doc};
    struct window_options options = {.http = "127.0.0.1:0"};
    process_begin(argv);
    argp_err_exit_status = STATUS_USAGE;
    arguments_parse(&argp, argc, argv, &options);
    return (int)window_run(&options);
}
