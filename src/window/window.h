/* SPDX-License-Identifier: MIT */
/* window.h: the service program's window in a browser (docs/WINDOW.md): an HTTP server of one user; the face of the room.
 *
 *     window_command    the command line
 *     window_system     what differs between systems: signals, the browser, how a request is cancelled
 *     window_server     HTTP: pages, who may come in, WebSocket connections
 *     window_page       one open page: its messages in and out, their limits
 *     window_requests   what a page can ask for
 *     window_port       the port of the units: one job after the other, in a thread
 *     window_folder     files for downloads
 *     window_ports      the ports there are
 *     window_devices    serial devices of the machine
 *     window_tools      check, format, explain, estimate for the editor, in a thread
 *     window_control    connections to the control socket of an emulator
 *     window_watch      the state of its units, as often as something changes
 *
 * One event loop; whatever may block is done in a thread. */
#ifndef RKM04_WINDOW_H
#define RKM04_WINDOW_H

#include <stdbool.h>

#include "text/text.h"

struct window_options {
    const char *http;    /* ADDRESS:PORT; port 0: any that is free */
    const char *port;    /* of units, opened at the start; NULL: none */
    const char *control; /* of an emulator; NULL: none */
    unsigned timeout_ms; /* how long an answer of a unit is waited for if the page does not say, 1 to 60000 */
    bool open;           /* show the page in the user's browser */
    bool bound;          /* begin when a byte comes on stdin, end when stdin ends: with the process that started this one */
};

/* Serve the window until a signal ends it. A line "WINDOW http://…" on stdout says where. Returns the exit status. */
enum exit_status window_run(const struct window_options *options);

/* The command line of `rkmctl window': argv[0] is its name. Returns the exit status. */
enum exit_status window_command(int argc, char **argv);

#endif
