/* SPDX-License-Identifier: MIT */
#include "client_shell.h"

#include <err.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <rkm04/limits.h>

#include "client_control.h"
#include "client_find.h"
#include "client_help.h"
#include "client_pmc.h"
#include "client_request.h"
#include "client_typing.h"
#include "client_usage.h"
#include "client_words.h"
#include "text/text.h"

#define OPTIONS_MAX 12
#define PROMPT_SIZE 56

#define LINE_SIZE (4 * RKM04_MESSAGE_MAX)

struct state {
    struct client_shell shell;
    struct client_found pair;
    unsigned node, motor;
    bool has_node;
    bool is_person;
    bool is_over;
    const char *name; /* of the file, for messages */
    unsigned line;
};

static const char *const own[] = {"node", "motor", "help", "quit", "exit", NULL};

static const char help[] =
    "A line that begins with a small letter is a command, any other is program text for the present motor.\n"
    "  node N        the next lines are for the unit with address N; 0: for all units\n"
    "  motor M       the next lines are for motor M; 0: for all motors\n"
    "  help [NAME]   this text, or help for a command\n"
    "  quit          the same as Ctrl-D\n"
    "  # ...         a comment\n"
    "and every command of rkmctl, with its options:\n ";

/* ---- Commands --------------------------------------------------------------------------------------------------------- */

static enum exit_status report_usage(const struct state *state, const char *text, const char *found)
{
    if (state->is_person)
        fprintf(stderr, "%s, found '%s'\n", text, found);
    else
        fprintf(stderr, "%s:%u: error: %s, found '%s'\n", state->name, state->line, text, found);
    return STATUS_USAGE;
}

/* The arguments of a command line. */
struct line {
    int argc;
    char *argv[OPTIONS_MAX + CLIENT_WORDS_MAX + 1];
    char text[OPTIONS_MAX][PATH_MAX];
};

static void add_option(struct line *line, const char *name, const char *value)
{
    char *text = line->text[line->argc];
    if (value == NULL)
        return;
    snprintf(text, PATH_MAX, "--%s=%s", name, value);
    line->argv[line->argc++] = text;
}

static void add_number(struct line *line, const char *name, unsigned value)
{
    char text[16];
    snprintf(text, sizeof text, "%u", value);
    add_option(line, name, text);
}

static void add_control(struct line *line, const struct client_shell *shell)
{
    add_option(line, "control", shell->control);
    add_option(line, "unit", shell->unit);
    if (shell->line >= 0)
        add_number(line, "line", (unsigned)shell->line);
}

/* pmc goes by either: the control socket can do more, but --face says what a port speaks. */
static void add_pmc(struct line *line, const struct client_shell *shell)
{
    if (shell->control != NULL && shell->face == NULL) {
        add_control(line, shell);
        return;
    }
    add_option(line, "port", shell->port);
    add_option(line, "face", shell->face);
    if (shell->baud > 0)
        add_number(line, "baud", shell->baud);
}

static void add_options(struct line *line, const struct state *state, const char *command)
{
    const struct client_shell *shell = &state->shell;
    line->argv[line->argc++] = (char *)"rkmctl";
    if (state->has_node)
        add_number(line, "node", state->node);
    if (shell->timeout_ms > 0)
        add_number(line, "timeout", shell->timeout_ms);
    if (shell->json)
        line->argv[line->argc++] = (char *)"--json";
    if (client_request_has(command)) {
        add_option(line, "port", shell->port);
        add_option(line, "framing", shell->framing);
        add_number(line, "message-max", shell->message_max);
        add_number(line, "motor", state->motor);
    } else if (strcmp(command, "pmc") == 0) {
        add_pmc(line, shell);
    } else {
        add_control(line, shell);
    }
}

static const char *given_or(const char *option, const char *name)
{
    const char *text = option != NULL ? option : getenv(name);
    return text != NULL && text[0] != '\0' ? text : NULL;
}

/* Where only one of --port and --control was given, the other is that of the same emulator. Returns false if there is none. */
static bool choose_emulator(struct state *state, bool for_port)
{
    struct client_shell *shell = &state->shell;
    const bool has_port = given_or(shell->port, "RKM04_PORT") != NULL;
    const bool has_control = given_or(shell->control, "RKM04_CONTROL") != NULL;
    if (for_port ? has_port || shell->control == NULL : has_control || shell->port == NULL)
        return true;
    if (!client_find_pair(shell->port, for_port ? shell->control : NULL, &state->pair)) {
        warnx("no emulator of yours has the %s %s: expected %s", for_port ? "control socket" : "bus",
              for_port ? shell->control : shell->port, for_port ? "--port" : "--control");
        return false;
    }
    if (for_port && state->pair.port[0] == '\0') {
        warnx("the emulator has several buses: expected --port");
        return false;
    }
    if (for_port)
        shell->port = state->pair.port;
    else
        shell->control = state->pair.control;
    return true;
}

/* Do a command of rkmctl in a process of its own. */
static enum exit_status run(struct state *state, char *const *word, int count)
{
    static struct line line;
    const bool for_port = client_request_has(word[0]);
    if ((for_port || client_control_has(word[0])) && !choose_emulator(state, for_port))
        return STATUS_FAILURE;
    line.argc = 0;
    add_options(&line, state, word[0]);
    for (int i = 0; i < count; i++)
        line.argv[line.argc++] = word[i];
    line.argv[line.argc] = NULL;
    return client_typing_run(state->shell.run, line.argc, line.argv);
}

static enum exit_status set_number(const struct state *state, char *const *word, int count, unsigned high, unsigned *number)
{
    uint64_t value;
    char text[64];
    snprintf(text, sizeof text, "expected a %s 0 to %u", word[0], high);
    if (count != 2 || !number_read(word[1], 0, high, &value))
        return report_usage(state, text, count < 2 ? "nothing" : word[1]);
    *number = (unsigned)value;
    return STATUS_SUCCESS;
}

static enum exit_status choose_node(struct state *state, char *const *word, int count)
{
    enum exit_status status = set_number(state, word, count, RKM04_NODE_MAX, &state->node);
    state->has_node = state->has_node || status == STATUS_SUCCESS;
    return status;
}

static enum exit_status show_help(const struct state *state, char *const *word, int count)
{
    if (count > 1)
        return client_help_show(word[1]) ? STATUS_SUCCESS : report_usage(state, "expected the name of a command", word[1]);
    fputs(help, stdout);
    for (unsigned i = 0; client_help_name(i) != NULL; i++)
        printf(" %s%s", client_help_name(i), i % 12 == 11 ? "\n " : "");
    putchar('\n');
    return STATUS_SUCCESS;
}

static enum exit_status do_words(struct state *state, char **word, int count)
{
    if (count == -1)
        return report_usage(state, "expected a closing quote", "the end of the line");
    if (count == -2)
        return report_usage(state, "expected at most 64 words", "more");
    if (count == 0)
        return STATUS_SUCCESS;
    if (strcmp(word[0], "node") == 0)
        return choose_node(state, word, count);
    if (strcmp(word[0], "motor") == 0)
        return set_number(state, word, count, RKM04_MOTORS, &state->motor);
    if (strcmp(word[0], "help") == 0)
        return show_help(state, word, count);
    if (strcmp(word[0], "quit") == 0 || strcmp(word[0], "exit") == 0) {
        state->is_over = true;
        return STATUS_SUCCESS;
    }
    if (strcmp(word[0], "shell") == 0)
        return report_usage(state, "expected another command than the shell itself", word[0]);
    return run(state, word, count);
}

static enum exit_status do_line(struct state *state, char *line)
{
    char *word[CLIENT_WORDS_MAX];
    if (client_words_is_program(line)) {
        if (state->shell.face != NULL)
            return report_usage(state, "expected a command, as pmc: program text is for an RKM04", line);
        char *program[] = {(char *)"set", (char *)"--", line};
        return run(state, program, 3);
    }
    return do_words(state, word, client_words_split(line, word));
}

/* ---- A file ----------------------------------------------------------------------------------------------------------- */

/* Is what fgets has read into `line` a whole line of text? */
static bool is_whole(const struct state *state, const char *line, FILE *in)
{
    size_t length = strlen(line);
    if (length > 0 && (line[length - 1] == '\n' || feof(in)))
        return true;
    if (length == LINE_SIZE - 1)
        fprintf(stderr, "%s:%u: error: expected a line of at most %d bytes\n", state->name, state->line, LINE_SIZE - 2);
    else
        fprintf(stderr, "%s:%u: error: expected a text, found byte 00\n", state->name, state->line);
    return false;
}

static enum exit_status do_file(struct state *state, FILE *in)
{
    static char line[LINE_SIZE];
    enum exit_status status = STATUS_SUCCESS;
    while (!state->is_over && status == STATUS_SUCCESS && fgets(line, sizeof line, in) != NULL) {
        state->line++;
        if (!is_whole(state, line, in))
            return STATUS_FAILURE;
        line[strcspn(line, "\r\n")] = '\0';
        status = do_line(state, line);
        if (status != STATUS_SUCCESS)
            fprintf(stderr, "%s:%u: the command has failed (exit status %d); no further commands are executed\n",
                    state->name, state->line, (int)status);
    }
    if (ferror(in)) {
        warn("cannot read %s", state->name);
        return STATUS_FAILURE;
    }
    return status;
}

/* ---- A person --------------------------------------------------------------------------------------------------------- */

/* Is the word that begins at `start` the first one behind `pmc'? */
static bool is_of_pmc(const char *line, int start)
{
    const size_t blanks = strspn(line, " \t"), name = blanks + strlen("pmc");
    return strncmp(line + blanks, "pmc", strlen("pmc")) == 0 && name < (size_t)start &&
           name + strspn(line + name, " \t") == (size_t)start;
}

/* The names that the word which begins at `start` may have, from 0 on. */
static const char *name_of(const char *line, int start, unsigned i)
{
    static const char *const pmc[] = {CLIENT_PMC_NAMES, NULL};
    const unsigned owns = sizeof own / sizeof own[0] - 1, pmcs = sizeof pmc / sizeof pmc[0] - 1;
    if (start == 0)
        return i < owns ? own[i] : client_help_name(i - owns);
    return i < pmcs && is_of_pmc(line, start) ? pmc[i] : NULL;
}

static void put_prompt(const struct state *state, char prompt[PROMPT_SIZE])
{
    char node[20] = "all units", motor[20] = "all motors";
    if (state->node > 0)
        snprintf(node, sizeof node, "unit %u", state->node);
    if (state->motor > 0)
        snprintf(motor, sizeof motor, "motor %u", state->motor);
    snprintf(prompt, PROMPT_SIZE, "%s, %s> ", node, motor);
}

static enum exit_status do_person(struct state *state)
{
    char prompt[PROMPT_SIZE], *line;
    client_typing_begin(name_of);
    while (!state->is_over) {
        put_prompt(state, prompt);
        if ((line = client_typing_read(prompt)) == NULL)
            break;
        do_line(state, line);
        free(line);
    }
    client_typing_end();
    return STATUS_SUCCESS;
}

enum exit_status client_shell(const struct client_shell *shell)
{
    struct state state = {.shell = *shell, .node = shell->node, .motor = shell->motor, .has_node = shell->has_node};
    const bool is_stdin = shell->file == NULL || strcmp(shell->file, "-") == 0;
    state.name = is_stdin ? "<stdin>" : shell->file;
    state.is_person = shell->file == NULL && isatty(STDIN_FILENO);
    if (state.is_person)
        return do_person(&state);
    FILE *in = is_stdin ? stdin : fopen(shell->file, "re");
    if (in == NULL) {
        warn("cannot read %s", shell->file);
        return STATUS_FAILURE;
    }
    setvbuf(in, NULL, _IONBF, 0); /* what is read ahead would be read again when a command ends: it shares the file */
    enum exit_status status = do_file(&state, in);
    if (!is_stdin)
        fclose(in);
    return status;
}
