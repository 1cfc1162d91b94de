/* SPDX-License-Identifier: MIT */
/* rkm04 lsp: the language server on standard input and output. */
#include <argp.h>
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <unistd.h>

#include "lsp.h"
#include "options/options.h"
#include "text/text.h"

enum option_key { KEY_LANG = 256, KEY_NO_WARN, KEY_STDIO };

static const struct argp_option option_table[] = {
    {"lang", KEY_LANG, "LANGUAGE", 0, "Explain commands in en (the default) or cs, the manual's terms", 0},
    {"no-warn", KEY_NO_WARN, "NAME,...", 0, "Switch warnings off, as in rkm04 check", 0},
    {"stdio", KEY_STDIO, NULL, 0, "Accepted for editors that pass it: there is no other way", 0},
    {0},
};

static const char doc[] =
    "A language server for programs of the RKM04 (.rks) on standard input and output, for editors that speak the Language "
    "Server Protocol: errors and warnings while you type, what a command does, how long a program takes, labels, completion, "
    "layout. docs/EDITORS.md says how to set editors up."
    "\v"
    "Examples:\n"
    "  rkm04 lsp\n"
    "  rkm04 lsp --lang cs --no-warn speed-not-reached\n"
    "\n"
    "Exit status: 0 the editor has ended the session; 1 it has gone without, or what it sends are no messages; 2 wrong usage.";

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct session_options *options = state->input;
    switch (key) {
    case KEY_LANG:
        options->language = explain_language_named(text);
        if (options->language == EXPLAIN_LANGUAGES)
            argp_error(state, "--lang: expected en or cs, found '%s'", text);
        return 0;
    case KEY_NO_WARN:
        no_warn_option_read(&options->off, text, state);
        return 0;
    case KEY_STDIO:
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "expected no argument, found `%s'", text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static bool has_input(void)
{
    struct pollfd in = {.fd = STDIN_FILENO, .events = POLLIN};
    return poll(&in, 1, 0) > 0;
}

/* Handle all messages that are complete. Returns false if there will be no more. */
static bool handle_messages(struct lsp_server *server, struct frame_reader *frames)
{
    const char *text;
    size_t length;
    while (!server->has_exited) {
        switch (frame_next(frames, &text, &length)) {
        case FRAME_NONE:
            return true;
        case FRAME_MESSAGE:
            lsp_receive(server, text, length);
            break;
        case FRAME_TOO_LONG:
            lsp_receive_too_long(server);
            break;
        case FRAME_BROKEN:
            fputs("rkm04 lsp: expected a message with a header Content-Length on standard input\n", stderr);
            return false;
        }
    }
    return false;
}

/* Read and answer until the editor ends the session or goes. */
static void serve(struct lsp_server *server, struct frame_reader *frames)
{
    static char bytes[65536];
    for (;;) {
        const ssize_t got = read(STDIN_FILENO, bytes, sizeof bytes);
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            fprintf(stderr, "rkm04 lsp: cannot read standard input: %s\n", strerror(errno));
        if (got > 0 && !frame_add(frames, bytes, (size_t)got))
            fputs("rkm04 lsp: out of memory\n", stderr);
        else if (got > 0 && handle_messages(server, frames)) {
            bool is_written = fflush(stdout) == 0;
            while (is_written && !has_input() && lsp_report_change(server))
                is_written = fflush(stdout) == 0;
            if (is_written)
                continue;
        }
        return;
    }
}

int lsp_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, NULL, doc, NULL, NULL, NULL};
    static struct lsp_server server;
    struct session_options options = {.language = EXPLAIN_ENGLISH};
    struct frame_reader frames = {0};
    arguments_parse(&argp, argc, argv, &options);
    lsp_begin(&server, &options, stdout);
    serve(&server, &frames);
    const bool ended = server.has_exited && server.is_shut_down;
    lsp_end(&server);
    frame_end(&frames);
    return arguments_printed() != 0 || !ended ? STATUS_FAILURE : STATUS_SUCCESS;
}
