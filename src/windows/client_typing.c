/* SPDX-License-Identifier: MIT */
/* client_typing.c: the console itself lets lines be edited and keeps their history. */
#include "client/client_typing.h"

#include <err.h>
#include <windows.h>

#define LINE_ROOM 40000 /* bytes: longer than any line the shell takes */

static BOOL WINAPI on_control(DWORD what)
{
    return what == CTRL_C_EVENT; /* ends the command */
}

void client_typing_begin(const char *(*name)(const char *line, int start, unsigned i))
{
    (void)name;
    SetConsoleCtrlHandler(on_control, TRUE);
    puts("help lists the commands, Ctrl-Z and Enter end the shell");
}

char *client_typing_read(const char *prompt)
{
    char *line = malloc(LINE_ROOM);
    fputs(prompt, stdout);
    fflush(stdout);
    if (line != NULL && fgets(line, LINE_ROOM, stdin) != NULL && line[0] != '\x1a') {
        line[strcspn(line, "\r\n")] = '\0';
        return line;
    }
    free(line);
    return NULL;
}

void client_typing_end(void)
{
}

/* Append an argument as the start-up code of the other process reads it: in quotes, a \ before each quote, and twice as many \
 * before that. Returns false if there is no room. */
static bool append_quoted(char *line, size_t room, const char *word)
{
    size_t at = strlen(line), slashes = 0;
    if (at + 2 * strlen(word) + 4 > room)
        return false;
    line[at++] = '"';
    for (; *word != '\0'; word++) {
        for (size_t i = 0; *word == '"' && i <= slashes; i++)
            line[at++] = '\\';
        slashes = *word == '\\' ? slashes + 1 : 0;
        line[at++] = *word;
    }
    while (slashes-- > 0)
        line[at++] = '\\';
    memcpy(line + at, "\" ", 3);
    return true;
}

/* The same program again: there is no fork(). */
enum exit_status client_typing_run(int (*run)(int argc, char **argv), int argc, char **argv)
{
    static char line[32768];
    STARTUPINFOA start = {.cb = sizeof start};
    PROCESS_INFORMATION child;
    DWORD status = STATUS_FAILURE;
    char program[MAX_PATH];
    (void)run;
    line[0] = '\0';
    for (int i = 0; i < argc; i++) {
        if (!append_quoted(line, sizeof line, argv[i])) {
            warnx("the command is too long");
            return STATUS_FAILURE;
        }
    }
    fflush(stdout);
    if (GetModuleFileNameA(NULL, program, sizeof program) == 0 ||
        !CreateProcessA(program, line, NULL, NULL, TRUE, 0, NULL, NULL, &start, &child)) {
        warnx("cannot begin a command");
        return STATUS_FAILURE;
    }
    WaitForSingleObject(child.hProcess, INFINITE);
    GetExitCodeProcess(child.hProcess, &status);
    CloseHandle(child.hThread);
    CloseHandle(child.hProcess);
    return (enum exit_status)status;
}
