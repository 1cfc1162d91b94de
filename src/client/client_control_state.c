/* SPDX-License-Identifier: MIT */
/* Commands about what there is: state, di. */
#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_job.h"
#include "client_panel.h"
#include "text/text.h"

#define TEXT_COLUMNS 100

/* ---- State ------------------------------------------------------------------------------------------------------------ */

static json_int_t integer_of(const json_t *object, const char *key)
{
    return json_integer_value(json_object_get(object, key));
}

/* ": 1@500, 61@500, …" */
static void print_profile(const json_t *profile)
{
    size_t i;
    json_t *point;
    if (json_array_size(profile) == 0)
        return;
    printf("           break points:");
    json_array_foreach((json_t *)profile, i, point)
        printf(" (%" JSON_INTEGER_FORMAT ";%" JSON_INTEGER_FORMAT ")", json_integer_value(json_array_get(point, 0)),
               json_integer_value(json_array_get(point, 1)));
    putchar('\n');
}

static void print_functions(const json_t *functions)
{
    size_t i;
    json_t *function;
    json_array_foreach((json_t *)functions, i, function)
        printf(" T%02d", (int)json_integer_value(function));
}

/* What the panel has no room for: of motors with a program. */
static void print_motor(const json_t *motor)
{
    if (json_object_get(motor, "parameters") == NULL)
        return;
    const json_t *parameters = json_object_get(motor, "parameters");
    const char *slot = json_string_value(json_object_get(motor, "slot"));
    printf(" motor %" JSON_INTEGER_FORMAT ":  %" JSON_INTEGER_FORMAT " of 700 commands, flash %s,  S%" JSON_INTEGER_FORMAT
           " V%" JSON_INTEGER_FORMAT " A%" JSON_INTEGER_FORMAT " %c%" JSON_INTEGER_FORMAT,
           integer_of(motor, "motor"), integer_of(json_object_get(motor, "memory"), "commands"), slot != NULL ? slot : "-",
           integer_of(parameters, "start_speed"), integer_of(parameters, "speed"), integer_of(parameters, "acceleration"),
           json_is_false(json_object_get(parameters, "forward")) ? 'B' : 'F', integer_of(parameters, "count"));
    print_functions(json_object_get(motor, "functions"));
    if (json_array_size(json_object_get(motor, "loops")) > 0 || json_array_size(json_object_get(motor, "calls")) > 0)
        printf(",  %zu loops open, %zu calls", json_array_size(json_object_get(motor, "loops")),
               json_array_size(json_object_get(motor, "calls")));
    if (integer_of(motor, "steps") > 0)
        printf(",  %" JSON_INTEGER_FORMAT " steps done", integer_of(motor, "steps"));
    putchar('\n');
    print_profile(json_object_get(motor, "profile"));
}

static void print_state(const json_t *state)
{
    static struct panel panel;
    struct panel_view view = {.state = state};
    size_t i;
    json_t *motor;
    client_panel_draw(&panel, &view, PANEL_ROWS, TEXT_COLUMNS);
    client_panel_print(&panel, stdout);
    putchar('\n');
    json_array_foreach(json_object_get(state, "motors"), i, motor)
        print_motor(motor);
}

/* The state of the unit `unit`; NULL: of the only one. */
static enum exit_status show_state(struct client_job *job, const char *unit)
{
    json_t *result;
    json_t *params = unit != NULL ? json_pack("{s:s}", "unit", unit) : NULL;
    enum exit_status status = client_job_call(job, "state", params, false, &result);
    if (status == STATUS_SUCCESS && !job->json)
        print_state(result);
    return status == STATUS_SUCCESS ? client_job_done(job, result) : status;
}

/* Readings that are not at their default, on a line; nothing if there are none. */
static void print_readings(const json_t *readings)
{
    static const char *const none[] = {NULL};
    if (json_object_size(readings) == 0)
        return;
    fputs("readings", stdout);
    client_job_print_members(readings, none);
    putchar('\n');
}

enum exit_status client_control_state(struct client_job *job)
{
    size_t i;
    json_t *units, *unit;
    enum exit_status status = client_job_call(job, "units", NULL, false, &units);
    if (status == STATUS_SUCCESS && !job->json)
        print_readings(json_object_get(units, "readings"));
    if (status == STATUS_SUCCESS && job->unit != NULL) {
        json_decref(units);
        return show_state(job, job->unit);
    }
    json_array_foreach(json_object_get(units, "units"), i, unit) {
        if (i > 0 && !job->json)
            putchar('\n');
        if (status == STATUS_SUCCESS)
            status = show_state(job, json_string_value(unit));
    }
    json_decref(units);
    return status;
}

/* ---- Inputs ----------------------------------------------------------------------------------------------------------- */

/* What the device calls its inputs: a list, or NULL if they have numbers alone. A new reference. */
static json_t *fetch_input_names(struct client_job *job)
{
    json_t *units;
    if (client_job_call(job, "units", NULL, false, &units) != STATUS_SUCCESS)
        return NULL;
    json_t *names = json_incref(json_object_get(units, "inputs"));
    json_decref(units);
    return names;
}

/* `names`: as of fetch_input_names(). */
static void print_inputs(const json_t *names, json_int_t mask)
{
    size_t count = names != NULL ? json_array_size(names) : 8;
    for (size_t i = 0; i < count; i++) {
        if (names != NULL)
            printf("%s", json_string_value(json_array_get(names, i)));
        else
            printf("%02zu", i + 1);
        printf("=%d%c", (int)(mask >> i & 1), i + 1 < count ? ' ' : '\n');
    }
}

static enum exit_status show_inputs(struct client_job *job)
{
    json_t *result;
    enum exit_status status = client_job_call(job, "state", NULL, true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    json_int_t mask = integer_of(result, "di"), t_us = integer_of(result, "t_us");
    json_decref(result);
    if (job->json)
        return client_print_json(json_pack("{s:I, s:I}", "t_us", t_us, "di", mask));
    json_t *names = fetch_input_names(job);
    print_inputs(names, mask);
    json_decref(names);
    return STATUS_SUCCESS;
}

/* Read "3=1", "08=0", "di3=1", "near=1". Returns false if it is wrong. */
static bool read_input(const char *word, json_t *inputs)
{
    char name[16];
    uint64_t number;
    if (strncmp(word, "di", 2) == 0 && word[2] >= '0' && word[2] <= '9')
        word += 2;
    size_t length = strcspn(word, "=");
    const char *end = word + length;
    if (length < 1 || length >= sizeof name || end[0] != '=' || (end[1] != '0' && end[1] != '1') || end[2] != '\0')
        return false;
    snprintf(name, sizeof name, "%.*s", (int)length, word);
    bool is_number = strspn(name, "0123456789") == length;
    if (is_number && (length > 2 || !number_read(name, 1, 32, &number)))
        return false;
    json_object_set_new(inputs, name, json_integer(end[1] - '0'));
    return true;
}

static void warn_overridden(const json_t *result)
{
    size_t i;
    json_t *input;
    json_array_foreach(json_object_get(result, "overridden"), i, input)
        warnx("input %02d is unchanged: the plant or an injected fault holds it at %d", (int)json_integer_value(input),
              (int)(integer_of(result, "di") >> (json_integer_value(input) - 1) & 1));
}

enum exit_status client_control_di(struct client_job *job)
{
    json_t *result, *inputs = json_object();
    for (size_t i = 0; i < job->count; i++) {
        if (!read_input(job->words[i], inputs)) {
            json_decref(inputs);
            return client_usage("di: expected an input, its number or name, and its level, as in 3=1, found '%s'", job->words[i]);
        }
    }
    if (job->count == 0) {
        json_decref(inputs);
        return show_inputs(job);
    }
    enum exit_status status = client_job_call(job, "di.set", json_pack("{s:o}", "di", inputs), true, &result);
    if (status != STATUS_SUCCESS)
        return status;
    warn_overridden(result);
    json_t *known = job->json ? NULL : fetch_input_names(job);
    if (!job->json)
        print_inputs(known, integer_of(result, "di"));
    json_decref(known);
    return client_job_done(job, result);
}
