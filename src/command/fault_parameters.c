/* SPDX-License-Identifier: MIT */
#include "fault_parameters.h"

#include <string.h>

#define PARAMETERS_MAX 5u /* of a kind, and the end */

#define UNIT {"unit", "unit", false, NULL}
#define DIRECTION {"direction", "choice", false, fault_direction_names}
#define DURATION {"duration", "time", false, NULL}
#define EVERY {"every", "time", false, NULL}
#define NUMBER(name) {name, "number", false, NULL}
#define FLAG(name, required) {name, "flag", required, NULL}

const char *const fault_direction_names[] = {"to_units", "to_master", "both", NULL};
const char *const fault_operation_names[] = {"write", "erase", "program", "read", NULL};
const uint8_t fault_operation_sets[] = {FAULT_ERASE | FAULT_PROGRAM, FAULT_ERASE, FAULT_PROGRAM, FAULT_READ};

static const struct fault_parameter parameters[FAULT_KINDS][PARAMETERS_MAX + 1u] = {
    [FAULT_DROP] = {UNIT, DIRECTION},
    [FAULT_FLIP] = {NUMBER("mask"), UNIT, DIRECTION},
    [FAULT_DUPLICATE] = {UNIT, DIRECTION},
    [FAULT_INSERT] = {NUMBER("byte"), UNIT, DIRECTION},
    [FAULT_ECHO] = {{NULL, NULL, false, NULL}},
    [FAULT_DELAY] = {{"delay", "time", true, NULL}, UNIT},
    [FAULT_NO_ANSWER] = {UNIT},
    [FAULT_WRONG_FCS] = {UNIT},
    [FAULT_CUT] = {{"bytes", "number", true, NULL}, UNIT},
    [FAULT_FLASH] = {{"operation", "choice", false, fault_operation_names}, FLAG("torn", false), UNIT},
    [FAULT_POWER] = {NUMBER("operation"), UNIT, DURATION},
    [FAULT_BREAK] = {DURATION, EVERY},
    [FAULT_UNPLUGGED] = {DURATION, EVERY},
    [FAULT_CABLE] = {UNIT, DURATION, EVERY},
    [FAULT_INPUT] = {{"input", "input", true, NULL}, FLAG("level", true), UNIT, DURATION, EVERY},
};

const struct fault_parameter fault_common_parameters[] = {
    NUMBER("count"),
    NUMBER("skip"),
    NUMBER("probability"),
    {"after", "time", false, NULL},
    {"for", "time", false, NULL},
    {NULL, NULL, false, NULL},
};

const struct fault_parameter *fault_parameters(enum fault_kind kind)
{
    return parameters[kind];
}

bool fault_takes(enum fault_kind kind, const char *name)
{
    const struct fault_parameter *parameter = parameters[kind];
    while (parameter->name && strcmp(parameter->name, name) != 0)
        parameter++;
    return parameter->name != NULL;
}

static json_t *choices_json(const char *const *choices)
{
    json_t *list = choices ? json_array() : NULL;
    for (size_t i = 0; choices && choices[i]; i++)
        json_array_append_new(list, json_string(choices[i]));
    return list;
}

static json_t *list_json(const struct fault_parameter *parameter)
{
    json_t *list = json_array();
    for (; parameter->name; parameter++)
        json_array_append_new(list, json_pack("{s:s, s:s, s:b, s:o*}", "name", parameter->name, "type", parameter->type,
                                              "required", (int)parameter->required, "choices",
                                              choices_json(parameter->choices)));
    return list;
}

const char *fault_lacks(enum fault_kind kind, const struct device_kind *device)
{
    if (kind == FAULT_FLASH || kind == FAULT_POWER)
        return device->flash_blocks > 0 ? NULL : "has no flash";
    if (kind == FAULT_INPUT)
        return device->inputs > 0 ? NULL : "has no inputs";
    return device->receive ? NULL : "has no bus";
}

json_t *fault_kinds_json(const struct device_kind *device)
{
    json_t *kinds = json_array();
    for (unsigned kind = 0; kind < FAULT_KINDS; kind++)
        if (!fault_lacks((enum fault_kind)kind, device))
            json_array_append_new(kinds, json_pack("{s:s, s:o}", "kind", fault_kind_name((enum fault_kind)kind), "parameters",
                                                   list_json(parameters[kind])));
    return json_pack("{s:o, s:o}", "kinds", kinds, "common", list_json(fault_common_parameters));
}
