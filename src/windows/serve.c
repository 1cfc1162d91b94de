/* SPDX-License-Identifier: MIT */
/* serve.c: what `rkm04 serve' has of the process on Windows, and what it does not have. */
#include <signal.h>
#include <string.h>

#include "serve/notify.h"
#include "serve/serve_process.h"
#include "serve/serve_sandbox.h"
#include "serve/serve_window.h"

#define FILES_MAX 2048u /* of the C library */
#define FILES_SPARE 48u /* standard streams, streams in memory, reports, the control file, files of control clients */

/* Ctrl-C, Ctrl-Break, and the console that is closed. */
const int serve_signals[SERVE_SIGNALS] = {SIGINT, SIGBREAK, SIGHUP};

bool serve_signal_ends(int number)
{
    (void)number;
    return true;
}

const char *serve_signal_name(int number)
{
    return number == SIGINT ? "Ctrl-C" : number == SIGBREAK ? "Ctrl-Break" : "the end of its console";
}

const char *serve_option_text(const char *name, const char *text)
{
    static const struct {
        const char *name, *text; /* NULL: Windows has nothing for it */
    } other[] = {
        {"link", NULL},
        {"wine", NULL},
        {"ready-fd", NULL},
        {"window", NULL},
        {"allow-folder", NULL},
        {"no-sandbox", NULL},
        {"port", "Use this COM port, as in COM3"},
        {"rts", "What switches an RS485 adapter between sending and receiving: driver (default), the adapter itself; toggles: "
                "the emulator, which switches RTS on while it sends"},
        {"tcp", "Offer the bus over TCP as plain bytes; default host 127.0.0.1, port 0: a free one"},
        {"lines", "Number of buses, 1 to 256, each with all these units and a TCP port (PORT, PORT+1, ...) of its own; "
                  "default 1"},
        {"control", "TCP port of this machine to read and change the state of all units (JSON-RPC; rkmctl --control), 0: a "
                    "free one (default); PATH: the file with its address and a token, for clients; default: a name from the "
                    "port or address, in %LOCALAPPDATA%\\rkm04"},
    };
    for (size_t i = 0; i < sizeof other / sizeof other[0]; i++)
        if (strcmp(name, other[i].name) == 0)
            return other[i].text;
    return text;
}

const char serve_ended_by[] = "Ctrl-C, Ctrl-Break or the end of its console";

const char serve_examples[] =
    "  rkm04 serve --tcp 4000 --rfc2217 4001\n"
    "  rkm04 serve --port COM3 --framing plain\n"
    "  rkm04 serve --tcp 4000 --node 1,2,5-8 --flash unit%n.flash\n"
    "  rkm04 serve --tcp 4000 --clock x20 --baud 0\n"
    "  rkm04 serve --tcp 4000 --readings hold-exit=latch,speed-change=500ms\n"
    "  rkm04 serve --tcp 0 --clock stepped --control test.control --plant axis.yaml\n"
    "  rkm04 serve --tcp 4000 --trace pulses.vcd --wire line.pcapng --record session.record\n"
    "  rkm04 serve --port COM3 --exit-when-idle=2 --coverage covered.txt --min-coverage 80\n";

/* Sockets are handles, of which there are as many as there is memory; files are descriptors of the C library. */
bool serve_allow_files(const struct bus_options *options)
{
    unsigned line = (options->record != NULL) + (options->flash ? options->nodes.count : 0);
    for (unsigned i = 0; i < BUS_FILES_MAX; i++)
        line += (unsigned)(options->trace[i] != NULL) + (options->wire[i] != NULL);
    _setmaxstdio(FILES_MAX);
    if (options->lines * line + FILES_SPARE <= FILES_MAX)
        return true;
    log_error("too many files: %u, expected at most %u", options->lines * line, FILES_MAX - FILES_SPARE);
    return false;
}

/* A process of Windows keeps the rights of its user. */
void serve_sandbox_files(const struct bus_options *options, struct bus *const *buses, const char *control)
{
    (void)options;
    (void)buses;
    (void)control;
}

void serve_sandbox_calls(const struct bus_options *options)
{
    (void)options;
}

int notify_fd_read(const char *text)
{
    (void)text;
    return -1;
}

bool notify_ready(int fd, const char *text, const char *status)
{
    (void)fd;
    (void)text;
    (void)status;
    return true;
}

void notify_stopping(void)
{
}

int serve_window_start(const char *control, const char *address)
{
    (void)control;
    (void)address;
    return -1;
}

void serve_window_show(int descriptor)
{
    (void)descriptor;
}
