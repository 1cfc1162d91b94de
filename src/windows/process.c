/* SPDX-License-Identifier: MIT */
/* process.c: how a program begins and ends, as options/process.c and signals are elsewhere. */
#include "options/process.h"

#include <stdbool.h>
#include <windows.h>

#undef signal

int windows_exit_status;

static void (*at_end)(int status, void *context);
static void *at_end_context;

/* The path in an argument: behind `--option=', behind `M='. NULL: there is none with a \ in it. */
static char *path_in(char *argument)
{
    char *equals = strchr(argument, '='), *path = argument;
    if (equals && (argument[0] == '-' || (equals == argument + 1 && argument[0] >= '0' && argument[0] <= '9')))
        path = equals + 1;
    return strchr(path, '\\') && (path[0] != '\\' || path[1] == '\\') ? path : NULL;
}

/* Does the path lead to something, or its folder? A program text with a \ does not. */
static bool leads_somewhere(char *path)
{
    char *last = strrchr(path, '\\');
    DWORD there = GetFileAttributesA(path);
    if (there == INVALID_FILE_ATTRIBUTES) {
        *last = '\0';
        there = GetFileAttributesA(path);
        *last = '\\';
    }
    return there != INVALID_FILE_ATTRIBUTES;
}

/* Bytes go out as they are. Paths have / as everywhere else in the programs, which Windows understands, too. */
void process_begin(void)
{
    for (int fd = 0; fd <= 2; fd++)
        _setmode(fd, _O_BINARY);
    for (int i = 1; i < __argc; i++) {
        char *path = path_in(__argv[i]);
        if (path && leads_somewhere(path))
            for (; *path; path++)
                *path = *path == '\\' ? '/' : *path;
    }
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
