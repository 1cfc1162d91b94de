/* SPDX-License-Identifier: MIT */
/* fake_device.h: the fake device as a kind of device (docs/DEVICES.md). */
#ifndef RKM04_TESTS_FAKE_DEVICE_H
#define RKM04_TESTS_FAKE_DEVICE_H

#include "device/device.h"

extern const struct device_kind fake_device;

/* fake_framing.c: a message ends with CR; with a silence, after a sum of its bytes. */
extern const struct device_framing fake_lines, fake_sums;

/* fake_alone.c: the same core without a bus, with names of inputs and outputs. */
extern const struct device_kind fake_alone_device;

/* The core of its unit; NULL of NULL. */
struct fake_unit *fake_alone_core(struct device_unit *unit);

/* fake_service.c: its server. */
extern const struct device_service fake_services[];

#endif
