#include "serve_commands.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "log.h"

#define EXPECTED "`power on UNIT' or `power off UNIT', UNIT as in 3 or, on line 2, 2/3"

/* Returns false if the command is none. */
static bool obey(const struct serve_commands *commands, const char *text)
{
    char state[4], unit[NODE_NAME_SIZE];
    unsigned line = 0;
    int end = 0;
    if (sscanf(text, " power %3s %3u/%7s %n", state, &line, unit, &end) != 3 || text[end]) {
        line = 0;
        end = 0;
        if (sscanf(text, " power %3s %7s %n", state, unit, &end) != 2 || end == 0 || text[end])
            return false;
    }
    bool on = strcmp(state, "on") == 0;
    return (on || strcmp(state, "off") == 0) && line < commands->options->lines && bus_power(commands->buses[line], unit, on);
}

static void take_line(struct serve_commands *commands)
{
    commands->line[commands->length] = '\0';
    if (commands->length > 0 && !obey(commands, commands->line))
        log_error("command `%s': expected " EXPECTED, commands->line);
    commands->length = 0;
}

static void on_stdin(uv_poll_t *handle, int status, int events)
{
    struct serve_commands *commands = handle->data;
    char bytes[256];
    (void)status;
    (void)events;
    ssize_t length = read(STDIN_FILENO, bytes, sizeof bytes);
    if (length < 0 && (errno == EAGAIN || errno == EINTR))
        return;
    for (ssize_t i = 0; i < length; i++) {
        if (bytes[i] == '\n')
            take_line(commands);
        else if (commands->length < sizeof commands->line - 1)
            commands->line[commands->length++] = bytes[i] ? bytes[i] : ' ';
    }
    if (length <= 0) { /* whoever gave commands has gone; the units go on */
        take_line(commands);
        uv_poll_stop(handle);
    }
}

bool serve_commands_start(struct serve_commands *commands, uv_loop_t *loop, const struct serve_options *options,
                          struct bus *const *buses)
{
    commands->options = options;
    commands->buses = buses;
    commands->stdin_ready.data = commands;
    int error = uv_poll_init(loop, &commands->stdin_ready, STDIN_FILENO);
    if (error == 0)
        error = uv_poll_start(&commands->stdin_ready, UV_READABLE, on_stdin);
    if (error != 0)
        log_error("--commands: cannot read stdin: %s: expected a pipe or a terminal", uv_strerror(error));
    return error == 0;
}
