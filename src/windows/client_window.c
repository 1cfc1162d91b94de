/* SPDX-License-Identifier: MIT */
/* client_window.c: rkm04-window is not in the programs for Windows. */
#include "client/client_window.h"

#include "client/client_usage.h"

enum exit_status client_window(char **argv)
{
    (void)argv;
    return client_usage("window is not in the program for Windows: run rkmctl on Linux or in WSL (docs/WINDOWS.md)");
}
