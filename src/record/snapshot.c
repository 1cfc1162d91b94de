/* SPDX-License-Identifier: MIT */
#include "snapshot.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

struct snapshot {
    struct segment segment;
    struct node_list switches; /* S1 of the units, as it is */
    struct faults faults;
    struct wire_monitor monitor;
    struct sim_unit unit[SEGMENT_UNITS]; /* `plant` is a copy of its own */
    uint8_t *flash[SEGMENT_UNITS];
    char *plant_text;
};

/* The visible state of a motor, to report changes to the watchers. */
struct look_motor {
    bool forward, moving;
    uint8_t led, fault;
    uint16_t index;
    int32_t position;
};

struct look {
    bool powered;
    uint32_t inputs, outputs, variables;
    int32_t value[DEVICE_VALUES_MAX];
    struct look_motor motor[DEVICE_AXES_MAX];
};

/* ---- Flash: past the injected faults, which are the unit's --------------------------------------------------------- */

static bool read_flash(struct sim *sim, const struct sim_unit *unit, unsigned block, uint8_t *data)
{
    const struct sim_flash *flash = &sim->config.flash;
    unsigned size = sim_device(sim)->flash_block_size;
    if (flash->read)
        return flash->read(flash->context, unit->number, block, 0, data, size) == 0;
    for (unsigned i = 0; i < size; i++)
        data[i] = unit->memory ? (uint8_t)~unit->memory[block * size + i] : 0xFF;
    return true;
}

static bool write_flash(struct sim *sim, struct sim_unit *unit, unsigned block, const uint8_t *data)
{
    const struct sim_flash *flash = &sim->config.flash;
    unsigned size = sim_device(sim)->flash_block_size;
    uint8_t present[DEVICE_FLASH_BLOCK_MAX];
    if (read_flash(sim, unit, block, present) && memcmp(present, data, size) == 0)
        return true;
    if (flash->read)
        return flash->erase(flash->context, unit->number, block) == 0 &&
               flash->program(flash->context, unit->number, block, 0, data, size) == 0;
    if (!unit->memory)
        unit->memory = calloc(sim_device(sim)->flash_blocks, size);
    for (unsigned i = 0; unit->memory && i < size; i++)
        unit->memory[block * size + i] = (uint8_t)~data[i];
    return unit->memory != NULL;
}

static bool write_images(struct sim *sim, const struct snapshot *snapshot)
{
    const struct device_kind *kind = sim_device(sim);
    for (unsigned at = 0; at < sim_units(sim); at++)
        for (unsigned block = 0; block < kind->flash_blocks; block++)
            if (!write_flash(sim, &sim->unit[at], block, snapshot->flash[at] + block * kind->flash_block_size))
                return false;
    return true;
}

/* ---- Taking --------------------------------------------------------------------------------------------------------- */

static bool copy_unit(struct sim *sim, struct snapshot *snapshot, unsigned at)
{
    const struct device_kind *kind = sim_device(sim);
    struct sim_unit *unit = &snapshot->unit[at];
    *unit = sim->unit[at];
    unit->memory = NULL;
    unit->plant = unit->plant ? plant_copy(sim->unit[at].plant, 0) : NULL;
    snapshot->flash[at] = malloc(kind->flash_blocks * kind->flash_block_size + 1u);
    if (!snapshot->flash[at] || (sim->unit[at].plant && !unit->plant))
        return false;
    for (unsigned block = 0; block < kind->flash_blocks; block++)
        if (!read_flash(sim, &sim->unit[at], block, snapshot->flash[at] + block * kind->flash_block_size))
            return false;
    return true;
}

struct snapshot *snapshot_take(struct sim *sim)
{
    struct snapshot *snapshot = calloc(1, sizeof *snapshot);
    if (!snapshot)
        return NULL;
    snapshot->switches = sim->config.nodes;
    snapshot->faults = sim->faults;
    bool ok = segment_copy(&snapshot->segment, &sim->segment);
    struct wire_monitor_calls none = {0};
    ok = wire_monitor_begin(&snapshot->monitor, sim_device(sim), sim->monitor.framing, NULL, none) && ok;
    if (ok)
        wire_monitor_copy(&snapshot->monitor, &sim->monitor, 0);
    if (sim->plant_text)
        ok = (snapshot->plant_text = strdup(sim->plant_text)) && ok;
    for (unsigned at = 0; at < sim_units(sim); at++)
        ok = copy_unit(sim, snapshot, at) && ok;
    if (ok)
        return snapshot;
    snapshot_free(snapshot);
    return NULL;
}

void snapshot_free(struct snapshot *snapshot)
{
    if (!snapshot)
        return;
    for (unsigned at = 0; at < SEGMENT_UNITS; at++) {
        plant_free(snapshot->unit[at].plant);
        free(snapshot->flash[at]);
    }
    segment_end(&snapshot->segment);
    wire_monitor_end(&snapshot->monitor);
    free(snapshot->plant_text);
    free(snapshot);
}

uint64_t snapshot_tick(const struct snapshot *snapshot)
{
    return segment_now(&snapshot->segment);
}

/* ---- Does it fit? --------------------------------------------------------------------------------------------------- */

static const char *find_difference(const struct segment *a, const struct segment *b)
{
    if (segment_kind(a) != segment_kind(b))
        return "the device";
    if (a->units != b->units)
        return "the number of units";
    if (a->config.turnaround != b->config.turnaround)
        return "the turnaround";
    for (unsigned at = 0; at < a->units; at++) {
        const char *what = segment_kind(a)->unlike(&a->unit[at].config, &b->unit[at].config);
        if (what)
            return what;
    }
    return NULL;
}

const char *snapshot_difference(const struct sim *sim, const struct sim *other)
{
    return find_difference(&sim->segment, &other->segment);
}

const char *snapshot_misfit(const struct sim *sim, const struct snapshot *snapshot)
{
    if (sim->segment.units == snapshot->segment.units && sim->segment.config.timed != snapshot->segment.config.timed)
        return "whether bytes take time (--baud, --clock stepped)";
    return find_difference(&sim->segment, &snapshot->segment);
}

/* ---- Telling what has changed --------------------------------------------------------------------------------------- */

static void read_visible_state(struct sim *sim, unsigned number, struct look *look)
{
    const struct device_kind *kind = sim_device(sim);
    const struct device_unit *unit = sim_core(sim, number);
    *look = (struct look){
        .powered = sim_powered(sim, number),
        .inputs = kind->inputs_of(unit),
        .outputs = kind->outputs_of(unit),
        .variables = kind->variables_of(unit),
    };
    for (unsigned value = 1; value <= kind->values; value++)
        look->value[value - 1u] = kind->value(unit, value);
    for (unsigned motor = 1; motor <= kind->axes; motor++) {
        struct device_axis state = sim_axis(sim, number, motor);
        look->motor[motor - 1u] = (struct look_motor){
            .forward = state.forward,
            .moving = state.moving,
            .led = state.led,
            .fault = state.fault,
            .index = state.index,
            .position = state.position,
        };
    }
}

static void report_change(struct sim *sim, unsigned number, unsigned motor, enum watch_kind kind, int32_t before, int32_t after)
{
    struct watch_event event = {
        .tick = sim_now(sim),
        .value = after,
        .kind = (uint8_t)kind,
        .unit = (uint8_t)number,
        .motor = (uint8_t)motor,
    };
    if (before != after)
        sim_report(sim, WATCH_DELIVERED, &event);
}

static void report_value(struct sim *sim, unsigned number, unsigned value, int32_t before, int32_t after)
{
    struct watch_event event = {
        .tick = sim_now(sim), .value = after, .kind = WATCH_VALUE, .unit = (uint8_t)number, .number = (uint8_t)value};
    if (before != after)
        sim_report(sim, WATCH_DELIVERED, &event);
}

static void report_changes(struct sim *sim, unsigned number, const struct look *before)
{
    struct look after;
    read_visible_state(sim, number, &after);
    report_change(sim, number, 0, WATCH_POWER, before->powered, after.powered);
    report_change(sim, number, 0, WATCH_INPUTS, (int32_t)before->inputs, (int32_t)after.inputs);
    report_change(sim, number, 0, WATCH_OUTPUTS, (int32_t)before->outputs, (int32_t)after.outputs);
    report_change(sim, number, 0, WATCH_VARIABLES, (int32_t)before->variables, (int32_t)after.variables);
    sim_report_cells(sim, number);
    for (unsigned value = 1; value <= sim_device(sim)->values; value++)
        report_value(sim, number, value, before->value[value - 1u], after.value[value - 1u]);
    for (unsigned motor = 1; motor <= sim_device(sim)->axes; motor++) {
        const struct look_motor *a = &before->motor[motor - 1u], *b = &after.motor[motor - 1u];
        report_change(sim, number, motor, WATCH_POSITION, a->position, b->position);
        report_change(sim, number, motor, WATCH_MOTION, a->moving, b->moving);
        report_change(sim, number, motor, WATCH_DIRECTION, a->forward, b->forward);
        report_change(sim, number, motor, WATCH_COMMAND, a->index, b->index);
        report_change(sim, number, motor, WATCH_LED, a->led, b->led);
        report_change(sim, number, motor, WATCH_FAULT, a->fault, b->fault);
    }
}

/* ---- Putting -------------------------------------------------------------------------------------------------------- */

/* What belongs to this sim stays, everything else becomes as it was. */
static void put_unit(struct sim_unit *unit, const struct sim_unit *from, struct plant *plant)
{
    struct sim_unit own = *unit;
    *unit = *from;
    unit->sim = own.sim;
    unit->port = own.port;
    unit->memory = own.memory;
    unit->plant = plant;
    plant_free(own.plant);
}

static bool copy_plants(const struct snapshot *snapshot, uint64_t later, struct plant **plant)
{
    bool ok = true;
    for (unsigned at = 0; at < snapshot->segment.units; at++) {
        if (!snapshot->unit[at].plant)
            continue;
        plant[at] = plant_copy(snapshot->unit[at].plant, later);
        ok = plant[at] && ok;
    }
    return ok;
}

/* `sim` as it was, everything later by so many ticks. */
static bool put_shifted(struct sim *sim, const struct snapshot *snapshot, uint64_t later)
{
    struct plant *plant[SEGMENT_UNITS] = {NULL};
    struct look before[SEGMENT_UNITS];
    char *text = snapshot->plant_text ? strdup(snapshot->plant_text) : NULL;
    if (!copy_plants(snapshot, later, plant) || (snapshot->plant_text && !text) || !write_images(sim, snapshot)) {
        for (unsigned at = 0; at < SEGMENT_UNITS; at++)
            plant_free(plant[at]);
        free(text);
        return false;
    }
    for (unsigned number = 1; number <= sim_units(sim); number++)
        read_visible_state(sim, number, &before[number - 1u]);
    bool unplugged = sim->faults.unplugged;
    segment_copy(&sim->segment, &snapshot->segment); /* there is memory for its units */
    segment_shift(&sim->segment, later);
    for (unsigned at = 0; at < sim_units(sim); at++)
        put_unit(&sim->unit[at], &snapshot->unit[at], plant[at]);
    sim->config.nodes = snapshot->switches;
    faults_restore(&sim->faults, &snapshot->faults, later);
    wire_monitor_copy(&sim->monitor, &snapshot->monitor, later);
    free(sim->plant_text);
    sim->plant_text = text;
    for (unsigned number = 1; number <= sim_units(sim); number++) {
        sim_update_inputs(sim, number);
        report_changes(sim, number, &before[number - 1u]);
    }
    if (sim->config.adapter && unplugged != sim->faults.unplugged)
        sim->config.adapter(sim->config.context, unplugged);
    return true;
}

bool snapshot_restore(struct sim *sim, const struct snapshot *snapshot)
{
    uint64_t now = sim_now(sim), taken = snapshot_tick(snapshot);
    return put_shifted(sim, snapshot, now > taken ? now - taken : 0);
}

bool snapshot_move(struct sim *sim, uint64_t ticks)
{
    struct snapshot *snapshot = snapshot_take(sim);
    bool ok = snapshot && put_shifted(sim, snapshot, ticks);
    snapshot_free(snapshot);
    return ok;
}
