/* SPDX-License-Identifier: MIT */
/* What hands do to a unit, and what there is to be seen of it. */
#include <stdlib.h>
#include <string.h>

#include "methods.h"
#include "unit_state.h"

/* 0, 1, false, true -> 0, 1; -1: none of these. */
static int read_level(const json_t *value)
{
    if (json_is_boolean(value))
        return json_is_true(value);
    return json_is_integer(value) && (json_integer_value(value) == 0 || json_integer_value(value) == 1)
               ? (int)json_integer_value(value)
               : -1;
}

static json_t *command_state(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    if (number == 0)
        return NULL;
    json_t *state = unit_state(sim, number);
    return state ? state : refuse(refusal, REFUSED_MEMORY, "out of memory");
}

static json_t *command_motor_program(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"motor", "unit", NULL};
    const struct device_kind *kind = sim_device(sim);
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    int64_t motor;
    if (number == 0 || !param_integer(params, "motor", 1, kind->axes, &motor, refusal))
        return NULL;
    if (!kind->program_of)
        return refuse(refusal, REFUSED_STATE, "the motors of a device `%s' have no programs of their own", kind->name);
    json_t *result = kind->program_of(sim_core(sim, number), (unsigned)motor), *more;
    more = json_pack("{s:I, s:I, s:I}", "t_us", (json_int_t)sim_now(sim), "motor", (json_int_t)motor, "of",
                     (json_int_t)kind->program);
    if (result && more && json_object_update(result, more) == 0) {
        json_decref(more);
        return result;
    }
    json_decref(result);
    json_decref(more);
    return refuse(refusal, REFUSED_MEMORY, "out of memory");
}

/* ---- Inputs --------------------------------------------------------------------------------------------------------- */

/* Read the inputs named in `di` into `given`, and their levels. */
static bool read_inputs(const struct device_kind *kind, const json_t *di, uint32_t *given, uint32_t *levels,
                        struct refusal *refusal)
{
    const char *name;
    const json_t *value;
    char expected[DEVICE_ERROR_SIZE];
    json_object_foreach((json_t *)di, name, value) {
        unsigned input = device_input_named(kind, name);
        int level = read_level(value);
        if (input == 0) {
            refuse(refusal, REFUSED_PARAMS, "di: unknown input `%.40s': %s %s", name,
                   kind->inputs > 0 ? "expected" : "there are none in the device",
                   kind->inputs > 0 ? device_input_names(kind, expected) : kind->name);
            return false;
        }
        uint32_t bit = UINT32_C(1) << (input - 1);
        if (level < 0) {
            refuse(refusal, REFUSED_PARAMS, "di: input %u: expected 0 or 1", input);
            return false;
        }
        if (*given & bit) {
            refuse(refusal, REFUSED_PARAMS, "di: input %u is named twice", input);
            return false;
        }
        *given |= bit;
        *levels = level ? *levels | bit : *levels & ~bit;
    }
    return true;
}

static bool read_di(const struct device_kind *kind, const json_t *params, uint32_t *given, uint32_t *levels,
                    struct refusal *refusal)
{
    const json_t *di = json_object_get(params, "di"), *mask = json_object_get(params, "mask");
    int64_t value;
    if (json_is_object(di) && json_object_size(di) > 0 && !mask)
        return read_inputs(kind, di, given, levels, refusal);
    if (di || !mask) {
        refuse(refusal, REFUSED_PARAMS, "expected either di, an object as in {\"3\": 1, \"08\": 0}, or mask, a number");
        return false;
    }
    if (!param_integer(params, "mask", 0, (INT64_C(1) << kind->inputs) - 1, &value, refusal))
        return false;
    *given = UINT32_MAX;
    *levels = (uint32_t)value;
    return true;
}

static json_t *command_di_set(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"di", "mask", "unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    if (number == 0)
        return NULL;
    uint32_t given = 0, levels = sim->unit[number - 1].di;
    if (!read_di(sim_device(sim), params, &given, &levels, refusal))
        return NULL;
    sim_set_di(sim, number, levels);
    uint32_t inputs = sim_device(sim)->inputs_of(sim_core(sim, number));
    json_t *overridden = json_array();
    for (unsigned input = 1; input <= sim_device(sim)->inputs; input++)
        if (((inputs ^ levels) & given) >> (input - 1) & 1)
            json_array_append_new(overridden, json_integer((json_int_t)input));
    return json_pack("{s:I, s:I, s:o}", "t_us", (json_int_t)sim_now(sim), "di", (json_int_t)inputs, "overridden", overridden);
}

/* ---- Power and address ---------------------------------------------------------------------------------------------- */

static json_t *command_reset(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    if (number == 0)
        return NULL;
    if (!sim_powered(sim, number))
        return refuse(refusal, REFUSED_STATE, "unit %s has no power: switch it on with power", sim->unit[number - 1].name);
    sim_power(sim, number, true);
    return json_pack("{s:I}", "t_us", (json_int_t)sim_now(sim));
}

static json_t *command_power(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"on", "unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    if (number == 0)
        return NULL;
    const json_t *on = json_object_get(params, "on");
    if (!json_is_boolean(on))
        return refuse(refusal, REFUSED_PARAMS, "on: expected true or false");
    if (json_is_true(on) != sim_powered(sim, number))
        sim_power(sim, number, json_is_true(on));
    return json_pack("{s:I, s:b}", "t_us", (json_int_t)sim_now(sim), "powered", json_is_true(on));
}

static json_t *command_switch(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"node", "reset", "unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    const json_t *reset = json_object_get(params, "reset");
    int64_t node;
    if (number > 0 && !sim_device(sim)->receive)
        return refuse(refusal, REFUSED_STATE, "the device %s has no bus, and its unit no address", sim_device(sim)->name);
    if (number == 0 || !param_integer(params, "node", 1, sim_device(sim)->addresses, &node, refusal))
        return NULL;
    if (reset && !json_is_boolean(reset))
        return refuse(refusal, REFUSED_PARAMS, "reset: expected true or false");
    sim->config.nodes.node[number - 1] = (uint8_t)node; /* read at power-up (U4) */
    if (json_is_true(reset) && sim_powered(sim, number))
        sim_power(sim, number, true);
    return json_pack("{s:I, s:i, s:i}", "t_us", (json_int_t)sim_now(sim), "switch", (int)node, "node",
                     (int)sim_device(sim)->node(sim_core(sim, number)));
}

/* A list of names; NULL: there are none, or out of memory. */
static json_t *names_json(const char *const *names, unsigned count)
{
    json_t *list = names ? json_array() : NULL;
    for (unsigned at = 0; list && at < count; at++)
        json_array_append_new(list, json_string(names[at]));
    return list;
}

static json_t *command_units(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    if (!params_known(params, none, refusal))
        return NULL;
    json_t *settings = json_object(), *list = json_array();
    sim_device(sim)->put_settings(&sim->config.unit, settings);
    json_t *readings = json_incref(json_object_get(settings, "readings")); /* NULL: none, and left out */
    json_t *framing = json_incref(json_object_get(settings, "framing"));
    json_decref(settings);
    for (unsigned number = 1; number <= sim_units(sim); number++)
        json_array_append_new(list, json_string(sim->unit[number - 1].name));
    const struct device_kind *kind = sim_device(sim);
    return json_pack("{s:I, s:o, s:o*, s:o*, s:o*, s:o*}", "t_us", (json_int_t)sim_now(sim), "units", list, "framing", framing,
                     "readings", readings, "inputs", names_json(kind->input_names, kind->inputs), "outputs",
                     names_json(kind->output_names, kind->outputs));
}

/* What the units are: numbers that a client cannot know beforehand. */
static json_t *command_device(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const none[] = {NULL};
    const struct device_kind *kind = sim_device(sim);
    if (!params_known(params, none, refusal))
        return NULL;
    json_t *methods = json_array();
    for (const struct device_method *method = kind->methods; method && method->name; method++)
        json_array_append_new(methods, json_string(method->name));
    return json_pack("{s:I, s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:b, s:b, s:b, s:o, s:o*, s:o*}", "t_us",
                     (json_int_t)sim_now(sim), "name", kind->name, "description", kind->description, "axes", (int)kind->axes,
                     "inputs", (int)kind->inputs, "outputs", (int)kind->outputs, "variables", (int)kind->variables,
                     "first_variable", (int)kind->first_variable, "addresses", (int)kind->addresses, "program",
                     (int)kind->program, "bus", kind->receive != NULL, "plant", !kind->has_no_steps, "cells",
                     kind->find_cell != NULL, "methods", methods, "input_names",
                     names_json(kind->input_names, kind->inputs), "output_names",
                     names_json(kind->output_names, kind->outputs));
}

const struct command_method unit_methods[] = {
    {"units", command_units, false},
    {"device", command_device, false},
    {"state", command_state, false},
    {"motor.program", command_motor_program, false},
    {"di.set", command_di_set, true},
    {"reset", command_reset, true},
    {"power", command_power, true},
    {"switch", command_switch, true},
    {NULL, NULL, false},
};
