/* SPDX-License-Identifier: MIT */
/* rkm04 devices: the kinds of devices there are. */
#include <argp.h>
#include <stdio.h>

#include "device/device.h"
#include "options/options.h"
#include "print_json.h"
#include "run.h"
#include "text/text.h"

enum { KEY_JSON = 256 };

static error_t read_option(int key, char *text, struct argp_state *state)
{
    bool *is_json = state->input;
    if (key == KEY_JSON)
        *is_json = true;
    else if (key == ARGP_KEY_ARG)
        argp_error(state, "`%s': expected options only", text);
    else
        return ARGP_ERR_UNKNOWN;
    return 0;
}

static json_t *options_json(const struct device_kind *kind)
{
    json_t *list = json_array();
    for (const struct device_option *option = kind->options; option && option->name; option++)
        json_array_append_new(list, json_pack("{s:s, s:s, s:s}", "name", option->name, "argument", option->argument, "help",
                                              option->help));
    return list;
}

static json_t *services_json(const struct device_kind *kind)
{
    json_t *list = kind->services ? json_array() : NULL; /* NULL: left out */
    for (const struct device_service *service = kind->services; list && service->name; service++)
        json_array_append_new(list, json_pack("{s:s, s:s, s:i}", "name", service->name, "description", service->description,
                                              "clients", (int)service->clients));
    return list;
}

static int print_json(void)
{
    json_t *list = json_array();
    const struct device_kind *kind;
    for (unsigned at = 0; (kind = device_kind_at(at)); at++)
        json_array_append_new(list, json_pack("{s:s, s:s, s:i, s:i, s:i, s:i, s:i, s:o, s:o*}", "name", kind->name, "description",
                                              kind->description, "axes", (int)kind->axes, "inputs", (int)kind->inputs, "outputs",
                                              (int)kind->outputs, "variables", (int)kind->variables, "addresses",
                                              (int)kind->addresses, "options", options_json(kind), "services",
                                              services_json(kind)));
    return print_json_list(list, "rkm04 devices");
}

int devices_main(int argc, char **argv)
{
    static const struct argp_option table[] = {{"json", KEY_JSON, NULL, 0, "As a JSON array of objects", 0}, {0}};
    static const struct argp argp = {
        .options = table,
        .parser = read_option,
        .doc = "List the devices that `rkm04 serve --device' and scenarios know, a line each. The first one is the default."
               "\v"
               "Examples:\n"
               "  rkm04 devices\n"
               "  rkm04 devices --json\n"
               "\n"
               "Exit status: 0 success, 1 standard output cannot be written, 2 wrong usage.",
    };
    bool is_json = false;
    const struct device_kind *kind;
    arguments_parse(&argp, argc, argv, &is_json);
    if (is_json)
        return print_json();
    for (unsigned at = 0; (kind = device_kind_at(at)); at++)
        printf("%-8s %s\n", kind->name, kind->description);
    return arguments_printed();
}
