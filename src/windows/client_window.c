/* SPDX-License-Identifier: MIT */
/* client_window.c: the window is in rkmctl.exe itself. */
#include "client/client_window.h"

#include "window/window.h"

enum exit_status client_window(char **argv)
{
    static char name[] = "rkmctl window"; /* in messages */
    int count = 1;
    argv[1] = name;
    while (argv[count + 1] != NULL)
        count++;
    return window_command(count, argv + 1);
}
