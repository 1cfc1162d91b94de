/* SPDX-License-Identifier: MIT */
/* rkm04-window: the service program's window, in a browser; `rkmctl window' and `rkm04 serve --window' start it. */
#include "window/window.h"

#include "options/options.h"

__attribute__((visibility("default"))) const char *argp_program_version = "rkm04-window " RKM04_VERSION;

int main(int argc, char **argv)
{
    process_begin(argv);
    return (int)window_command(argc, argv);
}
