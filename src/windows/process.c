/* SPDX-License-Identifier: MIT */
/* process.c: how a program begins and ends, as options/process.c and signals are elsewhere. */
#include "options/process.h"

#include <stdbool.h>
#include <windows.h>

#undef signal

int windows_exit_status;

/* The start-up code of mingw-w64: arguments such as *.rks, not in quotes, become the files that there are, as shells elsewhere do
 * it. */
extern int _dowildcard;
int _dowildcard = -1;

static void (*at_end)(int status, void *context);
static void *at_end_context;

/* Does the path lead to something, or its folder? A program text with a \ does not. */
static bool leads_somewhere(char *path)
{
    char *last = strrchr(path, '\\');
    if (!last || last == path || (last == path + 1 && path[0] == '\\')) /* `\' and `\\' are program texts, too */
        return false;
    struct stat found;
    bool there = stat(path, &found) == 0;
    *last = '\0';
    there = there || stat(path, &found) == 0;
    *last = '\\';
    return there;
}

/* The path in an argument: FILE, --option=FILE, M=FILE, NAME=FILE, --option=NAME=FILE. NULL: there is none with a \ in it. */
static char *path_in(char *argument)
{
    char *path = argument;
    while (path && !leads_somewhere(path)) {
        path = strchr(path, '=');
        path = path ? path + 1 : NULL;
    }
    return path;
}

/* Bytes go out as they are. Paths have / as everywhere else in the programs, which Windows understands, too. */
void process_begin(char **argv)
{
    for (int fd = 0; fd <= 2; fd++)
        _setmode(fd, _O_BINARY);
    for (; *argv; argv++)
        for (char *path = path_in(*argv); path && *path; path++)
            *path = *path == '\\' ? '/' : *path;
}

bool process_path_is_absolute(const char *path)
{
    return path[0] == '/' || path[0] == '\\' || (path[0] != '\0' && path[1] == ':');
}

bool process_find_window(char path[PATH_MAX])
{
    (void)path;
    return false;
}

static void call_at_end(void)
{
    at_end(windows_exit_status, at_end_context);
}

/* One function, which is all that the programs need. */
int on_exit(void (*function)(int status, void *context), void *context)
{
    at_end = function;
    at_end_context = context;
    return atexit(call_at_end);
}

int sigaction(int number, const struct sigaction *action, struct sigaction *old)
{
    (void)old;
    return signal(number, action->sa_handler) == SIG_ERR ? -1 : 0;
}

/* Signals that Windows does not have never come. */
void (*windows_signal(int number, void (*handler)(int number)))(int number)
{
    return number == SIGPIPE || number == SIGXFSZ ? SIG_DFL : signal(number, handler);
}
