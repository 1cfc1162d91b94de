/* SPDX-License-Identifier: MIT */
/* Kinds besides those of the table: none. A test program that has some brings its own list, which is linked in place of this one.
 * The list has a file of its own because a compiler may rely on its length where it sees it. */
#include "device.h"

extern const struct device_kind *const device_kinds_added[];
const struct device_kind *const device_kinds_added[] __attribute__((weak)) = {NULL};
