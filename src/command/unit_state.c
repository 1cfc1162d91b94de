/* SPDX-License-Identifier: MIT */
/* unit_state.c: all that is known of a unit on a bus: what the unit itself knows, its plant, its place, its power, the bus. */
#include "unit_state.h"

#include "device/device.h"
#include "sim/sim.h"

/* Put `value` into the object, which is NULL if memory has been short. */
static void put_member(json_t *object, const char *name, json_t *value)
{
    if (!value || !object)
        json_decref(value);
    else
        json_object_set_new(object, name, value);
}

/* Make `name`, if it is there, the last member of the object. */
static void move_to_end(json_t *object, const char *name)
{
    json_t *value = json_incref(json_object_get(object, name));
    json_object_del(object, name);
    put_member(object, name, value);
}

static void put_true_positions(json_t *motors, const struct plant *plant)
{
    int64_t position;
    for (unsigned motor = 1; plant && motor <= json_array_size(motors); motor++)
        if (plant_position(plant, motor, &position))
            put_member(json_array_get(motors, motor - 1u), "true_position", json_integer(position));
}

static json_t *line_json(const struct segment *segment)
{
    struct segment_counters counters = segment_counters(segment);
    return json_pack("{s:I, s:I, s:I, s:I}", "bytes", (json_int_t)counters.bytes, "collisions",
                     (json_int_t)counters.collisions, "framing_errors", (json_int_t)counters.framing_errors, "overruns",
                     (json_int_t)counters.overruns);
}

/* What a panel has to know of another kind than the usual one. */
static json_t *device_json(const struct device_kind *kind)
{
    return json_pack("{s:s, s:i, s:i, s:i, s:i, s:i, s:b}", "name", kind->name, "axes", (int)kind->axes, "inputs",
                     (int)kind->inputs, "outputs", (int)kind->outputs, "variables", (int)kind->variables, "first_variable",
                     (int)kind->first_variable, "bus", kind->receive != NULL);
}

json_t *unit_state(struct sim *sim, unsigned number)
{
    const struct sim_unit *unit = &sim->unit[number - 1u];
    json_t *state = sim_device(sim)->describe(sim_core(sim, number), sim_now(sim));
    put_true_positions(json_object_get(state, "motors"), unit->plant);
    put_member(state, "unit", json_string(unit->name));
    move_to_end(state, "node");
    put_member(state, "switch", json_integer(sim->config.nodes.node[number - 1u]));
    put_member(state, "powered", json_boolean(sim_powered(sim, number)));
    put_member(state, "since_us", json_integer((json_int_t)segment_since(&sim->segment, number)));
    if (sim_device(sim) != device_kind_at(0))
        put_member(state, "device", device_json(sim_device(sim)));
    move_to_end(state, "simulation");
    move_to_end(state, "counters");
    put_member(state, "line", line_json(&sim->segment));
    return state;
}
