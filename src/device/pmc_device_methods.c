/* SPDX-License-Identifier: MIT */
/* Methods of a PMC for the control socket, scenarios and recordings (AU7): what the maker's window does, and files. */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pmc_device.h"

static const char *const axis_names[PMC_AXES] = {"x", "y"};

/* ---- Parameters and refusals ---------------------------------------------------------------------------------------- */

static json_t *refuse(struct device_refusal *refusal, bool is_state, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
static json_t *refuse(struct device_refusal *refusal, bool is_state, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(refusal->text, DEVICE_ERROR_SIZE, format, arguments);
    va_end(arguments);
    refusal->is_state = is_state;
    return NULL;
}

/* What a call of the core has answered. */
static json_t *result_of(enum pmc_answer answer, struct device_refusal *refusal)
{
    switch (answer) {
    case PMC_OK:
        return json_object();
    case PMC_BUSY:
        return refuse(refusal, true, "an axis is busy: pmc.stop ends what it does");
    case PMC_STORE_FAILED:
        return refuse(refusal, true, "the flash cannot be written");
    case PMC_NO_AXIS:
        return refuse(refusal, false, "axes: expected x, y or xy, of those that the unit has");
    default:
        return refuse(refusal, false, "a value is out of its range: expected positions from -8388608 to 8388607 within the "
                                      "counter, speeds from 1 to 8000, registers from 0 to 63");
    }
}

/* `axes`: "x", "y", "xy"; all if it is missing. Returns the axes, 0: refused. */
static uint8_t read_axes(const struct pmc_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    const json_t *axes = json_object_get(params, "axes");
    const char *text = json_string_value(axes);
    uint8_t found = 0;
    if (!axes)
        return (uint8_t)((1u << unit->config.axes) - 1u);
    for (; text && *text != '\0'; text++) {
        unsigned axis = *text == 'y' || *text == 'Y';
        if ((axis == 0 && *text != 'x' && *text != 'X') || axis >= unit->config.axes || (found & 1u << axis) != 0) {
            found = 0;
            break;
        }
        found |= (uint8_t)(1u << axis);
    }
    if (found == 0)
        refuse(refusal, false, unit->config.axes == 1 ? "axes: expected \"x\"" : "axes: expected \"x\", \"y\" or \"xy\"");
    return found;
}

/* `x`, `y`: whole numbers low..high of the axes that are named. Returns false: refused. */
static bool read_numbers(const struct pmc_unit *unit, const json_t *params, int32_t low, int32_t high,
                         struct pmc_request *request, struct device_refusal *refusal)
{
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        const json_t *value = json_object_get(params, axis_names[axis]);
        json_int_t number = json_integer_value(value);
        if (!value)
            continue;
        if (axis >= unit->config.axes)
            return refuse(refusal, false, "%s: the unit has axis x alone", axis_names[axis]) != NULL;
        if (!json_is_integer(value) || number < low || number > high)
            return refuse(refusal, false, "%s: expected a whole number from %ld to %ld", axis_names[axis], (long)low,
                          (long)high) != NULL;
        request->axes |= (uint8_t)(1u << axis);
        request->value[axis] = (int32_t)number;
    }
    if (request->axes == 0)
        refuse(refusal, false, "expected x, y or both, a whole number from %ld to %ld", (long)low, (long)high);
    return request->axes != 0;
}

static bool read_flag(const json_t *params, const char *name, bool *flag, struct device_refusal *refusal)
{
    const json_t *value = json_object_get(params, name);
    *flag = json_is_true(value);
    if (value && !json_is_boolean(value))
        refuse(refusal, false, "%s: expected true or false", name);
    return !value || json_is_boolean(value);
}

/* A whole number low..high; `missing` if it is not there, or refused if that is below `low`. */
static bool read_number(const json_t *params, const char *name, int32_t low, int32_t high, int32_t missing, int32_t *number,
                        struct device_refusal *refusal)
{
    const json_t *value = json_object_get(params, name);
    *number = value ? (int32_t)json_integer_value(value) : missing;
    if (value ? json_is_integer(value) && json_integer_value(value) >= low && json_integer_value(value) <= high : missing >= low)
        return true;
    refuse(refusal, false, "%s: expected a whole number from %ld to %ld", name, (long)low, (long)high);
    return false;
}

static json_t *ask(struct pmc_unit *unit, const struct pmc_request *request, struct device_refusal *refusal)
{
    return result_of(pmc_request(unit, request), refusal);
}

/* A request for axes without values. */
static json_t *ask_axes(struct device_unit *unit, const json_t *params, enum pmc_request_kind kind,
                        struct device_refusal *refusal)
{
    struct pmc_request request = {.kind = (uint8_t)kind, .axes = read_axes(pmc_of(unit), params, refusal)};
    return request.axes != 0 ? ask(pmc_of(unit), &request, refusal) : NULL;
}

/* ---- Motion --------------------------------------------------------------------------------------------------------- */

static json_t *call_run(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    int32_t reg;
    struct pmc_request request = {.kind = PMC_RUN, .axes = read_axes(pmc_of(unit), params, refusal)};
    if (request.axes == 0 || !read_number(params, "reg", 0, PMC_REGISTERS - 1, 0, &reg, refusal))
        return NULL;
    request.value[0] = request.value[1] = reg;
    return ask(pmc_of(unit), &request, refusal);
}

/* x, y: "+" or "-". */
static json_t *call_jog(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct pmc_request request = {.kind = PMC_JOG};
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        const json_t *value = json_object_get(params, axis_names[axis]);
        const char *text = json_string_value(value);
        bool is_plus = text && strcmp(text, "+") == 0;
        if (!value)
            continue;
        if (axis >= pmc_of(unit)->config.axes)
            return refuse(refusal, false, "%s: the unit has axis x alone", axis_names[axis]);
        if (!is_plus && (!text || strcmp(text, "-") != 0))
            return refuse(refusal, false, "%s: expected \"+\" or \"-\"", axis_names[axis]);
        request.axes |= (uint8_t)(1u << axis);
        request.value[axis] = is_plus ? 1 : -1;
    }
    if (request.axes == 0)
        return refuse(refusal, false, "expected x, y or both, \"+\" or \"-\"");
    return ask(pmc_of(unit), &request, refusal);
}

static json_t *call_move(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    bool is_by;
    struct pmc_request request = {.kind = PMC_MOVE_TO};
    if (!read_flag(params, "relative", &is_by, refusal) ||
        !read_numbers(pmc_of(unit), params, PMC_COUNTER_MIN, PMC_COUNTER_MAX, &request, refusal))
        return NULL;
    request.kind = is_by ? PMC_MOVE_BY : PMC_MOVE_TO;
    return ask(pmc_of(unit), &request, refusal);
}

static json_t *call_speed(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    struct pmc_request request = {.kind = PMC_SET_SPEED};
    return read_numbers(pmc_of(unit), params, 1, PMC_SPEED_MAX, &request, refusal) ? ask(pmc_of(unit), &request, refusal) : NULL;
}

static json_t *call_stop(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    bool is_at_once;
    if (!read_flag(params, "at_once", &is_at_once, refusal))
        return NULL;
    return ask_axes(unit, params, is_at_once ? PMC_STOP_NOW : PMC_STOP, refusal);
}

static json_t *call_end(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return ask_axes(unit, params, PMC_STOP_PROGRAM, refusal);
}

static json_t *call_home(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return ask_axes(unit, params, PMC_SEARCH, refusal);
}

static json_t *call_reset(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    (void)params;
    return ask(pmc_of(unit), &(struct pmc_request){.kind = PMC_RESET}, refusal);
}

/* ---- Position and errors -------------------------------------------------------------------------------------------- */

static json_t *for_each_axis(const struct pmc_unit *unit, json_t *(*make)(const struct pmc_unit *unit, unsigned axis))
{
    json_t *object = json_object();
    for (unsigned axis = 0; axis < unit->config.axes; axis++)
        json_object_set_new(object, axis_names[axis], make(unit, axis));
    return object;
}

static json_t *make_position(const struct pmc_unit *unit, unsigned axis)
{
    struct pmc_axis_state state;
    pmc_axis_state(unit, axis, &state);
    return json_pack("{s:i, s:i}", "commanded", (int)state.commanded, "actual", (int)state.actual);
}

static json_t *call_position(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    (void)params;
    (void)refusal;
    return for_each_axis(pmc_of(unit), make_position);
}

static json_t *make_errors(const struct pmc_unit *unit, unsigned axis)
{
    const struct pmc_axis *state = &unit->axis[axis];
    return json_pack("{s:o, s:b}", "errors", pmc_errors_json(state->errors), "not_homed", (int)state->not_homed);
}

static json_t *call_errors(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    (void)params;
    (void)refusal;
    return for_each_axis(pmc_of(unit), make_errors);
}

static json_t *call_clear_errors(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return ask_axes(unit, params, PMC_CLEAR_ERRORS, refusal);
}

static json_t *call_clear_counters(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    bool is_actual;
    if (!read_flag(params, "actual", &is_actual, refusal))
        return NULL;
    return ask_axes(unit, params, is_actual ? PMC_CLEAR_ACTUAL : PMC_CLEAR_COMMANDED, refusal);
}

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

static enum pmc_answer store(struct pmc_unit *unit, unsigned axes)
{
    enum pmc_answer answer = PMC_OK;
    for (unsigned axis = 0; axis < unit->config.axes && answer == PMC_OK; axis++)
        if ((axes & 1u << axis) != 0)
            answer = pmc_is_busy(unit, axis) ? PMC_BUSY : PMC_OK;
    for (unsigned axis = 0; axis < unit->config.axes && answer == PMC_OK; axis++)
        if ((axes & 1u << axis) != 0)
            answer = pmc_store(unit, axis);
    return answer;
}

/* Without `text` only read. The result has the text as it is then. */
static json_t *call_file(struct device_unit *unit, const json_t *params, enum pmc_file what, struct device_refusal *refusal)
{
    struct pmc_unit *core = pmc_of(unit);
    const json_t *given = json_object_get(params, "text");
    char error[DEVICE_ERROR_SIZE];
    if (given && !json_is_string(given))
        return refuse(refusal, false, "text: expected a text");
    if (given) {
        enum pmc_answer answer = pmc_file_load(core, what, json_string_value(given), json_string_length(given), error);
        if (answer == PMC_RANGE)
            return refuse(refusal, false, "text:%s", error);
        if (answer != PMC_OK)
            return result_of(answer, refusal);
    }
    char *text = pmc_file_text(core, what);
    json_t *result = text ? json_pack("{s:s}", "text", text) : refuse(refusal, true, "out of memory");
    free(text);
    return result;
}

static json_t *call_program(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return call_file(unit, params, PMC_FILE_PROGRAM, refusal);
}

static json_t *call_parameters(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    return call_file(unit, params, PMC_FILE_PARAMETERS, refusal);
}

static json_t *call_store(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    uint8_t axes = read_axes(pmc_of(unit), params, refusal);
    return axes != 0 ? result_of(store(pmc_of(unit), axes), refusal) : NULL;
}

/* Write ABS with the present position into a register. */
static json_t *call_register_position(struct device_unit *unit, const json_t *params, struct device_refusal *refusal)
{
    int32_t reg;
    uint8_t axes = read_axes(pmc_of(unit), params, refusal);
    if (axes == 0 || !read_number(params, "reg", 0, PMC_REGISTERS - 1, -1, &reg, refusal))
        return NULL;
    if (axes == 3)
        return refuse(refusal, false, "axes: expected one axis, \"x\" or \"y\"");
    return result_of(pmc_register_position(pmc_of(unit), axes >> 1, (unsigned)reg), refusal);
}

#define NAMES(...) (const char *const[]){__VA_ARGS__, NULL}
#define NO_NAMES (const char *const[]){NULL}

const struct device_method pmc_methods[] = {
    {"pmc.run", call_run, true, NAMES("axes", "reg")},
    {"pmc.jog", call_jog, true, NAMES("x", "y")},
    {"pmc.move", call_move, true, NAMES("x", "y", "relative")},
    {"pmc.speed", call_speed, true, NAMES("x", "y")},
    {"pmc.stop", call_stop, true, NAMES("axes", "at_once")},
    {"pmc.end", call_end, true, NAMES("axes")},
    {"pmc.home", call_home, true, NAMES("axes")},
    {"pmc.reset", call_reset, true, NO_NAMES},
    {"pmc.position", call_position, false, NO_NAMES},
    {"pmc.errors", call_errors, false, NO_NAMES},
    {"pmc.clear_errors", call_clear_errors, true, NAMES("axes")},
    {"pmc.clear_counters", call_clear_counters, true, NAMES("axes", "actual")},
    {"pmc.program", call_program, true, NAMES("text")},
    {"pmc.parameters", call_parameters, true, NAMES("text")},
    {"pmc.store", call_store, true, NAMES("axes")},
    {"pmc.register_position", call_register_position, true, NAMES("axes", "reg")},
    {NULL, NULL, false, NULL},
};
