/* SPDX-License-Identifier: MIT */
/* The state of a PMC as JSON. */
#include "pmc_device.h"

#include <stdio.h>

static const char *const state_names[] = {
    [PMC_IDLE] = "idle", [PMC_MANUAL] = "manual", [PMC_PROGRAM] = "program", [PMC_SEARCHING] = "search"};
static const char *const fault_names[] = {"none", "sl+", "sl-", "hl+", "hl-", "emg", "pgm", "hom", "inx"};

const char *pmc_state_name(unsigned state)
{
    return state < sizeof state_names / sizeof *state_names ? state_names[state] : NULL;
}

const char *pmc_fault_name(unsigned fault)
{
    return fault < sizeof fault_names / sizeof *fault_names ? fault_names[fault] : NULL;
}

unsigned pmc_fault_of(uint8_t errors)
{
    unsigned fault = 0;
    for (unsigned bit = 0; bit < 8; bit++)
        if ((errors & 1u << bit) != 0)
            fault = bit + 1u;
    return fault;
}

json_t *pmc_errors_json(uint8_t errors)
{
    json_t *list = json_array();
    for (unsigned bit = 0; bit < 8; bit++)
        if ((errors & 1u << bit) != 0)
            json_array_append_new(list, json_string(fault_names[bit + 1u]));
    return list;
}

/* ---- An axis -------------------------------------------------------------------------------------------------------- */

static json_t *axis_state(const struct pmc_unit *unit, unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(unit, axis, &state);
    unsigned fault = pmc_fault_of(state.errors);
    return json_pack("{s:i, s:i, s:s, s:i, s:s, s:s?}", "motor", (int)axis + 1, "position", (int)state.commanded, "state",
                     pmc_state_name(state.state), "index", (int)state.reg + 1, "led", "off", "fault",
                     fault > 0 ? pmc_fault_name(fault) : NULL);
}

/* Put `value` into the object, which is NULL if memory has been short. */
static void put(json_t *object, const char *name, json_t *value)
{
    if (!value || !object)
        json_decref(value);
    else
        json_object_set_new(object, name, value);
}

/* The present position in units, with one decimal place, as the unit would display it (AM5). */
static json_t *display_json(const struct pmc_parameters *parameters, int32_t pulses)
{
    char text[32];
    int64_t tenths = pmc_tenths_of(parameters, pulses), magnitude = tenths < 0 ? -tenths : tenths;
    snprintf(text, sizeof text, "%s%lld.%lld", tenths < 0 ? "-" : "", (long long)(magnitude / 10), (long long)(magnitude % 10));
    return json_string(text);
}

static json_t *command_json(const struct pmc_axis *axis, int16_t reg)
{
    char text[PMC_COMMAND_TEXT_MAX];
    return reg < 0 ? json_null() : json_stringn(text, pmc_command_write(&axis->program[reg], text));
}

static json_t *repetitions_json(const struct pmc_axis *axis)
{
    json_t *list = json_array();
    for (unsigned i = 0; i < axis->repetitions; i++)
        json_array_append_new(list, json_pack("{s:i, s:i}", "reg", (int)axis->repetition[i].reg, "left",
                                              (int)axis->repetition[i].left));
    return list;
}

static unsigned count_commands(const struct pmc_axis *axis)
{
    unsigned count = 0;
    for (unsigned reg = 0; reg < PMC_REGISTERS; reg++)
        count += axis->program[reg].op != PMC_NOP;
    return count;
}

static void put_axis(json_t *object, const struct pmc_unit *unit, unsigned number)
{
    const struct pmc_axis *axis = &unit->axis[number];
    struct pmc_axis_state state;
    pmc_axis_state(unit, number, &state);
    put(object, "true_position", json_null());
    put(object, "axis", json_string(number == 0 ? "X" : "Y"));
    put(object, "actual", json_integer(state.actual));
    put(object, "display", display_json(&axis->parameters, state.commanded));
    put(object, "command", command_json(axis, state.reg));
    put(object, "reg", state.reg < 0 ? json_null() : json_integer(state.reg));
    put(object, "busy", json_boolean(pmc_is_busy(unit, number)));
    put(object, "moving", json_boolean(state.moving));
    put(object, "speed", json_integer(state.speed));
    put(object, "steps", json_integer(state.made));
    put(object, "forward", json_boolean(state.forward));
    put(object, "stopping", json_boolean(state.stopping));
    put(object, "errors", pmc_errors_json(state.errors));
    put(object, "homed", json_boolean(state.homed));
    put(object, "not_homed", json_boolean(state.not_homed));
    put(object, "fifth_speed", json_integer(state.fifth));
    put(object, "repetitions", repetitions_json(axis));
    put(object, "memory", json_pack("{s:i, s:i}", "commands", (int)count_commands(axis), "of", (int)PMC_REGISTERS));
}

/* ---- A unit --------------------------------------------------------------------------------------------------------- */

json_t *pmc_json_state(const struct device_unit *unit, uint64_t t_us)
{
    const struct pmc_unit *core = pmc_in(unit);
    json_t *motors = json_array();
    for (unsigned axis = 0; axis < core->config.axes; axis++)
        json_array_append_new(motors, axis_state(core, axis));
    return json_pack("{s:I, s:o, s:i, s:i, s:i}", "t_us", (json_int_t)t_us, "motors", motors, "di", (int)pmc_inputs(core), "do",
                     (int)pmc_outputs(core), "var", 0);
}

static json_t *counters_json(const struct pmc_counters *counters)
{
    return json_pack("{s:I, s:I, s:I, s:I}", "requests", (json_int_t)counters->requests, "answers",
                     (json_int_t)counters->answers, "others", (json_int_t)counters->others, "dropped",
                     (json_int_t)counters->dropped);
}

static json_t *ignored_json(const struct pmc_ignored *ignored)
{
    return json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "unknown", (json_int_t)ignored->unknown, "operand",
                     (json_int_t)ignored->operand, "range", (json_int_t)ignored->range, "busy", (json_int_t)ignored->busy,
                     "too_long", (json_int_t)ignored->too_long, "line", (json_int_t)ignored->line);
}

json_t *pmc_json_describe(const struct device_unit *unit, uint64_t t_us)
{
    const struct pmc_unit *core = pmc_in(unit);
    json_t *state = pmc_json_state(unit, t_us), *motors = json_object_get(state, "motors");
    for (unsigned axis = 0; axis < core->config.axes; axis++)
        put_axis(json_array_get(motors, axis), core, axis);
    put(state, "node", json_integer(core->config.address));
    put(state, "face", json_string(core->config.face->name));
    put(state, "baud", json_integer(core->config.baud));
    put(state, "counters", counters_json(&core->face.reply.counters));
    if (core->config.face == &pmc_ascii_face)
        put(state, "ignored", ignored_json(&core->face.ascii.ignored));
    return state;
}
