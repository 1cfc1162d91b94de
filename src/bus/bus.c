/* SPDX-License-Identifier: MIT */
#include "bus.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "line/line.h"
#include "record/record.h"

#define INJECTED_TOLD 100u /* acts of faults on demand in the log */

/* ---- The log -------------------------------------------------------------------------------------------------------- */

static void say(const struct bus *bus, uint64_t tick, const char *format, va_list list)
{
    char text[512];
    vsnprintf(text, sizeof text, format, list);
    if (bus->options->lines > 1)
        log_at(tick, "line %u: %s", bus->number, text);
    else
        log_at(tick, "%s", text);
}

void bus_log(const struct bus *bus, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(bus, bus_present(bus), format, list);
    va_end(list);
}

void bus_log_detail(const struct bus *bus, const char *format, ...)
{
    va_list list;
    if (!bus->options->verbose)
        return;
    va_start(list, format);
    say(bus, bus_present(bus), format, list);
    va_end(list);
}

void bus_say(const struct bus *bus, uint64_t tick, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    say(bus, tick, format, list);
    va_end(list);
}

static void tell_fault(struct bus *bus, const struct watch_event *event)
{
    enum rkm04_fault fault = (enum rkm04_fault)event->value;
    struct rkm04_motor_state state;
    if (fault == RKM04_FAULT_NONE)
        return;
    rkm04_motor_state(sim_core(&bus->sim, event->unit), event->motor, &state);
    bus_say(bus, event->tick, "unit %s, motor %u: fault %s at command %u", bus->sim.unit[event->unit - 1u].name, event->motor,
            rkm04_fault_name(fault), (unsigned)state.index);
    if (bus->coverage)
        coverage_fault(bus->coverage, fault);
}

/* A fault on every byte must not fill the log. */
static void tell_injected(struct bus *bus, const struct watch_event *event)
{
    if (++bus->injected <= INJECTED_TOLD)
        bus_say(bus, event->tick, "fault %d: %s", (int)event->value, event->text);
    if (bus->injected == INJECTED_TOLD)
        bus_say(bus, event->tick, "faults act often: from now on they are no longer told here; fault.list counts them");
}

static void on_news(void *context, const struct watch_event *event)
{
    struct bus *bus = context;
    const char *unit = event->unit > 0 ? bus->sim.unit[event->unit - 1u].name : "";
    if (event->kind == WATCH_FAULT)
        tell_fault(bus, event);
    else if (event->kind == WATCH_MESSAGE)
        bus_coverage_message(bus->coverage, event->message);
    else if (event->kind == WATCH_POWER)
        bus_say(bus, event->tick, "unit %s: power %s", unit, event->value ? "on" : "off");
    else if (event->kind == WATCH_PLANT)
        bus_say(bus, event->tick, "unit %s: plant: %s", unit, event->text);
    else
        tell_injected(bus, event);
}

static void watch_for_log(struct bus *bus)
{
    bus->news = (struct watcher){
        .kinds = WATCH_BIT(WATCH_FAULT) | WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_PLANT) | WATCH_BIT(WATCH_INJECTED) |
                 (bus->coverage ? WATCH_BIT(WATCH_MESSAGE) : 0),
        .see = on_news,
        .context = bus,
    };
    sim_watch(&bus->sim, &bus->news);
}

/* ---- Flash ---------------------------------------------------------------------------------------------------------- */

static struct flash_file *flash_of(struct bus *bus, unsigned number)
{
    return &bus->unit[number - 1u].flash;
}

static int flash_read(void *context, unsigned number, unsigned block, unsigned offset, void *data, unsigned length)
{
    return flash_file_read(flash_of(context, number), block, offset, data, length);
}

static int flash_erase(void *context, unsigned number, unsigned block)
{
    return flash_file_erase(flash_of(context, number), block);
}

static int flash_program(void *context, unsigned number, unsigned block, unsigned offset, const void *data, unsigned length)
{
    return flash_file_program(flash_of(context, number), block, offset, data, length);
}

static bool open_flash(struct bus *bus)
{
    const struct bus_options *options = bus->options;
    for (unsigned at = 0; options->flash && at < options->nodes.count; at++) {
        struct bus_unit *unit = &bus->unit[at];
        char path[PATH_MAX], name[NODE_NAME_SIZE];
        node_list_name(&options->nodes, at, name);
        if (!name_expand(options->flash, name, bus->number, path)) {
            log_error("--flash: the path is too long");
            return false;
        }
        unit->flash_path = strdup(path);
        if (!flash_file_open(&unit->flash, unit->flash_path))
            return false;
        unit->open = true;
    }
    return true;
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

size_t bus_room(const struct bus *bus)
{
    return sim_room(&bus->sim);
}

void bus_take(struct bus *bus, const uint8_t *bytes, size_t length, uint64_t tick)
{
    bus->heard = uv_hrtime();
    if (bus->taken < tick)
        bus->taken = tick;
    sim_take(&bus->sim, bytes, length, bus->taken);
}

/* On a real wire bytes take their time outside, so the units' line takes none; the turnaround is kept here. */
static void gather(void *context, const uint8_t *bytes, size_t length)
{
    struct bus *bus = context;
    if (bus->gathered == 0)
        bus->answered = sim_now(&bus->sim) + (bus->ports.line.is_wire ? bus->options->turnaround : 0);
    if (length > sizeof bus->out - bus->gathered) {
        bus_ports_send(bus, bus->out, bus->gathered);
        bus->gathered = 0;
    }
    memcpy(bus->out + bus->gathered, bytes, length);
    bus->gathered += length;
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool configure_plant(struct bus *bus)
{
    const char *text = bus->options->plant_text;
    char *said = NULL;
    size_t length;
    FILE *errors = text ? open_memstream(&said, &length) : NULL;
    bool well = !text || (errors && sim_configure_plants(&bus->sim, bus->options->plant, text, strlen(text), errors));
    if (errors)
        fclose(errors);
    if (said)
        log_text(said);
    free(said);
    return well;
}

/* For snapshots to files, which only clients of a control socket can ask for. */
static bool keep_journal(struct bus *bus)
{
    if (bus->options->no_control || snapshots_keep_journal(&bus->sim))
        return true;
    log_error("out of memory");
    return false;
}

static void unplug(void *context, bool plugged)
{
    bus_ports_plug(context, plugged);
}

static bool begin_sim(struct bus *bus)
{
    const struct bus_options *options = bus->options;
    struct sim_config config = {
        .unit = options->config,
        .nodes = options->nodes,
        .timed = options->baud != 0 && !bus->ports.line.is_wire && !bus_stepped(bus),
        .turnaround = options->turnaround,
        .seed = options->seed,
        .out = gather,
        .adapter = unplug,
        .context = bus,
    };
    if (options->flash)
        config.flash = (struct sim_flash){.read = flash_read, .erase = flash_erase, .program = flash_program, .context = bus};
    if (sim_begin(&bus->sim, &config))
        return true;
    log_error("out of memory");
    return false;
}

bool bus_begin(struct bus *bus, unsigned number, const struct bus_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context)
{
    bus->number = number;
    bus->options = options;
    bus->coverage = coverage;
    bus->calls = calls;
    bus->context = context;
    bus->timer_fd = bus->ports.lower_fd = bus->ports.link.lock = -1;
    line_none(&bus->ports.line);
    bus->clock = options->clock;
    snprintf(bus->clock_text, sizeof bus->clock_text, "%s", options->clock_text);
    if (!bus_ports_open(bus, loop, watch) || !open_flash(bus) || !begin_sim(bus))
        return false;
    watch_for_log(bus);
    return configure_plant(bus) && keep_journal(bus) && bus_time_begin(bus, loop);
}

bool bus_start(struct bus *bus)
{
    if (!bus_ports_publish(bus))
        return false;
    virtual_clock_start(&bus->clock, uv_hrtime(), 0);
    bus->running = true;
    bus_catch_up(bus);
    return true;
}

bool bus_end(struct bus *bus)
{
    bool well = true;
    bus_ports_close(bus);
    if (!bus_files_end(bus))
        well = false;
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        if (bus->unit[at].open && !flash_file_close(&bus->unit[at].flash))
            well = false;
    return well;
}

void bus_free(struct bus *bus)
{
    sim_end(&bus->sim);
    if (bus->timer_fd >= 0)
        close(bus->timer_fd);
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        free(bus->unit[at].flash_path);
    free(bus->ports.tcp);
    free(bus->ports.rfc2217);
    line_close(&bus->ports.line);
    if (bus->ports.lower_fd >= 0)
        close(bus->ports.lower_fd);
    free(bus);
}
