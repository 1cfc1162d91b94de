/* serve_options.h: the options of `rkm04 serve`. */
#ifndef RKM04_HOST_SERVE_OPTIONS_H
#define RKM04_HOST_SERVE_OPTIONS_H

#include <stdbool.h>

#include <rkm04/unit.h>

#include "virtual_clock.h"

struct serve_options {
    struct rkm04_config config; /* --node, --framing, --version-text, --speed-change-latency */
    const char *link;           /* NULL: the default */
    const char *port;           /* NULL: a pty of our own */
    const char *flash;          /* NULL: memory only */
    const char *clock_text;     /* as given: "real", "x10", "max" */
    struct virtual_clock clock;
    unsigned baud;              /* 19200, or 0: no pacing */
};

/* Read the command line. The strings of *options point into argv. Ends the program itself after --help, --version (status 0)
 * and wrong usage (status 2, with what was expected on stderr). */
void serve_options_read(struct serve_options *options, int argc, char **argv);

#endif
