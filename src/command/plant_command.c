/* SPDX-License-Identifier: MIT */
/* plant_command.c: plant.get and plant.set. */
#include <stdlib.h>
#include <string.h>

#include "methods.h"

#define ERRORS_SIZE 280u /* of what a refusal repeats */

/* The counter beside the true position, for every motor of the plant. */
static bool add_counters(struct sim *sim, unsigned number, json_t *motors)
{
    size_t i;
    json_t *motor;
    bool ok = true;
    json_array_foreach(motors, i, motor) {
        unsigned which = (unsigned)json_integer_value(json_object_get(motor, "motor"));
        ok = ok && which >= 1 && which <= sim_device(sim)->axes &&
               json_object_set_new(motor, "position", json_integer(sim_axis(sim, number, which).position)) == 0;
    }
    return ok;
}

/* All that there is to say of the plant of a unit. */
static json_t *plant_result(struct sim *sim, unsigned number, struct refusal *refusal)
{
    json_t *plant = plant_json(sim->unit[number - 1u].plant);
    json_t *result = json_pack("{s:I, s:o}", "t_us", (json_int_t)sim_now(sim), "plant", plant);
    if (result && add_counters(sim, number, json_object_get(plant, "motors")))
        return result;
    json_decref(result);
    return refuse(refusal, REFUSED_MEMORY, "out of memory");
}

static json_t *command_plant_get(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const names[] = {"unit", NULL};
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    return number > 0 ? plant_result(sim, number, refusal) : NULL;
}

/* ---- A new plant ---------------------------------------------------------------------------------------------------- */

/* The first error out of what sim_configure_plants() says. Of a plant given as an object the place says nothing. */
static json_t *refuse_plant(struct refusal *refusal, char *errors, bool object)
{
    char *end = strchr(errors, '\n'), *text = object ? strstr(errors, "error: ") : NULL;
    if (end)
        *end = '\0';
    return refuse(refusal, REFUSED_PARAMS, "plant: %.*s", (int)ERRORS_SIZE, text ? text + strlen("error: ") : errors);
}

static json_t *configure_text(struct sim *sim, const char *text, bool object, struct refusal *refusal)
{
    char *errors = NULL;
    size_t size;
    FILE *out = open_memstream(&errors, &size);
    bool ok = out && sim_configure_plants(sim, "plant", text, text ? strlen(text) : 0, out);
    bool told = out && fclose(out) == 0 && size > 0;
    json_t *result = ok ? json_pack("{s:I}", "t_us", (json_int_t)sim_now(sim)) : NULL;
    if (!ok && told)
        refuse_plant(refusal, errors, object);
    else if (!result)
        refuse(refusal, REFUSED_MEMORY, "out of memory");
    free(errors);
    return result;
}

static json_t *configure_plant(struct sim *sim, const json_t *plant, struct refusal *refusal)
{
    if (json_is_null(plant))
        return configure_text(sim, NULL, false, refusal);
    if (json_is_string(plant))
        return configure_text(sim, json_string_value(plant), false, refusal);
    if (!json_is_object(plant))
        return refuse(refusal, REFUSED_PARAMS, "plant: expected an object, the text of a plant file, or null");
    char *text = json_dumps(plant, JSON_COMPACT);
    json_t *result = text ? configure_text(sim, text, true, refusal) : refuse(refusal, REFUSED_MEMORY, "out of memory");
    free(text);
    return result;
}

/* ---- A hand at the motor -------------------------------------------------------------------------------------------- */

static json_t *place_axis(struct sim *sim, struct sim_unit *unit, unsigned motor, int64_t position, struct refusal *refusal)
{
    struct plant_change change;
    if (!plant_place(unit->plant, sim_now(sim), motor, position))
        return refuse(refusal, REFUSED_PARAMS, "position: expected a position between the end stops of motor %u", motor);
    while (plant_take_change(unit->plant, sim_now(sim) + 1u, &change)) {
        /* it counts from now on */
    }
    sim_update_inputs(sim, unit->number);
    return plant_result(sim, unit->number, refusal);
}

static json_t *change_motor(struct sim *sim, unsigned number, const json_t *params, struct refusal *refusal)
{
    struct sim_unit *unit = &sim->unit[number - 1u];
    bool held = json_object_get(params, "jammed"), taken = json_object_get(params, "missing_lead"), jammed, missing;
    int64_t motor, position;
    if (!param_integer(params, "motor", 1, sim_device(sim)->axes, &motor, refusal) ||
        !param_flag(params, "jammed", &jammed, refusal) || !param_flag(params, "missing_lead", &missing, refusal))
        return NULL;
    unsigned which = (unsigned)motor;
    if (!unit->plant || !plant_position(unit->plant, which, &position))
        return refuse(refusal, REFUSED_STATE, "motor %u is not in the plant: configure it with plant.set and plant", which);
    bool placed = json_object_get(params, "position");
    if (!placed && !held && !taken)
        return refuse(refusal, REFUSED_PARAMS, "expected position, jammed or missing_lead");
    if (placed && (held || taken))
        return refuse(refusal, REFUSED_PARAMS, "expected position alone, without jammed and missing_lead");
    if (placed)
        return param_integer(params, "position", -PLANT_POSITION_MAX, PLANT_POSITION_MAX, &position, refusal)
                   ? place_axis(sim, unit, which, position, refusal)
                   : NULL;
    if (held)
        plant_jam(unit->plant, which, jammed);
    if (taken)
        plant_take_lead(unit->plant, which, missing);
    return plant_result(sim, number, refusal);
}

static json_t *command_plant_set(struct sim *sim, const json_t *params, struct refusal *refusal)
{
    static const char *const whole[] = {"plant", NULL};
    static const char *const names[] = {"unit", "motor", "position", "jammed", "missing_lead", NULL};
    const json_t *plant = json_object_get(params, "plant");
    if (plant)
        return params_known(params, whole, refusal) ? configure_plant(sim, plant, refusal) : NULL;
    if (json_object_size(params) == 0)
        return refuse(refusal, REFUSED_PARAMS, "expected plant, or motor and one of position, jammed, missing_lead");
    unsigned number = params_known(params, names, refusal) ? param_unit(sim, params, refusal) : 0;
    return number > 0 ? change_motor(sim, number, params, refusal) : NULL;
}

const struct command_method plant_methods[] = {
    {"plant.get", command_plant_get, false},
    {"plant.set", command_plant_set, true},
    {NULL, NULL, false},
};
