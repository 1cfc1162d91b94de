/* SPDX-License-Identifier: MIT */
/* client_shell.h: `rkmctl shell`: commands and program text line by line, with history, editing and completion. */
#ifndef RKM04_CLIENT_SHELL_H
#define RKM04_CLIENT_SHELL_H

#include <stdbool.h>

#include "client_answer.h"

struct client_shell {
    const char *file;      /* of commands, "-" for standard input; NULL: a person types them, if standard input is a terminal */
    /* Options for each command that takes them: NULL, 0 (line: -1) are not given. */
    const char *port, *framing, *control, *unit;
    const char *face;      /* of pmc: then it goes by the port */
    unsigned message_max, timeout_ms, baud;
    int line;
    bool json;
    unsigned node, motor;  /* to begin with */
    bool has_node;         /* `node` was chosen: otherwise the emulator is asked for its only unit, whatever its address */
    /* Do a command line of rkmctl; argv[0] is its name. In a process of its own. Returns the exit status. */
    int (*run)(int argc, char **argv);
};

/* Do all lines. A file ends at the first command that fails; a person continues. Returns the exit status. */
enum exit_status client_shell(const struct client_shell *shell);

#endif
