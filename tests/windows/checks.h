/* SPDX-License-Identifier: MIT */
#ifndef RKM04_TESTS_WINDOWS_CHECKS_H
#define RKM04_TESTS_WINDOWS_CHECKS_H

#include "port.h"

struct check {
    const char *name;
    enum opening {
        ANY_PORT,   /* a COM port for overlapped use, or a socket */
        OVERLAPPED_PORT,
        PLAIN_PORT  /* a COM port, not for overlapped use */
    } opening;
    bool (*run)(const struct port *port);
};

extern const struct check checks[]; /* the last one has no name */

/* The path of the COM port. */
const char *port_name(void);

#endif
