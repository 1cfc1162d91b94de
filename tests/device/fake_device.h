/* SPDX-License-Identifier: MIT */
/* fake_device.h: the fake device as a kind of device (docs/DEVICES.md). */
#ifndef RKM04_TESTS_FAKE_DEVICE_H
#define RKM04_TESTS_FAKE_DEVICE_H

#include "device/device.h"

extern const struct device_kind fake_device;

#endif
