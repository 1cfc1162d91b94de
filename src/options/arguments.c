/* SPDX-License-Identifier: MIT */
#include "arguments.h"

#include <err.h>
#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "text/text.h"

#define SHOWN_MAX 300 /* bytes of an argument with its note */

static bool parsing; /* argp may end the program now */
static char **arguments; /* of the program; NULL after the last */

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

/* The command line was wrong, which has been reported: name characters in it that cannot be seen. */
static void note_invisible(void)
{
    for (char **argument = arguments; *argument != NULL; argument++) {
        char text[SHOWN_MAX];
        snprintf(text, sizeof text, "%.200s", *argument);
        size_t length = strlen(text);
        invisible_note(text, sizeof text);
        if (text[length] != '\0')
            warnx("`%.*s'%s", (int)length, text, text + length);
    }
}

void arguments_reported(void)
{
    parsing = false;
}

static void at_end(int status, void *unused)
{
    (void)unused;
    if (!parsing)
        return;
    if (status != 0)
        note_invisible();
    if (arguments_printed() != 0)
        _exit(1);
}

void arguments_parse(const struct argp *argp, int argc, char **argv, void *input)
{
    static bool registered;
    if (!registered)
        registered = on_exit(at_end, NULL) == 0;
    arguments = argv;
    parsing = true;
    argp_parse(argp, argc, argv, 0, NULL, input);
    parsing = false;
}
