/* SPDX-License-Identifier: MIT */
/* bus_service.h: the TCP ports of a device's own servers (device_service). Clients reach the sim by the commands service.*, so
 * that recordings have them. */
#ifndef RKM04_BUS_SERVICE_H
#define RKM04_BUS_SERVICE_H

#include "bus_log.h"
#include "bus_options.h"
#include "sim/sim.h"

/* What a port asks the bus for. */
struct bus_service_calls {
    struct sim *(*sim)(void *context);  /* returns the sim, brought up to the present */
    void (*changed)(void *context);     /* something was done to it */
    void (*presence)(void *context);    /* a client has come or gone, or bytes came */
};

struct bus_services;

/* Listen for each --service. Failures are reported. Returns false if it did not work; *services (or NULL) is to be closed and
 * freed in either case. */
bool bus_services_open(struct bus_services **services, const struct bus_options *options, const struct bus_log *log,
                       uv_loop_t *loop, const struct bus_service_calls *calls, void *context);

/* Close all; the handles are gone when the loop has run out, then it may be freed. NULL: nothing. */
void bus_services_close(struct bus_services *services);
void bus_services_free(struct bus_services *services);

/* sim_config.service_out. */
void bus_services_send(struct bus_services *services, unsigned client, const uint8_t *bytes, size_t length);

/* How many clients are there. */
unsigned bus_services_clients(const struct bus_services *services);

/* Where number `at` listens, from 0 on; NULL: there is none. */
const char *bus_services_address(const struct bus_services *services, unsigned at);

#endif
