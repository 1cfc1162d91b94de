/* SPDX-License-Identifier: MIT */
/* fake_added.c: a program that is linked with this file has the fake device beside the kinds of the product. */
#include "fake_device.h"

extern const struct device_kind *const device_kinds_added[];
const struct device_kind *const device_kinds_added[] = {&fake_device, &fake_alone_device, NULL};
