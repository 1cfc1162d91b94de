/* SPDX-License-Identifier: MIT */
#include "sim.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST_ANSWER 20000000u /* ticks: more than the longest answer takes */

static uint64_t earlier(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* ---- Events --------------------------------------------------------------------------------------------------------- */

/* The us of the bus in which `tick` of a unit lies. */
static uint64_t us_of(const struct sim_unit *unit, uint64_t tick)
{
    const struct segment *segment = &unit->sim->segment;
    const unsigned per_us = segment_kind(segment)->ticks_per_us;
    return segment_since(segment, unit->number) + (per_us == 1 ? tick : tick / per_us);
}

/* The ns after that us. */
static uint64_t ns_of(const struct sim_unit *unit, uint64_t tick)
{
    const unsigned per_us = segment_kind(&unit->sim->segment)->ticks_per_us;
    return per_us == 1 ? 0 : tick % per_us * 1000u / per_us;
}

/* What a unit does at `tick` of its own time. */
static void add_unit_event(const struct sim_unit *unit, uint64_t tick, enum watch_phase phase, enum watch_kind kind,
                           unsigned motor, int32_t value)
{
    struct watch_event event = {
        .tick = us_of(unit, tick),
        .order = ns_of(unit, tick),
        .value = value,
        .kind = (uint8_t)kind,
        .unit = (uint8_t)unit->number,
        .motor = (uint8_t)(kind == WATCH_VALUE ? 0 : motor),
        .number = (uint8_t)(kind == WATCH_VALUE ? motor : 0),
    };
    watch_add(&unit->sim->watch, phase, &event);
}

/* ---- The units' port ------------------------------------------------------------------------------------------------ */

static enum watch_phase phase_of(const struct sim_unit *unit)
{
    return unit->sim->segment.advancing ? WATCH_TURNS : WATCH_DELIVERED;
}

/* How long the pulses are that an axis makes now; 0: as all of the device. */
static uint32_t pulse_ns(const struct sim_unit *unit, unsigned motor)
{
    const struct device_kind *kind = segment_kind(&unit->sim->segment);
    if (!kind->pulse_ticks)
        return 0;
    return kind->pulse_ticks(unit->sim->segment.unit[unit->number - 1u].unit, motor) * 1000u / kind->ticks_per_us;
}

static void on_steps(void *context, unsigned motor, const uint64_t *tick, size_t count, int32_t position, bool forward)
{
    struct sim_unit *unit = context;
    struct watch_event event = {
        .kind = WATCH_STEP, .unit = (uint8_t)unit->number, .motor = (uint8_t)motor, .pulse_ns = pulse_ns(unit, motor)};
    const struct device_kind *kind = segment_kind(&unit->sim->segment);
    const uint64_t since = segment_since(&unit->sim->segment, unit->number);
    const bool moves = unit->plant && !kind->coils, is_fine = kind->ticks_per_us != 1;
    for (size_t i = 0; i < count; i++) {
        uint32_t way = forward ? (uint32_t)i : 0u - (uint32_t)i;
        event.tick = since + (is_fine ? tick[i] / kind->ticks_per_us : tick[i]);
        event.order = is_fine ? ns_of(unit, tick[i]) : 0;
        event.value = (int32_t)((uint32_t)position + way);
        watch_add(&unit->sim->watch, WATCH_PULSES, &event);
        if (moves)
            plant_step(unit->plant, event.tick, motor, forward);
    }
}

static void on_direction(void *context, uint64_t tick, unsigned motor, bool forward)
{
    struct sim_unit *unit = context;
    uint32_t bit = UINT32_C(1) << (motor - 1u);
    unit->forward = forward ? unit->forward | bit : unit->forward & ~bit;
    add_unit_event(unit, tick, phase_of(unit), WATCH_DIRECTION, motor, forward);
}

static void on_outputs(void *context, uint64_t tick, uint32_t mask)
{
    const struct sim_unit *unit = context;
    sim_drive_coils(unit, us_of(unit, tick), mask);
    add_unit_event(unit, tick, phase_of(unit), WATCH_OUTPUTS, 0, (int32_t)mask);
}

static void on_event(void *context, uint64_t tick, unsigned motor, enum device_event what, uint32_t value)
{
    static const enum watch_kind kinds[] = {
        [DEVICE_EVENT_MOTION] = WATCH_MOTION,     [DEVICE_EVENT_COMMAND] = WATCH_COMMAND, [DEVICE_EVENT_LED] = WATCH_LED,
        [DEVICE_EVENT_VARIABLE] = WATCH_VARIABLES, [DEVICE_EVENT_FAULT] = WATCH_FAULT,
        [DEVICE_EVENT_POSITION] = WATCH_POSITION, [DEVICE_EVENT_VALUE] = WATCH_VALUE,
    };
    add_unit_event(context, tick, phase_of(context), kinds[what], motor, (int32_t)value);
}

static void on_note(void *context, uint64_t tick, unsigned motor, const char *text)
{
    const struct sim_unit *unit = context;
    struct watch_event event = {
        .tick = us_of(unit, tick), .kind = WATCH_NOTE, .unit = (uint8_t)unit->number, .motor = (uint8_t)motor};
    sim_report_text(unit->sim, phase_of(unit), &event, "%s", text);
}

static int on_flash_read(void *context, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct sim_unit *unit = context;
    return faults_flash_read(&unit->sim->faults, unit->number, block, offset, data, length);
}

static int on_flash_erase(void *context, unsigned block)
{
    struct sim_unit *unit = context;
    return faults_flash_erase(&unit->sim->faults, unit->number, block);
}

static int on_flash_program(void *context, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct sim_unit *unit = context;
    return faults_flash_program(&unit->sim->faults, unit->number, block, offset, data, length);
}

/* Pulses cost time: they are requested while a watcher wants them. */
static void update_step_reports(struct sim *sim)
{
    for (unsigned number = 1; number <= sim->segment.units; number++) {
        struct sim_unit *unit = &sim->unit[number - 1u];
        bool pulses = (sim->watch.kinds & WATCH_BIT(WATCH_STEP)) != 0 || unit->plant;
        if (pulses == (unit->port.steps != NULL))
            continue;
        unit->port.steps = pulses ? on_steps : NULL;
        segment_port_changed(&sim->segment, number);
    }
}

/* ---- Inputs --------------------------------------------------------------------------------------------------------- */

/* What holds an input comes before what drives it, and that before what was set by hand. */
static uint32_t inputs_of(struct sim *sim, const struct sim_unit *unit)
{
    uint32_t mask = unit->plant ? plant_mask(unit->plant) : 0;
    uint32_t levels = (unit->di & ~mask) | (unit->plant ? plant_levels(unit->plant) & mask : 0);
    return faults_hold_inputs(&sim->faults, unit->number, levels);
}

static void set_inputs(struct sim *sim, struct sim_unit *unit, uint64_t tick)
{
    const struct device_kind *kind = sim_device(sim);
    struct device_unit *core = segment_unit(&sim->segment, unit->number);
    uint32_t levels = inputs_of(sim, unit);
    if (levels == kind->inputs_of(core))
        return;
    struct watch_event event = {.tick = tick, .value = (int32_t)levels, .kind = WATCH_INPUTS, .unit = (uint8_t)unit->number};
    watch_add(&sim->watch, WATCH_DELIVERED, &event);
    kind->set_inputs(core, levels); /* what comes of it follows */
}

void sim_update_inputs(struct sim *sim, unsigned number)
{
    set_inputs(sim, &sim->unit[number - 1u], sim_now(sim));
    update_step_reports(sim); /* a plant may have come or gone */
}

void sim_set_di(struct sim *sim, unsigned number, uint32_t mask)
{
    sim->unit[number - 1u].di = mask;
    sim_update_inputs(sim, number);
}

static void add_plant_events(struct sim *sim, const struct sim_unit *unit)
{
    struct plant_report report;
    while (plant_take_report(unit->plant, &report)) {
        struct watch_event event = {.tick = report.tick,
                                    .value = report.news,
                                    .kind = WATCH_PLANT,
                                    .unit = (uint8_t)unit->number,
                                    .motor = report.motor};
        sim_report_text(sim, WATCH_PULSES, &event, "%s", report.text);
    }
}

/* The plants' changes up to the present tick. They are reported with the tick at which they happened. */
static void apply_plant_changes(struct sim *sim)
{
    struct plant_change change;
    for (unsigned at = 0; at < sim->segment.units; at++) {
        struct sim_unit *unit = &sim->unit[at];
        if (!unit->plant)
            continue;
        while (plant_take_change(unit->plant, sim_now(sim) + 1u, &change))
            set_inputs(sim, unit, change.tick);
        add_plant_events(sim, unit);
    }
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

static void on_byte(void *context, const struct segment_byte *byte)
{
    struct sim *sim = context;
    struct watch_event event = {.tick = byte->tick, .value = byte->byte, .kind = WATCH_BYTE, .byte = *byte};
    watch_add(&sim->watch, WATCH_DELIVERED, &event);
    wire_monitor_add_byte(&sim->monitor, byte);
}

static bool is_message_wanted(void *context)
{
    const struct sim *sim = context;
    return (sim->watch.kinds & WATCH_BIT(WATCH_MESSAGE)) != 0;
}

static void on_message(void *context, uint64_t tick, struct wire_message *message)
{
    struct sim *sim = context;
    struct watch_event event = {.tick = tick, .kind = WATCH_MESSAGE, .message = message};
    if (message)
        watch_add(&sim->watch, WATCH_DELIVERED, &event);
    else
        sim->watch.short_of_memory = true;
}

static void on_out(void *context, const uint8_t *bytes, size_t length)
{
    struct sim *sim = context;
    if (sim->config.out)
        sim->config.out(sim->config.context, bytes, length);
}

size_t sim_room(const struct sim *sim)
{
    return segment_room(&sim->segment);
}

void sim_queue_bytes(struct sim *sim, const uint8_t *bytes, size_t length, uint64_t tick)
{
    sim_finish_tick(sim);
    if (sim->journal)
        sim->journal->bytes(sim->journal->context, sim_now(sim), tick, bytes, length);
    segment_queue_bytes(&sim->segment, bytes, length, tick);
}

size_t sim_purge(struct sim *sim)
{
    sim_finish_tick(sim);
    if (sim->journal)
        sim->journal->purge(sim->journal->context, sim_now(sim));
    return segment_purge(&sim->segment);
}

void sim_break(struct sim *sim, bool on)
{
    sim_finish_tick(sim);
    if (sim->journal)
        sim->journal->line_break(sim->journal->context, sim_now(sim), on);
    segment_break(&sim->segment, on);
}

void sim_set_timed(struct sim *sim, bool timed)
{
    if (sim->segment.config.timed == timed)
        return;
    if (sim->journal)
        sim->journal->timed(sim->journal->context, sim_now(sim), timed);
    for (uint64_t last = earlier(sim_now(sim) + LONGEST_ANSWER, SIM_TIME_MAX); segment_due(&sim->segment) <= last;)
        sim_advance(sim, segment_due(&sim->segment));
    segment_set_timed(&sim->segment, timed);
}

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

uint64_t sim_now(const struct sim *sim)
{
    return segment_now(&sim->segment);
}

bool sim_time_is_over(const struct sim *sim)
{
    return sim_now(sim) >= SIM_TIME_MAX;
}

uint64_t sim_due(const struct sim *sim)
{
    return earlier(segment_due(&sim->segment), earlier(wire_monitor_due(&sim->monitor), sim_services_next(sim)));
}

static uint64_t plants_next(const struct sim *sim)
{
    uint64_t next = DEVICE_NEVER;
    for (unsigned at = 0; at < sim->segment.units; at++)
        if (sim->unit[at].plant)
            next = earlier(next, plant_next(sim->unit[at].plant));
    return next;
}

/* Are there servers of devices, or watched cells? Most lines have none, and they are asked often. */
static bool has_extras(const struct sim *sim)
{
    return sim->services || sim->watch.cell_count > 0;
}

/* When something happens around the units. */
static uint64_t next_around(const struct sim *sim)
{
    uint64_t next = earlier(plants_next(sim), faults_next(&sim->faults));
    return has_extras(sim) ? earlier(next, earlier(sim_services_next(sim), sim_cells_next(sim, 1))) : next;
}

uint64_t sim_next_event(const struct sim *sim)
{
    return earlier(segment_next_event(&sim->segment), next_around(sim));
}

uint64_t sim_next_report(const struct sim *sim)
{
    return earlier(segment_next_report(&sim->segment), next_around(sim));
}

/* The first slot of a unit after `tick`: its time began when it was powered up. */
static uint64_t slot_after(const struct sim *sim, unsigned number, uint64_t tick)
{
    uint64_t since = segment_since(&sim->segment, number);
    unsigned slot = sim_device(sim)->slot;
    return since + ((tick - since) / slot + 1u) * slot;
}

/* The end of the next leap on the way to `tick`: where a fault begins or ends, and with pulses to be reported, the slot after
 * something happens; a switch that bounces in a slot is seen in it. Where a byte may take a unit's power (FAULT_POWER), the
 * leap ends with it: when the power comes back is not known before. */
static uint64_t leap_end(const struct sim *sim, uint64_t tick)
{
    uint64_t now = sim_now(sim), end = earlier(tick, faults_next(&sim->faults)), bounce = plants_next(sim), due = sim_due(sim);
    uint64_t event = earlier(segment_next_event(&sim->segment), due);
    event = event > now ? event : now;
    end = earlier(end, wire_monitor_due(&sim->monitor));
    if (has_extras(sim))
        end = earlier(end, earlier(sim_services_next(sim), sim_cells_leap(sim)));
    if ((sim->faults.kinds >> FAULT_POWER & 1u) != 0)
        end = earlier(end, due > now ? due : now);
    for (unsigned number = 1; number <= sim->segment.units; number++) {
        if (!sim->unit[number - 1u].port.steps)
            continue;
        if (event < end)
            end = earlier(end, slot_after(sim, number, event));
        if (event < end && sim->unit[number - 1u].plant)
            end = earlier(end, event + sim_plant_span(sim_device(sim)));
        if (bounce < end)
            end = earlier(end, slot_after(sim, number, bounce > now ? bounce - 1u : now));
    }
    return end;
}

void sim_advance(struct sim *sim, uint64_t tick)
{
    tick = earlier(tick, SIM_TIME_MAX);
    do {
        segment_advance(&sim->segment, leap_end(sim, tick));
        wire_monitor_pass_time(&sim->monitor, sim_now(sim));
        apply_plant_changes(sim); /* they were before the faults that begin or end now */
        if (faults_next(&sim->faults) <= sim_now(sim))
            faults_update(&sim->faults);
        if (sim_services_next(sim) <= sim_now(sim))
            sim_services_run(sim);
        watch_deliver(&sim->watch, sim_now(sim) + 1u); /* of the present tick there is only what was delivered */
    } while (sim_now(sim) < tick);
}

void sim_finish_tick(struct sim *sim)
{
    sim_advance(sim, sim_now(sim));
}

struct wire_names sim_wire_names(const struct sim *sim)
{
    struct wire_names names = {.framing = sim->monitor.framing, .words = sim_device(sim)->words};
    for (unsigned at = 0; at < sim->segment.units; at++)
        names.unit[at] = sim->unit[at].name;
    return names;
}

/* ---- Units ---------------------------------------------------------------------------------------------------------- */

unsigned sim_units(const struct sim *sim)
{
    return sim->segment.units;
}

unsigned sim_unit_named(const struct sim *sim, const char *name)
{
    for (unsigned number = 1; number <= sim->segment.units; number++)
        if (strcmp(sim->unit[number - 1u].name, name) == 0)
            return number;
    return 0;
}

struct device_unit *sim_core(struct sim *sim, unsigned number)
{
    return segment_unit(&sim->segment, number);
}

const struct device_kind *sim_device(const struct sim *sim)
{
    return segment_kind(&sim->segment);
}

struct device_axis sim_axis(struct sim *sim, unsigned number, unsigned axis)
{
    struct device_axis state;
    sim_device(sim)->axis(sim_core(sim, number), axis, &state);
    return state;
}

bool sim_powered(const struct sim *sim, unsigned number)
{
    return sim->segment.unit[number - 1u].powered;
}

static void add_power_event(struct sim *sim, unsigned number, bool on)
{
    struct watch_event event = {.tick = sim_now(sim), .value = on, .kind = WATCH_POWER, .unit = (uint8_t)number};
    watch_add(&sim->watch, WATCH_DELIVERED, &event);
}

void sim_power(struct sim *sim, unsigned number, bool on)
{
    struct sim_unit *unit = &sim->unit[number - 1u];
    if (sim_powered(sim, number))
        add_power_event(sim, number, false);
    unit->forward = 0;
    if (on)
        segment_set_node(&sim->segment, number, sim->config.nodes.node[number - 1u]); /* S1 is read now (U4) */
    segment_power(&sim->segment, number, on);
    if (!on)
        return;
    add_power_event(sim, number, true);
    sim_update_inputs(sim, number);
}

/* ---- Watching ------------------------------------------------------------------------------------------------------- */

void sim_watch(struct sim *sim, struct watcher *watcher)
{
    watch_add_watcher(&sim->watch, watcher);
    update_step_reports(sim);
}

void sim_unwatch(struct sim *sim, struct watcher *watcher)
{
    watch_remove_watcher(&sim->watch, watcher);
    update_step_reports(sim);
    sim_update_cell_reports(sim);
}

/* ---- Faults ---------------------------------------------------------------------------------------------------------- */

static void on_fault(void *context, const struct fault *fault, unsigned unit, const char *text)
{
    struct sim *sim = context;
    struct watch_event event = {
        .tick = sim_now(sim),
        .value = (int32_t)fault->id,
        .kind = WATCH_INJECTED,
        .unit = (uint8_t)unit,
    };
    sim_report_text(sim, WATCH_DELIVERED, &event, "%s", text);
}

static void on_fault_of_inputs(void *context, unsigned number)
{
    sim_update_inputs(context, number);
}

static void on_fault_of_power(void *context, unsigned number, bool on)
{
    sim_power(context, number, on);
}

static void on_fault_of_adapter(void *context, bool plugged)
{
    const struct sim *sim = context;
    if (sim->config.adapter)
        sim->config.adapter(sim->config.context, plugged);
}

static const char *name_of_unit(void *context, unsigned number)
{
    const struct sim *sim = context;
    return sim->unit[number - 1u].name;
}

static int read_flash(void *context, unsigned number, unsigned block, unsigned offset, void *data, unsigned length)
{
    struct sim *sim = context;
    return sim_flash_read(&sim->unit[number - 1u], block, offset, data, length);
}

static int erase_flash(void *context, unsigned number, unsigned block)
{
    struct sim *sim = context;
    return sim_flash_erase(&sim->unit[number - 1u], block);
}

static int program_flash(void *context, unsigned number, unsigned block, unsigned offset, const void *data, unsigned length)
{
    struct sim *sim = context;
    return sim_flash_program(&sim->unit[number - 1u], block, offset, data, length);
}

static const struct fault_calls fault_calls = {
    .report = on_fault,
    .inputs_changed = on_fault_of_inputs,
    .power = on_fault_of_power,
    .adapter = on_fault_of_adapter,
    .unit_name = name_of_unit,
    .flash_read = read_flash,
    .flash_erase = erase_flash,
    .flash_program = program_flash,
};

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool add_unit(struct sim *sim, unsigned at)
{
    struct sim_unit *unit = &sim->unit[at];
    struct device_config config = sim->config.unit;
    unit->sim = sim;
    unit->number = at + 1u;
    unit->port = (struct device_port){
        .direction = on_direction,
        .outputs = on_outputs,
        .event = on_event,
        .note = on_note,
        .flash_read = on_flash_read,
        .flash_erase = on_flash_erase,
        .flash_program = on_flash_program,
    };
    node_list_name(&sim->config.nodes, at, unit->name);
    config.node = sim->config.nodes.node[at];
    return sim_flash_fill(unit) && segment_add_unit(&sim->segment, &config, &unit->port, unit) != 0;
}

bool sim_begin(struct sim *sim, const struct sim_config *config)
{
    const struct device_kind *kind = config->device ? config->device : device_kind_at(0);
    struct segment_config segment = {
        .kind = kind,
        .timed = config->timed,
        .is_full_duplex = kind->is_full_duplex && kind->is_full_duplex(&config->unit),
        .baud = device_baud(kind, &config->unit),
        .turnaround = config->turnaround,
        .out = on_out,
        .monitor = on_byte,
        .context = sim,
        .hooks_context = &sim->faults,
    };
    sim->config = *config;
    faults_begin(&sim->faults, config->seed, &sim->segment, &fault_calls, sim);
    segment_begin(&sim->segment, &segment);
    struct wire_monitor_calls calls = {.is_wanted = is_message_wanted, .message = on_message, .context = sim};
    const struct device_framing *framing = device_framing_of(sim_device(sim), &sim->config.unit);
    if (!wire_monitor_begin(&sim->monitor, sim_device(sim), framing, &sim->segment, calls))
        return false;
    for (unsigned at = 0; at < config->nodes.count; at++)
        if (!add_unit(sim, at))
            return false;
    return true;
}

void sim_end(struct sim *sim)
{
    segment_end(&sim->segment);
    watch_end(&sim->watch);
    wire_monitor_end(&sim->monitor);
    sim_services_free(sim);
    if (sim->snapshots)
        sim->free_snapshots(sim->snapshots);
    free(sim->plant_text);
    for (unsigned at = 0; at < SEGMENT_UNITS; at++) {
        plant_free(sim->unit[at].plant);
        free(sim->unit[at].memory);
    }
}
