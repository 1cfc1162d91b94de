/* SPDX-License-Identifier: MIT */
/* A PMC of an emulator, through its control socket: the methods pmc.* of docs/CONTROL.md. */
#include <stdlib.h>
#include <string.h>

#include "client_pmc_way.h"

static const char *const axis_names[PMC_AXES] = {"x", "y"};

static json_t *axes_json(uint8_t axes)
{
    static const char *const names[] = {"", "x", "y", "xy"};
    return json_string(names[axes & 3u]);
}

/* Values of the axes of a request. */
static void put_values(json_t *params, const struct pmc_request *request)
{
    for (unsigned axis = 0; axis < PMC_AXES; axis++) {
        if ((request->axes & 1u << axis) == 0)
            continue;
        bool is_jog = request->kind == PMC_JOG;
        json_object_set_new(params, axis_names[axis], is_jog ? json_string(request->value[axis] > 0 ? "+" : "-")
                                                             : json_integer(request->value[axis]));
    }
}

/* The method of a request, and its parameters. NULL: there is none. */
static const char *method_of(const struct pmc_request *request, json_t *params)
{
    switch (request->kind) {
    case PMC_JOG:
        put_values(params, request);
        return "pmc.jog";
    case PMC_MOVE_TO:
    case PMC_MOVE_BY:
        put_values(params, request);
        json_object_set_new(params, "relative", json_boolean(request->kind == PMC_MOVE_BY));
        return "pmc.move";
    case PMC_SET_SPEED:
        put_values(params, request);
        return "pmc.speed";
    default:
        json_object_set_new(params, "axes", axes_json(request->axes));
        break;
    }
    if (request->kind == PMC_RUN)
        json_object_set_new(params, "reg", json_integer(request->value[request->axes == 2]));
    if (request->kind == PMC_STOP_NOW)
        json_object_set_new(params, "at_once", json_true());
    return request->kind == PMC_RUN ? "pmc.run" : request->kind == PMC_SEARCH ? "pmc.home" : "pmc.stop";
}

static enum exit_status ask(struct pmc_link *link, const struct pmc_request *request)
{
    json_t *result, *params = json_object();
    if (request->kind == PMC_CLEAR_ERRORS) {
        json_object_set_new(params, "axes", axes_json(request->axes));
        enum exit_status cleared = client_job_call(link->job, "pmc.clear_errors", params, true, &result);
        json_decref(result);
        return cleared;
    }
    const char *method = method_of(request, params);
    enum exit_status status = client_job_call(link->job, method, params, true, &result);
    json_decref(result);
    return status;
}

/* Call a method whose result has a member for each axis. */
static enum exit_status call_axes(struct pmc_link *link, const char *method, json_t **result, unsigned *axes)
{
    enum exit_status status = client_job_call(link->job, method, NULL, true, result);
    *axes = json_object_get(*result, axis_names[1]) ? 2 : 1;
    return status;
}

static enum exit_status positions(struct pmc_link *link, int32_t position[PMC_AXES], unsigned *axes)
{
    json_t *result;
    enum exit_status status = call_axes(link, "pmc.position", &result, axes);
    for (unsigned axis = 0; axis < *axes; axis++)
        position[axis] = (int32_t)json_integer_value(json_object_get(json_object_get(result, axis_names[axis]), "commanded"));
    json_decref(result);
    return status;
}

static uint8_t errors_of(const json_t *list)
{
    static const char *const names[] = {"sl+", "sl-", "hl+", "hl-", "emg", "pgm", "hom", "inx"};
    uint8_t errors = 0;
    size_t i;
    json_t *name;
    json_array_foreach(list, i, name)
        for (unsigned bit = 0; bit < 8; bit++)
            if (strcmp(json_string_value(name) ? json_string_value(name) : "", names[bit]) == 0)
                errors |= (uint8_t)(1u << bit);
    return errors;
}

static enum exit_status errors(struct pmc_link *link, uint8_t found[PMC_AXES], unsigned *axes)
{
    json_t *result;
    enum exit_status status = call_axes(link, "pmc.errors", &result, axes);
    for (unsigned axis = 0; axis < *axes; axis++)
        found[axis] = errors_of(json_object_get(json_object_get(result, axis_names[axis]), "errors"));
    json_decref(result);
    return status;
}

static const char *file_method(enum pmc_text_kind kind)
{
    return kind == PMC_TEXT_PROGRAM ? "pmc.program" : "pmc.parameters";
}

static enum exit_status get(struct pmc_link *link, enum pmc_text_kind kind, char **text)
{
    json_t *result;
    enum exit_status status = client_job_call(link->job, file_method(kind), NULL, true, &result);
    const char *found = json_string_value(json_object_get(result, "text"));
    *text = found ? strdup(found) : NULL;
    json_decref(result);
    return status == STATUS_SUCCESS && !*text ? STATUS_FAILURE : status;
}

/* Check the text here, where all errors can be shown; for as many axes as the unit has. */
static bool is_right(enum pmc_text_kind kind, unsigned axes, const char *name, const char *text)
{
    struct pmc_command program[PMC_AXES][PMC_REGISTERS];
    struct pmc_parameters parameters[PMC_AXES];
    char file[256];
    strncpy(file, name, sizeof file - 1u)[sizeof file - 1u] = '\0';
    return kind == PMC_TEXT_PROGRAM ? pmc_program_read(text, strlen(text), axes, program, client_pmc_print_error, file)
                                    : pmc_parameters_read(text, strlen(text), axes, parameters, client_pmc_print_error, file);
}

static enum exit_status put(struct pmc_link *link, enum pmc_text_kind kind, const char *name, const char *text)
{
    int32_t position[PMC_AXES];
    unsigned axes;
    json_t *result;
    enum exit_status status = positions(link, position, &axes);
    if (status != STATUS_SUCCESS)
        return status;
    if (!is_right(kind, axes, name, text))
        return STATUS_FAILURE;
    status = client_job_call(link->job, file_method(kind), json_pack("{s:s}", "text", text), true, &result);
    json_decref(result);
    return status;
}

static enum exit_status store(struct pmc_link *link, uint8_t axes)
{
    json_t *result;
    json_t *params = axes != 0 ? json_pack("{s:o}", "axes", axes_json(axes)) : NULL;
    enum exit_status status = client_job_call(link->job, "pmc.store", params, true, &result);
    json_decref(result);
    return status;
}

const struct pmc_way client_pmc_control = {
    .name = "control", .ask = ask, .positions = positions, .errors = errors, .get = get, .put = put, .store = store};
