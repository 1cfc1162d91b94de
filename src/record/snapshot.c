/* SPDX-License-Identifier: MIT */
#include "snapshot.h"

#include <stdlib.h>
#include <string.h>

#include "text/text.h"

#define FLASH_SIZE (RKM04_FLASH_BLOCKS * RKM04_FLASH_BLOCK_SIZE)

struct snapshot {
    struct segment segment; /* units that are not there have never been touched */
    struct node_list switches; /* S1 of the units, as it stands */
    struct faults faults;
    struct wire_monitor monitor;
    struct sim_unit unit[SEGMENT_UNITS]; /* `plant` is a copy of its own */
    uint8_t *flash[SEGMENT_UNITS];
    char *plant_text;
};

/* What people can see of a motor, to tell the watchers what has changed. */
struct look_motor {
    bool forward, moving;
    uint8_t led, fault;
    uint16_t index;
    int32_t position;
};

struct look {
    bool powered;
    uint8_t inputs, outputs;
    uint16_t variables;
    struct look_motor motor[RKM04_MOTORS];
};

/* ---- Flash: past the faults on demand, which are the unit's --------------------------------------------------------- */

static bool read_flash(struct sim *sim, const struct sim_unit *unit, unsigned block, uint8_t *data)
{
    const struct sim_flash *flash = &sim->config.flash;
    if (flash->read)
        return flash->read(flash->context, unit->number, block, 0, data, RKM04_FLASH_BLOCK_SIZE) == 0;
    for (unsigned i = 0; i < RKM04_FLASH_BLOCK_SIZE; i++)
        data[i] = unit->memory ? (uint8_t)~unit->memory[block * RKM04_FLASH_BLOCK_SIZE + i] : 0xFF;
    return true;
}

static bool write_flash(struct sim *sim, struct sim_unit *unit, unsigned block, const uint8_t *data)
{
    const struct sim_flash *flash = &sim->config.flash;
    uint8_t present[RKM04_FLASH_BLOCK_SIZE];
    if (read_flash(sim, unit, block, present) && memcmp(present, data, sizeof present) == 0)
        return true;
    if (flash->read)
        return flash->erase(flash->context, unit->number, block) == 0 &&
               flash->program(flash->context, unit->number, block, 0, data, RKM04_FLASH_BLOCK_SIZE) == 0;
    if (!unit->memory)
        unit->memory = calloc(RKM04_FLASH_BLOCKS, RKM04_FLASH_BLOCK_SIZE);
    for (unsigned i = 0; unit->memory && i < RKM04_FLASH_BLOCK_SIZE; i++)
        unit->memory[block * RKM04_FLASH_BLOCK_SIZE + i] = (uint8_t)~data[i];
    return unit->memory != NULL;
}

static bool write_images(struct sim *sim, const struct snapshot *snapshot)
{
    for (unsigned at = 0; at < sim_units(sim); at++)
        for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
            if (!write_flash(sim, &sim->unit[at], block, snapshot->flash[at] + block * RKM04_FLASH_BLOCK_SIZE))
                return false;
    return true;
}

/* ---- Taking --------------------------------------------------------------------------------------------------------- */

/* Everything but units that are not there: their memory is not touched. */
static void copy_segment(struct segment *to, const struct segment *from)
{
    size_t units = offsetof(struct segment, unit), behind = units + sizeof from->unit;
    memcpy(to, from, units);
    memcpy(to->unit, from->unit, from->units * sizeof from->unit[0]);
    memcpy((char *)to + behind, (const char *)from + behind, sizeof *from - behind);
}

static bool take_unit(struct sim *sim, struct snapshot *snapshot, unsigned at)
{
    struct sim_unit *unit = &snapshot->unit[at];
    *unit = sim->unit[at];
    unit->memory = NULL;
    unit->plant = unit->plant ? plant_copy(sim->unit[at].plant, 0) : NULL;
    snapshot->flash[at] = malloc(FLASH_SIZE);
    if (!snapshot->flash[at] || (sim->unit[at].plant && !unit->plant))
        return false;
    for (unsigned block = 0; block < RKM04_FLASH_BLOCKS; block++)
        if (!read_flash(sim, &sim->unit[at], block, snapshot->flash[at] + block * RKM04_FLASH_BLOCK_SIZE))
            return false;
    return true;
}

struct snapshot *snapshot_take(struct sim *sim)
{
    struct snapshot *snapshot = calloc(1, sizeof *snapshot);
    if (!snapshot)
        return NULL;
    copy_segment(&snapshot->segment, &sim->segment);
    snapshot->switches = sim->config.nodes;
    snapshot->faults = sim->faults;
    bool well = wire_monitor_begin(&snapshot->monitor, sim->monitor.framing, NULL, (struct wire_monitor_calls){0});
    if (well)
        wire_monitor_copy(&snapshot->monitor, &sim->monitor, 0);
    if (sim->plant_text)
        well = (snapshot->plant_text = strdup(sim->plant_text)) && well;
    for (unsigned at = 0; at < sim_units(sim); at++)
        well = take_unit(sim, snapshot, at) && well;
    if (well)
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
    wire_monitor_end(&snapshot->monitor);
    free(snapshot->plant_text);
    free(snapshot);
}

uint64_t snapshot_tick(const struct snapshot *snapshot)
{
    return segment_now(&snapshot->segment);
}

/* ---- Does it fit? --------------------------------------------------------------------------------------------------- */

static const char *text_of(const struct rkm04_config *config)
{
    return config->version_text ? config->version_text : RKM04_VERSION_TEXT;
}

static const struct rkm04_framing *framing_of(const struct rkm04_config *config)
{
    return config->framing ? config->framing : &rkm04_hdlc;
}

static const char *unlike(const struct segment *a, const struct segment *b)
{
    if (a->units != b->units)
        return "the number of units";
    if (a->config.turnaround != b->config.turnaround)
        return "the turnaround";
    for (unsigned at = 0; at < a->units; at++) {
        const struct rkm04_config *here = &a->unit[at].unit.config, *there = &b->unit[at].unit.config;
        if (framing_of(here) != framing_of(there))
            return "the framing";
        if (!readings_same(&here->readings, &there->readings))
            return "one of the readings (--readings)";
        if (strcmp(text_of(here), text_of(there)) != 0)
            return "the version text";
    }
    return NULL;
}

const char *snapshot_unlike(const struct sim *sim, const struct sim *other)
{
    return unlike(&sim->segment, &other->segment);
}

const char *snapshot_misfit(const struct sim *sim, const struct snapshot *snapshot)
{
    if (sim->segment.units == snapshot->segment.units && sim->segment.config.timed != snapshot->segment.config.timed)
        return "whether bytes take time (--baud, --clock stepped)";
    return unlike(&sim->segment, &snapshot->segment);
}

/* ---- Telling what has changed --------------------------------------------------------------------------------------- */

static void look_at(const struct sim *sim, unsigned number, struct look *look)
{
    const struct segment_unit *unit = &sim->segment.unit[number - 1u];
    *look = (struct look){
        .powered = unit->powered,
        .inputs = rkm04_inputs(&unit->unit),
        .outputs = rkm04_outputs(&unit->unit),
        .variables = rkm04_variables(&unit->unit),
    };
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        struct rkm04_motor_state state;
        rkm04_motor_state(&unit->unit, motor, &state);
        look->motor[motor - 1u] = (struct look_motor){
            .forward = state.forward,
            .moving = state.state == RKM04_MOVING,
            .led = (uint8_t)state.led,
            .fault = (uint8_t)state.fault,
            .index = state.index,
            .position = state.position,
        };
    }
}

static void tell(struct sim *sim, unsigned number, unsigned motor, enum watch_kind kind, int32_t before, int32_t after)
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

static void tell_changes(struct sim *sim, unsigned number, const struct look *before)
{
    struct look after;
    look_at(sim, number, &after);
    tell(sim, number, 0, WATCH_POWER, before->powered, after.powered);
    tell(sim, number, 0, WATCH_INPUTS, before->inputs, after.inputs);
    tell(sim, number, 0, WATCH_OUTPUTS, before->outputs, after.outputs);
    tell(sim, number, 0, WATCH_VARIABLES, before->variables, after.variables);
    for (unsigned motor = 1; motor <= RKM04_MOTORS; motor++) {
        const struct look_motor *a = &before->motor[motor - 1u], *b = &after.motor[motor - 1u];
        tell(sim, number, motor, WATCH_POSITION, a->position, b->position);
        tell(sim, number, motor, WATCH_MOTION, a->moving, b->moving);
        tell(sim, number, motor, WATCH_DIRECTION, a->forward, b->forward);
        tell(sim, number, motor, WATCH_COMMAND, a->index, b->index);
        tell(sim, number, motor, WATCH_LED, a->led, b->led);
        tell(sim, number, motor, WATCH_FAULT, a->fault, b->fault);
    }
}

/* ---- Putting -------------------------------------------------------------------------------------------------------- */

static void put_segment(struct sim *sim, const struct segment *from, uint64_t later)
{
    static const struct rkm04_config none;
    struct segment *segment = &sim->segment;
    struct segment_config config = segment->config;
    struct rkm04_config own[SEGMENT_UNITS] = {none};
    for (unsigned at = 0; at < segment->units; at++)
        own[at] = segment->unit[at].unit.config;
    copy_segment(segment, from);
    config.echo = from->config.echo;
    config.hooks = from->config.hooks;
    segment->config = config;
    for (unsigned at = 0; at < segment->units; at++) {
        struct rkm04_unit *unit = &segment->unit[at].unit;
        unit->config.framing = own[at].framing;
        unit->config.version_text = own[at].version_text;
        unit->port = &sim->unit[at].port;
        unit->context = &sim->unit[at];
    }
    segment_shift(segment, later);
}

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
    bool well = true;
    for (unsigned at = 0; at < snapshot->segment.units; at++) {
        if (!snapshot->unit[at].plant)
            continue;
        plant[at] = plant_copy(snapshot->unit[at].plant, later);
        well = plant[at] && well;
    }
    return well;
}

/* `sim` as it was, everything later by so many ticks. */
static bool put_later(struct sim *sim, const struct snapshot *snapshot, uint64_t later)
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
        look_at(sim, number, &before[number - 1u]);
    bool unplugged = sim->faults.unplugged;
    put_segment(sim, &snapshot->segment, later);
    for (unsigned at = 0; at < sim_units(sim); at++)
        put_unit(&sim->unit[at], &snapshot->unit[at], plant[at]);
    sim->config.nodes = snapshot->switches;
    faults_restore(&sim->faults, &snapshot->faults, later);
    wire_monitor_copy(&sim->monitor, &snapshot->monitor, later);
    free(sim->plant_text);
    sim->plant_text = text;
    for (unsigned number = 1; number <= sim_units(sim); number++) {
        sim_update_inputs(sim, number);
        tell_changes(sim, number, &before[number - 1u]);
    }
    if (sim->config.adapter && unplugged != sim->faults.unplugged)
        sim->config.adapter(sim->config.context, unplugged);
    return true;
}

bool snapshot_put(struct sim *sim, const struct snapshot *snapshot)
{
    uint64_t now = sim_now(sim), taken = snapshot_tick(snapshot);
    return put_later(sim, snapshot, now > taken ? now - taken : 0);
}

bool snapshot_move(struct sim *sim, uint64_t ticks)
{
    struct snapshot *snapshot = snapshot_take(sim);
    bool well = snapshot && put_later(sim, snapshot, ticks);
    snapshot_free(snapshot);
    return well;
}
