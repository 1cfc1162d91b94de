/* SPDX-License-Identifier: MIT */
/* client_pmc.h: `rkmctl pmc`: a PMC-1HS or PMC-2HS, real or virtual, over its line of text, over Modbus, or through the control
 * socket of an emulator. */
#ifndef RKM04_CLIENT_PMC_H
#define RKM04_CLIENT_PMC_H

#include "client_job.h"

#define CLIENT_PMC_COMMANDS "run, jog, move, speed, stop, home, position, errors, program, parameters or store"
#define CLIENT_PMC_NAMES "run", "jog", "move", "speed", "stop", "home", "position", "errors", "program", "parameters", "store"

struct client_pmc {
    const char *port;         /* NULL: not named */
    const char *face;         /* ascii or modbus; NULL: not named */
    struct client_job *job;   /* of the control socket, which is used if it is named and the port is not */
    unsigned node, baud, timeout_ms; /* baud 0: 9600 */
    bool json;
    const char *const *words; /* after `pmc` */
    size_t count;
};

/* Do a command. Returns the exit status. */
enum exit_status client_pmc(const struct client_pmc *pmc);

#endif
