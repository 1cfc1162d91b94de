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

bool serve_has_option(const char *name)
{
    static const char *const missing[] = {"link", "wine", "ready-fd", "window", "allow-folder", "no-sandbox"};
    for (size_t i = 0; i < sizeof missing / sizeof missing[0]; i++)
        if (strcmp(name, missing[i]) == 0)
            return false;
    return true;
}

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
