/* SPDX-License-Identifier: MIT */
/* The table of kinds of devices. */
#include <string.h>

#include "device.h"

/* A row for each kind; the first one is meant where none is named. */
static const struct device_kind *const device_kinds[] = {&rkm04_device};

#define KINDS (sizeof device_kinds / sizeof device_kinds[0])

/* Kinds of a program that is linked with more of them; ends with NULL. */
extern const struct device_kind *const device_kinds_added[];

const struct device_kind *device_kind_at(unsigned at)
{
    if (at < KINDS)
        return device_kinds[at];
    for (unsigned i = 0; device_kinds_added[i]; i++)
        if (i == at - KINDS)
            return device_kinds_added[i];
    return NULL;
}

const struct device_kind *device_kind_named(const char *name)
{
    const struct device_kind *kind;
    for (unsigned at = 0; (kind = device_kind_at(at)); at++)
        if (strcmp(kind->name, name) == 0)
            return kind;
    return NULL;
}
