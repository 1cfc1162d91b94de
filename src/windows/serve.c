/* SPDX-License-Identifier: MIT */
#include "serve/serve.h"

#include <stdio.h>

#include "text/text.h"

int serve_main(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    fputs("rkm04 serve: not in the program for Windows: run it on Linux, in WSL or in a container (docs/WINDOWS.md)\n", stderr);
    return STATUS_USAGE;
}
