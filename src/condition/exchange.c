/* SPDX-License-Identifier: MIT */
/* The exchange of a device: set, let slots pass, get. */
#include <string.h>

#include "condition.h"

#define SLOTS_MAX 3600000 /* an hour of 1 ms */

bool exchange_is_named(const struct sim *sim, const char *method)
{
    const struct device_exchange *exchange = sim_device(sim)->exchange_of;
    return exchange && strcmp(method, exchange->name) == 0;
}

/* {member: what `from` has, unit: ...} for one of its two methods; NULL: out of memory. */
static json_t *part_of(const json_t *params, const char *from, const char *member)
{
    json_t *part = json_object(), *value = json_object_get(params, from), *unit = json_object_get(params, "unit");
    if (part && value)
        json_object_set(part, member, value);
    if (part && unit)
        json_object_set(part, "unit", unit);
    return part;
}

/* Do what `set` has; a first answer of `get` shows that there will be one. */
static bool set_cells(struct sim *sim, const json_t *params, const json_t *get, struct refusal *refusal)
{
    const struct device_exchange *exchange = sim_device(sim)->exchange_of;
    json_t *answer = sim_command(sim, exchange->get, get, refusal);
    json_t *set = answer && json_object_get(params, "set") ? part_of(params, "set", exchange->member) : NULL;
    bool is_done = answer != NULL;
    if (set) {
        json_t *done = sim_command(sim, exchange->set, set, refusal);
        is_done = done != NULL;
        json_decref(done);
    }
    json_decref(set);
    json_decref(answer);
    return is_done;
}

/* The tick at which so many slots have passed. Returns false: refused. */
static bool find_end(struct sim *sim, const json_t *params, uint64_t *end, struct refusal *refusal)
{
    const struct device_kind *kind = sim_device(sim);
    const unsigned unit = param_unit(sim, params, refusal);
    int64_t slots;
    if (unit == 0 || !param_integer_or(params, "slots", 0, SLOTS_MAX, 1, &slots, refusal))
        return false;
    const struct device_unit *core = sim_core(sim, unit);
    *end = sim_now(sim) + kind->exchange_of->end(core, (unsigned)slots) - kind->now(core);
    const char *why = !sim_powered(sim, unit) ? "the unit has no power" : *end > SIM_TIME_MAX ? "virtual time ends before" : NULL;
    if (why)
        refuse(refusal, REFUSED_STATE, "%s", why);
    return !why;
}

bool exchange_begin(struct exchange *exchange, struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"set", "slots", "get", "unit", NULL};
    const struct device_exchange *of = sim_device(sim)->exchange_of;
    uint64_t end;
    *exchange = (struct exchange){.get = NULL};
    if (!params_known(params, names, refusal) || !find_end(sim, params, &end, refusal))
        return false;
    json_t *get = part_of(params, "get", of->member);
    if (get && !json_object_get(get, of->member))
        json_object_set_new(get, of->member, json_array());
    if (!set_cells(sim, params, get, refusal)) {
        json_decref(get);
        return false;
    }
    *exchange = (struct exchange){of->get, get, end};
    return true;
}

json_t *exchange_answer(const struct exchange *exchange, struct sim *sim, struct refusal *refusal)
{
    return sim_command(sim, exchange->get, exchange->params, refusal);
}

void exchange_drop(struct exchange *exchange)
{
    json_decref(exchange->params);
    *exchange = (struct exchange){.get = NULL};
}
