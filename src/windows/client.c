/* SPDX-License-Identifier: MIT */
/* client.c: what rkmctl.exe does not have: it talks to units. */
#include <stdbool.h>
#include <string.h>

#include "client/client.h"
#include "client/client_cause.h"

static const char not_here[] = "is not in the program for Windows: run rkmctl on Linux or in WSL (docs/WINDOWS.md)";

bool client_control_has(const char *name)
{
    static const char names[] = " " CLIENT_CONTROL_NAMES;
    size_t length = strlen(name);
    for (const char *at = names; length > 0 && (at = strstr(at, name)) != NULL; at += length)
        if (at[-1] == ' ' && strchr(", ", at[length]))
            return true;
    return false;
}

enum exit_status client_control(struct client_job *job, const char *name)
{
    (void)job;
    return client_usage("%s %s", name, not_here);
}

enum exit_status client_pmc(const struct client_pmc *pmc)
{
    (void)pmc;
    return client_usage("pmc %s", not_here);
}

enum exit_status client_shell(const struct client_shell *shell)
{
    (void)shell;
    return client_usage("shell %s", not_here);
}

enum exit_status client_window(char **argv)
{
    (void)argv;
    return client_usage("window %s", not_here);
}

/* Emulators run elsewhere. */

bool client_print_emulator_causes(const char *port, const struct rkm04_framing *framing, unsigned node)
{
    (void)port;
    (void)framing;
    (void)node;
    return false;
}

const struct client_found *client_find_one(const char *option)
{
    client_usage("expected %s COM1 to COM256, or %s tcp:HOST:PORT", option, option);
    return NULL;
}
