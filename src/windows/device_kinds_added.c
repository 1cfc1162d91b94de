/* SPDX-License-Identifier: MIT */
/* As device/device_kinds_added.c: no kinds besides those of the table. The linker for Windows replaces no weak symbols. */
#include "device/device.h"

extern const struct device_kind *const device_kinds_added[];
const struct device_kind *const device_kinds_added[] = {NULL};
