/* SPDX-License-Identifier: MIT */
/* client.h: `rkmctl`; the face of the room.
 *
 *     client_request, client_send, client_answer    requests to a unit over a port, and its answers
 *     client_port, client_link                      the port: pty, device or TCP; one client at a time
 *     client_control*, client_rpc, client_socket    methods of a control socket
 *     client_watch, client_panel                    the front panel in a terminal
 *     client_find                                   the emulators that are running
 *     client_report                                 where messages about ports go
 *     client_pmc*                                   a PMC-1HS or PMC-2HS, over its line or the control socket
 *     client_shell, client_words                    commands line by line, typed or from a file
 *     client_window                                 the window in a browser, a program of its own
 *     client_job, client_usage, client_help         one command line, what is wrong with it, help for a command
 *
 * Knows text formats and the cores, and nothing of the emulator. */
#ifndef RKM04_CLIENT_H
#define RKM04_CLIENT_H

#include "client_control.h"
#include "client_cut.h"
#include "client_find.h"
#include "client_help.h"
#include "client_link.h"
#include "client_pmc.h"
#include "client_port.h"
#include "client_report.h"
#include "client_request.h"
#include "client_rpc.h"
#include "client_shell.h"
#include "client_usage.h"
#include "client_window.h"

#endif
