/* SPDX-License-Identifier: MIT */
/* Each command runs in a process of its own, so that Ctrl-C ends the command and not the shell, and what one does to the
 * terminal or the port does not stay. Editing, history and completion are libedit's: it is small, in every distribution, and its
 * licence suits any user. */
#include "client_typing.h"

#include <editline/readline.h>
#include <err.h>
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define HISTORY_LINES 1000

static const char *(*name_of)(const char *line, int start, unsigned i);
static int word_start;
static char history[PATH_MAX];

static char *complete_name(const char *text, int again)
{
    static unsigned at;
    const char *name;
    if (!again)
        at = 0;
    while ((name = name_of(rl_line_buffer, word_start, at++)) != NULL)
        if (strncmp(name, text, strlen(text)) == 0)
            return strdup(name);
    return NULL;
}

static char **complete(const char *text, int start, int end)
{
    (void)end;
    word_start = start;
    return name_of(rl_line_buffer, start, 0) != NULL ? rl_completion_matches(text, complete_name) : NULL;
}

/* $XDG_STATE_HOME/rkm04/history, else below ~/.local/state. Makes the folders. Returns false if there is no place for it. */
static bool find_history(char path[PATH_MAX])
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    char folder[PATH_MAX - 16];
    int length = state != NULL && state[0] == '/' ? snprintf(folder, sizeof folder, "%s", state) :
                 home != NULL && home[0] == '/'   ? snprintf(folder, sizeof folder, "%s/.local/state", home) :
                                                    -1;
    if (length < 0 || (size_t)length + sizeof "/rkm04" > sizeof folder)
        return false;
    for (char *slash = folder + 1; (slash = strchr(slash, '/')) != NULL; slash++) {
        *slash = '\0';
        mkdir(folder, 0700);
        *slash = '/';
    }
    mkdir(folder, 0700);
    strcat(folder, "/rkm04");
    mkdir(folder, 0700);
    snprintf(path, PATH_MAX, "%s/history", folder);
    return true;
}

void client_typing_begin(const char *(*name)(const char *line, int start, unsigned i))
{
    name_of = name;
    if (!find_history(history))
        history[0] = '\0';
    rl_readline_name = (char *)"rkmctl";
    rl_attempted_completion_function = complete;
    using_history();
    stifle_history(HISTORY_LINES);
    if (history[0] != '\0')
        read_history(history);
    signal(SIGINT, SIG_IGN); /* ends the command */
    puts("help lists the commands, Ctrl-D ends the shell");
    fflush(stdout);
    /* Where no line is being edited the terminal turns Ctrl-D into 00, to which libedit gives a binding of its own when it
     * first prepares the terminal: it would quote the next key. */
    rl_prep_terminal(1);
    rl_parse_and_bind("bind ^@ em-delete-or-list");
}

char *client_typing_read(const char *prompt)
{
    char *line = readline(prompt);
    if (line != NULL && line[strspn(line, " \t")] != '\0')
        add_history(line);
    return line;
}

void client_typing_end(void)
{
    mode_t mask = umask(077);
    if (history[0] != '\0' && write_history(history) == 0)
        history_truncate_file(history, HISTORY_LINES);
    umask(mask);
}

enum exit_status client_typing_run(int (*run)(int argc, char **argv), int argc, char **argv)
{
    int status;
    fflush(stdout);
    pid_t child = fork();
    if (child == 0) {
        signal(SIGINT, SIG_DFL);
        status = run(argc, argv);
        fflush(stdout);
        _exit(status);
    }
    if (child < 0) {
        warn("cannot begin a command");
        return STATUS_FAILURE;
    }
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return STATUS_FAILURE;
    return WIFEXITED(status) ? (enum exit_status)WEXITSTATUS(status) : STATUS_FAILURE;
}
