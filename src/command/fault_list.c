/* SPDX-License-Identifier: MIT */
/* fault.list: what faults there are, and how often each has acted. */
#include "methods.h"

static void put(json_t *object, const char *name, json_t *value)
{
    json_object_set_new(object, name, value); /* short of memory: it is missing */
}

static void put_time(json_t *object, const char *name, uint64_t ticks)
{
    put(object, name, ticks == RKM04_NEVER ? json_null() : json_integer((json_int_t)ticks));
}

static const char *state_of(const struct fault *fault, uint64_t now)
{
    if (fault->active || fault->victim != 0)
        return "active";
    if (fault_spent(fault, now))
        return "spent";
    return fault->from > now ? "waiting" : "armed";
}

static const char *operation_of(const struct fault *fault)
{
    switch (fault->operations) {
    case FAULT_READ:
        return "read";
    case FAULT_ERASE:
        return "erase";
    case FAULT_PROGRAM:
        return "program";
    default:
        return "write";
    }
}

/* What the kind has of its own. */
static void put_own(json_t *object, const struct fault *fault)
{
    switch (fault->kind) {
    case FAULT_FLIP:
        put(object, "mask", json_integer(fault->number));
        break;
    case FAULT_INSERT:
        put(object, "byte", json_integer(fault->number));
        break;
    case FAULT_DELAY:
        put_time(object, "delay_us", fault->ticks);
        break;
    case FAULT_CUT:
        put(object, "bytes", json_integer(fault->number));
        break;
    case FAULT_FLASH:
        put(object, "operation", json_string(operation_of(fault)));
        put(object, "torn", json_boolean(fault->torn));
        break;
    case FAULT_POWER:
        put(object, "operation", json_integer(fault->number));
        break;
    case FAULT_INPUT:
        put(object, "input", json_integer(fault->number));
        put(object, "level", json_integer(fault->level));
        break;
    default:
        break;
    }
}

static json_t *show(const struct sim *sim, const struct fault *fault)
{
    static const char *const ways[] = {NULL, "to_units", "to_master", "both"};
    json_t *object = json_object();
    put(object, "id", json_integer((json_int_t)fault->id));
    put(object, "kind", json_string(fault_kind_name((enum fault_kind)fault->kind)));
    put(object, "state", json_string(state_of(fault, sim_now(sim))));
    put(object, "acted", json_integer((json_int_t)fault->acted));
    put(object, "left", fault->counted ? json_integer((json_int_t)fault->left) : json_null());
    put(object, "skip", json_integer((json_int_t)fault->skip));
    put(object, "probability", json_real(fault->millionths / 1e6));
    put_time(object, "from_us", fault->from);
    put_time(object, "until_us", fault->until);
    put(object, "unit", fault->unit > 0 ? json_string(sim->unit[fault->unit - 1u].name) : json_null());
    if (fault->direction != 0)
        put(object, "direction", json_string(ways[fault->direction]));
    if (fault->kind >= FAULT_POWER)
        put_time(object, "duration_us", fault->ticks);
    if (fault->kind >= FAULT_BREAK)
        put_time(object, "every_us", fault->every > 0 ? fault->every : RKM04_NEVER);
    put_own(object, fault);
    return object;
}

json_t *command_fault_list(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {NULL};
    if (!params_known(params, names, refusal))
        return NULL;
    json_t *list = json_array();
    for (unsigned i = 0; i < sim->faults.count; i++)
        json_array_append_new(list, show(sim, &sim->faults.fault[i]));
    return json_pack("{s:o}", "faults", list);
}
