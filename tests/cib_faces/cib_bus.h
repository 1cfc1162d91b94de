/* SPDX-License-Identifier: MIT */
/* cib_bus.h: a bus with CIB modules in virtual time, and what the host receives of it, in hexadecimal. */
#ifndef RKM04_TESTS_CIB_BUS_H
#define RKM04_TESTS_CIB_BUS_H

#include "sim/sim.h"

struct cib_bus {
    struct sim sim;
    size_t length;
    char heard[16384];     /* "01 04 …" since the last request */
    uint64_t first_tick;   /* tick at which the first of these bytes came */
    uint64_t start;        /* tick at which its start bit was, where bytes take time */
};

/* Modules with these addresses ("1,2") and this configuration (NULL: the default). `timed`: bytes take their time. */
void cib_bus_begin(struct cib_bus *bus, const char *nodes, bool timed, const struct device_config *config);
void cib_bus_end(struct cib_bus *bus);

/* Advance to a tick: what the host sends then comes in it. */
void cib_bus_to(struct cib_bus *bus, uint64_t tick);

/* The host sends these bytes now; what was received before is forgotten. */
void cib_bus_send(struct cib_bus *bus, const char *hex);

/* Without time on the wires: the host sends a request, and gets exactly this answer in the same tick; "": none. */
void cib_bus_expect(struct cib_bus *bus, const char *request, const char *answer);

/* The same with the check value left out of both: it is computed. */
void cib_bus_expect_checked(struct cib_bus *bus, const char *request, const char *answer);

/* Without time on the wires: the value of an input register of unit 1. */
unsigned cib_bus_input(struct cib_bus *bus, unsigned address);

/* A command, params as JSON. Returns its result, a new reference; or fails. */
json_t *cib_bus_command(struct cib_bus *bus, const char *method, const char *params);
void cib_bus_do(struct cib_bus *bus, const char *method, const char *params);

/* A command that is refused with a message that has `expected` in it. */
void cib_bus_expect_refusal(struct cib_bus *bus, const char *method, const char *params, const char *expected);

#endif
