/* SPDX-License-Identifier: MIT */
/* sim_plants.c: the plants of a bus from one text: one for each unit, hung on the sim. */
#include "sim.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

/* The plants of all units, before they take the place of those there are. */
struct plants {
    struct plant *of[SEGMENT_UNITS];
};

static void free_plants(struct plants *plants)
{
    for (unsigned at = 0; at < SEGMENT_UNITS; at++)
        plant_free(plants->of[at]);
}

static struct plant *read_plant(struct sim *sim, const struct config_node *node, unsigned number)
{
    const struct device_kind *kind = sim_device(sim);
    struct plant_device device = {.kind = kind};
    const struct device_unit *unit = sim_core(sim, number);
    device.outputs = kind->outputs_of(unit);
    for (unsigned axis = 1; axis <= kind->axes; axis++) {
        device.position[axis - 1u] = sim_axis(sim, number, axis).position;
        device.has_coils[axis - 1u] = kind->coils && kind->coils(unit, axis, &device.coils[axis - 1u]);
    }
    return plant_read(node, &device, sim_now(sim), sim->config.seed);
}

/* {"3": …, "5-2": …} */
static bool read_units(struct sim *sim, const struct config_node *node, struct plants *plants)
{
    const char *names[SEGMENT_UNITS + 1u];
    for (unsigned at = 0; at < sim_units(sim); at++)
        names[at] = sim->unit[at].name;
    names[sim_units(sim)] = NULL;
    if (config_type(node) != CONFIG_MAP)
        return config_error(node, "expected plants by unit, as in {3: {motors: …, switches: …}}");
    if (!config_keys(node, names))
        return false;
    for (size_t i = 0; i < config_count(node); i++) {
        unsigned at = sim_unit_named(sim, config_key(node, i)) - 1u;
        plants->of[at] = read_plant(sim, config_at(node, i), at + 1u);
        if (!plants->of[at])
            return false;
    }
    return true;
}

static bool read_plants(struct sim *sim, const struct config_node *root, struct plants *plants)
{
    static const char *const names[] = {"units", "motors", "switches", NULL};
    static const char *const only[] = {"units", NULL};
    const struct config_node *units = config_type(root) == CONFIG_MAP ? config_get(root, "units") : NULL;
    if (sim_device(sim)->has_no_steps)
        return config_error(root, "the axes of a %s make no steps that a plant could follow", sim_device(sim)->name);
    if (config_type(root) != CONFIG_MAP)
        return config_error(root, "expected a plant: motors and switches");
    if (units)
        return config_keys(root, only) && read_units(sim, units, plants);
    if (!config_keys(root, names))
        return false;
    if (sim_units(sim) != 1)
        return config_error(root, "expected units: there are %u on the bus", sim_units(sim));
    plants->of[0] = read_plant(sim, root, 1);
    return plants->of[0] != NULL;
}

bool sim_configure_plants(struct sim *sim, const char *name, const char *text, size_t length, FILE *errors)
{
    struct plants plants = {{NULL}};
    char *copy = NULL;
    if (text) {
        struct config_tree *tree = config_read(name, text, length, errors);
        bool ok = tree && read_plants(sim, config_root(tree), &plants);
        config_free(tree);
        copy = ok ? strndup(text, length) : NULL;
        if (ok && !copy)
            fprintf(errors, "%s: error: out of memory\n", name);
        if (!copy) {
            free_plants(&plants);
            return false;
        }
    }
    free(sim->plant_text);
    sim->plant_text = copy;
    for (unsigned at = 0; at < sim_units(sim); at++) {
        plant_free(sim->unit[at].plant);
        sim->unit[at].plant = plants.of[at];
    }
    for (unsigned number = 1; number <= sim_units(sim); number++)
        sim_update_inputs(sim, number);
    return true;
}

void sim_drive_coils(const struct sim_unit *unit, uint64_t tick, uint32_t mask)
{
    const struct device_kind *kind = segment_kind(&unit->sim->segment);
    struct device_coils coils;
    for (unsigned axis = 1; unit->plant && kind->coils && axis <= kind->axes; axis++)
        if (kind->coils(unit->sim->segment.unit[unit->number - 1u].unit, axis, &coils))
            plant_outputs(unit->plant, tick, axis, &coils, mask);
}

uint64_t sim_plant_span(const struct device_kind *kind)
{
    const uint64_t span = PLANT_STEPS_MAX * UINT64_C(1000000) / (kind->speed_max > 0 ? kind->speed_max : 128000u);
    return span > 0 ? span : 1u;
}
