/* SPDX-License-Identifier: MIT */
/* Cells of a device that watchers want to see: an event whenever one has changed in a slot. */
#include <stdlib.h>
#include <string.h>

#include "sim.h"

#define LEAP_SLOTS 100u /* with watched cells, so that what is gathered in a leap has a limit */

/* Report the watched cells of a unit that are not as they were reported last. */
static void report_cells(struct sim *sim, unsigned number, uint64_t tick, enum watch_phase phase)
{
    const struct device_kind *kind = sim_device(sim);
    const struct device_unit *core = sim_core(sim, number);
    for (unsigned at = 0; at < sim->watch.cell_count; at++) {
        struct watch_cell *cell = &sim->watch.cells[at];
        if (!cell->owner || cell->unit != number)
            continue;
        const int64_t value = kind->cell(core, cell->code);
        if (value == cell->value)
            continue;
        cell->value = value;
        const struct watch_event event = {
            .tick = tick, .kind = WATCH_CELL, .unit = (uint8_t)number, .number = (uint8_t)at, .cell = value};
        watch_add(&sim->watch, phase, &event);
    }
}

static void on_slot(void *context, uint64_t tick)
{
    const struct sim_unit *unit = context;
    report_cells(unit->sim, unit->number, segment_since(&unit->sim->segment, unit->number) + tick, WATCH_TURNS);
}

void sim_report_cells(struct sim *sim, unsigned number)
{
    report_cells(sim, number, sim_now(sim), WATCH_DELIVERED);
}

static bool is_watched(const struct sim *sim, unsigned number)
{
    for (unsigned at = 0; at < sim->watch.cell_count; at++)
        if (sim->watch.cells[at].owner && sim->watch.cells[at].unit == number)
            return true;
    return false;
}

void sim_update_cell_reports(struct sim *sim)
{
    for (unsigned number = 1; number <= sim->segment.units; number++) {
        struct device_port *port = &sim->unit[number - 1u].port;
        const bool wanted = is_watched(sim, number);
        if (wanted == (port->slot != NULL))
            continue;
        port->slot = wanted ? on_slot : NULL;
        segment_port_changed(&sim->segment, number);
    }
}

/* A free place; WATCH_CELLS_MAX: there is none. */
static unsigned free_place(struct watch *watch)
{
    unsigned at = 0;
    if (!watch->cells)
        watch->cells = calloc(WATCH_CELLS_MAX, sizeof *watch->cells);
    if (!watch->cells)
        return WATCH_CELLS_MAX;
    while (at < watch->cell_count && watch->cells[at].owner)
        at++;
    return at;
}

const struct watch_cell *sim_watch_cell(struct sim *sim, const struct watcher *watcher, unsigned number, const char *name,
                                        struct device_refusal *refusal)
{
    const struct device_kind *kind = sim_device(sim);
    struct watch *watch = &sim->watch;
    const unsigned at = free_place(watch);
    uint64_t code = 0;
    refusal->is_state = at == WATCH_CELLS_MAX;
    if (refusal->is_state)
        snprintf(refusal->text, DEVICE_ERROR_SIZE, "too many cells: expected at most %u of all subscriptions", WATCH_CELLS_MAX);
    else if (!kind->find_cell)
        snprintf(refusal->text, DEVICE_ERROR_SIZE, "the device %s has no cells", kind->name);
    else if (strlen(name) >= WATCH_CELL_NAME_SIZE)
        snprintf(refusal->text, DEVICE_ERROR_SIZE, "`%.60s…': there is no cell with so long a name", name);
    else
        code = kind->find_cell(sim_core(sim, number), name, refusal->text);
    if (code == 0)
        return NULL;
    struct watch_cell *cell = &watch->cells[at];
    *cell = (struct watch_cell){.owner = watcher, .code = code, .unit = (uint8_t)number};
    cell->value = kind->cell(sim_core(sim, number), code);
    snprintf(cell->name, sizeof cell->name, "%s", name);
    watch->cell_count = at < watch->cell_count ? watch->cell_count : at + 1u;
    sim_update_cell_reports(sim);
    return cell;
}

uint64_t sim_cells_next(const struct sim *sim, unsigned slots)
{
    uint64_t next = DEVICE_NEVER;
    for (unsigned number = 1; number <= sim->segment.units; number++) {
        const uint64_t since = segment_since(&sim->segment, number), slot = sim_device(sim)->slot;
        if (!sim->unit[number - 1u].port.slot || !sim_powered(sim, number))
            continue;
        const uint64_t end = since + ((sim_now(sim) - since + slot - 1u) / slot + slots - 1u) * slot;
        next = end < next ? end : next;
    }
    return next;
}

uint64_t sim_cells_leap(const struct sim *sim)
{
    return sim_cells_next(sim, LEAP_SLOTS);
}
