/* SPDX-License-Identifier: MIT */
/* bus_coverage.h: what of the messages on a line counts for the coverage of the protocol. */
#ifndef RKM04_BUS_COVERAGE_H
#define RKM04_BUS_COVERAGE_H

#include "device/device.h"
#include "wire/wire.h"

/* A message has passed (WATCH_MESSAGE). Requests count if a unit may execute them, answers if they are whole: what a collision
 * leaves of one is dropped, where the framing can detect it. */
void bus_coverage_message(struct coverage *coverage, const struct device_kind *device, const struct wire_message *message);

#endif
