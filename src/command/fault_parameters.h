/* SPDX-License-Identifier: MIT */
/* fault_parameters.h: what each kind of fault can be given: for fault.inject, which takes nothing else, and for fault.kinds,
 * which says so. Private. */
#ifndef RKM04_COMMAND_FAULT_PARAMETERS_H
#define RKM04_COMMAND_FAULT_PARAMETERS_H

#include <jansson.h>
#include <stdbool.h>

#include "device/device.h"
#include "fault/fault.h"

struct fault_parameter {
    const char *name;           /* NULL: the end of the list */
    const char *type;           /* "number", "time", "flag", "unit", "input", "choice" */
    bool required;
    const char *const *choices; /* of a choice; NULL after the last one */
};

/* The way bytes go: the name of enum fault_direction FAULT_TO_UNITS + n is the n-th one. */
extern const char *const fault_direction_names[];

/* Operations of the flash: fault_operation_sets[n] is what the n-th name means. */
extern const char *const fault_operation_names[];
extern const uint8_t fault_operation_sets[];

/* Those of one kind, without those that all kinds have; those of all kinds. */
const struct fault_parameter *fault_parameters(enum fault_kind kind);
extern const struct fault_parameter fault_common_parameters[];

/* Has the kind a parameter of its own with this name? */
bool fault_takes(enum fault_kind kind, const char *name);

/* What units of this device lack, so that the kind can never act: "has no bus". NULL: it can act. */
const char *fault_lacks(enum fault_kind kind, const struct device_kind *device);

/* The answer of fault.kinds for units of this device. New reference; NULL: out of memory. */
json_t *fault_kinds_json(const struct device_kind *device);

#endif
