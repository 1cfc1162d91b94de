/* SPDX-License-Identifier: MIT */
#include "command.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "methods.h"
#include "text/text.h"

#define LIST_SIZE 1024u /* bytes of the names of all methods */

static const struct command_method *const tables[] = {unit_methods, plant_methods, fault_methods, service_methods};

static const struct command_method *find_in_table(const struct command_method *method, const char *name)
{
    while (method->name && strcmp(method->name, name) != 0)
        method++;
    return method->name ? method : NULL;
}

static const struct device_method *find_own(const struct sim *sim, const char *name)
{
    const struct device_method *method = sim_device(sim)->methods;
    while (method && method->name && strcmp(method->name, name) != 0)
        method++;
    return method && method->name ? method : NULL;
}

#define PARAMETERS_MAX 8u /* of a method of a device */

static bool own_params_known(const struct device_method *method, const json_t *params, struct refusal *refusal)
{
    const char *names[PARAMETERS_MAX + 2u] = {0};
    size_t count = 0;
    for (; method->parameters && method->parameters[count] && count < PARAMETERS_MAX; count++)
        names[count] = method->parameters[count];
    names[count] = "unit";
    return !method->parameters || params_known(params, names, refusal);
}

/* A method of the device, for one unit. */
static json_t *call_own(struct sim *sim, const struct device_method *method, const json_t *params, struct refusal *refusal)
{
    struct device_refusal own = {.is_state = false};
    unsigned number = param_unit(sim, params, refusal);
    if (number == 0 || !own_params_known(method, params, refusal))
        return NULL;
    if (!sim_powered(sim, number))
        return refuse(refusal, REFUSED_STATE, "unit %s has no power: switch it on with power", sim->unit[number - 1].name);
    json_t *result = method->call(sim_core(sim, number), params, &own);
    return result ? result : refuse(refusal, own.is_state ? REFUSED_STATE : REFUSED_PARAMS, "%s", own.text);
}

static const struct command_method *find_method(const struct sim *sim, const char *name)
{
    const struct command_method *method = NULL;
    for (size_t i = 0; i < sizeof tables / sizeof tables[0] && !method; i++)
        method = find_in_table(tables[i], name);
    for (size_t i = 0; i < SIM_COMMAND_TABLES && sim->commands[i] && !method; i++)
        method = find_in_table(sim->commands[i], name);
    return method;
}

bool command_attach(struct sim *sim, const struct command_method *methods)
{
    for (size_t i = 0; i < SIM_COMMAND_TABLES; i++) {
        if (sim->commands[i] && sim->commands[i] != methods)
            continue;
        sim->commands[i] = methods;
        return true;
    }
    return false;
}

bool sim_has_command(const struct sim *sim, const char *method)
{
    return find_method(sim, method) || find_own(sim, method);
}

static size_t list_table(const struct command_method *method, char *list, size_t length, size_t size)
{
    for (; method->name && length < size; method++)
        length += (size_t)snprintf(list + length, size - length, "%s, ", method->name);
    return length;
}

/* The names of all methods, for the one that may be meant. */
static void list_methods(const struct sim *sim, char *list, size_t size)
{
    size_t length = (size_t)snprintf(list, size, "%s", sim->outer_methods ? sim->outer_methods : "");
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++)
        length = list_table(tables[i], list, length, size);
    for (size_t i = 0; i < SIM_COMMAND_TABLES && sim->commands[i]; i++)
        length = list_table(sim->commands[i], list, length, size);
    for (const struct device_method *own = sim_device(sim)->methods; own && own->name && length < size; own++)
        length += (size_t)snprintf(list + length, size - length, "%s, ", own->name);
}

/* A kind of device that has this method. NULL: there is none. */
static const struct device_kind *kind_with(const char *name)
{
    const struct device_kind *kind;
    for (unsigned at = 0; (kind = device_kind_at(at)) != NULL; at++)
        for (const struct device_method *own = kind->methods; own && own->name; own++)
            if (strcmp(own->name, name) == 0)
                return kind;
    return NULL;
}

static json_t *refuse_unknown(const struct sim *sim, const char *name, struct refusal *refusal)
{
    char list[LIST_SIZE];
    const struct device_kind *kind = kind_with(name);
    if (kind)
        return refuse(refusal, REFUSED_METHOD, "there is no method `%.80s' of the device %s: %s has it", name,
                      sim_device(sim)->name, kind->name);
    list_methods(sim, list, sizeof list);
    return refuse(refusal, REFUSED_METHOD, "there is no method `%.80s'%s", name, nearest_hint(name, list));
}

json_t *sim_command(struct sim *sim, const char *name, const json_t *params, struct refusal *refusal)
{
    const struct command_method *method = find_method(sim, name);
    const struct device_method *own = method ? NULL : find_own(sim, name);
    const bool changes = method ? method->changes : own && own->changes;
    if (!method && !own)
        return refuse_unknown(sim, name, refusal);
    if (params && !json_is_object(params))
        return refuse(refusal, REFUSED_PARAMS, "params: expected an object, as in {\"unit\": 1}");
    if (changes)
        sim_finish_tick(sim);
    uint64_t now = sim_now(sim);
    json_t *result = method ? method->function(sim, params, refusal) : call_own(sim, own, params, refusal);
    if (result && changes && sim->journal)
        sim->journal->command(sim->journal->context, now, name, params);
    return result;
}

json_t *refuse(struct refusal *refusal, int code, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    refusal->code = code;
    vsnprintf(refusal->text, sizeof refusal->text, format, list);
    va_end(list);
    invisible_note(refusal->text, sizeof refusal->text);
    return NULL;
}

/* ---- Parameters ----------------------------------------------------------------------------------------------------- */

/* The names there are, as in "1, 2, 5-2". */
static void list_units(const struct sim *sim, char *text, size_t size)
{
    size_t length = 0;
    text[0] = '\0';
    for (unsigned number = 1; number <= sim_units(sim) && length < size; number++)
        length += (size_t)snprintf(text + length, size - length, number > 1 ? ", %s" : "%s", sim->unit[number - 1u].name);
}

unsigned param_unit(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    const json_t *value = json_object_get(params, "unit");
    char name[NODE_NAME_SIZE] = "", units[160];
    if (!value && sim_units(sim) == 1)
        return 1;
    if (json_is_integer(value) && json_integer_value(value) >= 1 && json_integer_value(value) <= sim_device(sim)->addresses)
        snprintf(name, sizeof name, "%d", (int)json_integer_value(value));
    else if (json_is_string(value) && json_string_length(value) < sizeof name &&
             json_string_length(value) == strlen(json_string_value(value)))
        memcpy(name, json_string_value(value), json_string_length(value) + 1);
    unsigned number = sim_unit_named(sim, name);
    if (number > 0)
        return number;
    list_units(sim, units, sizeof units);
    refuse(refusal, REFUSED_PARAMS, "unit: %s: expected one of %s", value ? "there is no such unit" : "missing", units);
    return 0;
}

static bool read_integer(const json_t *value, const char *name, int64_t low, int64_t high, int64_t *number,
                         struct refusal *refusal)
{
    if (json_is_integer(value) && json_integer_value(value) >= low && json_integer_value(value) <= high) {
        *number = json_integer_value(value);
        return true;
    }
    refuse(refusal, REFUSED_PARAMS, "%s: expected a whole number from %lld to %lld", name, (long long)low, (long long)high);
    return false;
}

bool param_integer(const json_t *params, const char *name, int64_t low, int64_t high, int64_t *value, struct refusal *refusal)
{
    return read_integer(json_object_get(params, name), name, low, high, value, refusal);
}

bool param_integer_or(const json_t *params, const char *name, int64_t low, int64_t high, int64_t missing, int64_t *value,
                      struct refusal *refusal)
{
    const json_t *given = json_object_get(params, name);
    *value = missing;
    return !given || read_integer(given, name, low, high, value, refusal);
}

bool param_time(const json_t *params, const char *name, uint64_t missing, uint64_t *ticks, struct refusal *refusal)
{
    const json_t *value = json_object_get(params, name);
    size_t wrong;
    if (!value && missing != DEVICE_NEVER) {
        *ticks = missing;
        return true;
    }
    if (json_is_integer(value) && json_integer_value(value) >= 0 && (uint64_t)json_integer_value(value) <= TIME_VALUE_MAX) {
        *ticks = (uint64_t)json_integer_value(value);
        return true;
    }
    if (json_is_string(value) && !time_value_read(json_string_value(value), json_string_length(value), ticks, &wrong))
        return true;
    refuse(refusal, REFUSED_PARAMS, "%s: expected a time from " TIME_VALUE_RANGE ": a whole number of us, or as in "
           "\"250us\", \"1500ms\", \"2.5s\"", name);
    return false;
}

const char *param_string(const json_t *params, const char *name, struct refusal *refusal)
{
    const char *text = json_string_value(json_object_get(params, name));
    if (!text)
        refuse(refusal, REFUSED_PARAMS, "%s: expected a string", name);
    return text;
}

bool param_flag(const json_t *params, const char *name, bool *value, struct refusal *refusal)
{
    const json_t *given = json_object_get(params, name);
    *value = json_is_true(given);
    if (!given || json_is_boolean(given))
        return true;
    refuse(refusal, REFUSED_PARAMS, "%s: expected true or false", name);
    return false;
}

bool params_known(const json_t *params, const char *const *names, struct refusal *refusal)
{
    const char *key;
    const json_t *value;
    char list[400] = "";
    for (size_t i = 0; names[i]; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), i > 0 ? ", %s" : "%s", names[i]);
    json_object_foreach((json_t *)params, key, value) {
        size_t i = 0;
        while (names[i] && strcmp(names[i], key) != 0)
            i++;
        if (names[i])
            continue;
        refuse(refusal, REFUSED_PARAMS, "unknown parameter `%.60s': expected %s%s", key, *list ? list : "none",
               nearest_hint(key, list));
        return false;
    }
    return true;
}
