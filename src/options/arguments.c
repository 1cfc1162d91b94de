/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include <err.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

static bool parsing; /* argp may end the program now */

int arguments_printed(void)
{
    errno = 0;
    if (fflush(stdout) == 0 && !ferror(stdout))
        return 0;
    if (errno != 0)
        warn("cannot write to standard output");
    else
        warnx("cannot write to standard output");
    return 1;
}

static void at_end(void)
{
    if (parsing && arguments_printed() != 0)
        _exit(1);
}

void arguments_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    static bool registered;
    if (!registered)
        registered = atexit(at_end) == 0;
    parsing = true;
    argp_parse(argp, argc, argv, 0, NULL, input);
    parsing = false;
}
