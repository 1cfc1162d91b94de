/* SPDX-License-Identifier: MIT */
#include "bus.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bus_coverage.h"
#include "line/line.h"
#include "record/record.h"

#define INJECTED_LOGGED 100u /* acts of injected faults in the log */

/* ---- The log -------------------------------------------------------------------------------------------------------- */

static void log_fault(struct bus *bus, const struct watch_event *event)
{
    unsigned fault = (unsigned)event->value;
    if (fault == 0)
        return;
    const char *unit = bus->sim.unit[event->unit - 1u].name, *name = sim_device(&bus->sim)->fault_name(fault);
    if (event->motor == 0)
        bus_log_at(&bus->log, event->tick, "unit %s: fault %s", unit, name);
    else
        bus_log_at(&bus->log, event->tick, "unit %s, motor %u: fault %s at command %u", unit, event->motor, name,
                   (unsigned)sim_axis(&bus->sim, event->unit, event->motor).index);
    if (bus->coverage)
        sim_device(&bus->sim)->coverage->fault(bus->coverage, fault);
}

/* A fault on every byte must not fill the log. */
static void log_injected_fault(struct bus *bus, const struct watch_event *event)
{
    if (++bus->injected <= INJECTED_LOGGED)
        bus_log_at(&bus->log, event->tick, "fault %d: %s", (int)event->value, event->text);
    if (bus->injected == INJECTED_LOGGED)
        bus_log_at(&bus->log, event->tick, "injected faults act often: further ones are not logged; fault.list counts them");
}

static void on_event(void *context, const struct watch_event *event)
{
    struct bus *bus = context;
    const char *unit = event->unit > 0 ? bus->sim.unit[event->unit - 1u].name : "";
    if (event->kind == WATCH_FAULT)
        log_fault(bus, event);
    else if (event->kind == WATCH_MESSAGE)
        bus_coverage_message(bus->coverage, sim_device(&bus->sim), event->message);
    else if (event->kind == WATCH_POWER)
        bus_log_at(&bus->log, event->tick, "unit %s: power %s", unit, event->value ? "on" : "off");
    else if (event->kind == WATCH_PLANT)
        bus_log_at(&bus->log, event->tick, "unit %s: plant: %s", unit, event->text);
    else if (event->kind == WATCH_NOTE)
        bus_log_at(&bus->log, event->tick, "unit %s: %s", unit, event->text);
    else
        log_injected_fault(bus, event);
}

static void watch_for_log(struct bus *bus)
{
    bus->news = (struct watcher){
        .kinds = WATCH_BIT(WATCH_FAULT) | WATCH_BIT(WATCH_POWER) | WATCH_BIT(WATCH_PLANT) | WATCH_BIT(WATCH_INJECTED) |
                 WATCH_BIT(WATCH_NOTE) | (bus->coverage ? WATCH_BIT(WATCH_MESSAGE) : 0),
        .on_event = on_event,
        .context = bus,
    };
    bus->time.own_kinds = bus->news.kinds;
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
    const struct device_kind *device = options->device.kind;
    for (unsigned at = 0; options->flash && at < options->nodes.count; at++) {
        struct bus_unit *unit = &bus->unit[at];
        char path[PATH_MAX], name[NODE_NAME_SIZE];
        node_list_name(&options->nodes, at, name);
        if (!name_expand(options->flash, name, bus->log.number, path)) {
            log_error("--flash: the path is too long");
            return false;
        }
        unit->flash_path = strdup(path);
        if (!flash_file_open(&unit->flash, unit->flash_path, device->flash_name, device->flash_blocks,
                             device->flash_block_size))
            return false;
        unit->open = true;
    }
    return true;
}

/* ---- Bytes ---------------------------------------------------------------------------------------------------------- */

static void send_gathered(struct bus *bus)
{
    bus_ports_send(&bus->ports, bus->out, bus->gathered);
    bus->gathered = 0;
}

/* On a real wire bytes take their time outside, so the units' line takes none; the turnaround is kept here. */
static void gather_bytes(void *context, const uint8_t *bytes, size_t length)
{
    struct bus *bus = context;
    if (bus->gathered == 0)
        bus->answered = sim_now(&bus->sim) + (bus->ports.line.is_wire ? bus->options->turnaround : 0);
    if (length > sizeof bus->out - bus->gathered)
        send_gathered(bus);
    memcpy(bus->out + bus->gathered, bytes, length);
    bus->gathered += length;
}

/* ---- Calls of the ports --------------------------------------------------------------------------------------------- */

static void on_expect(void *context)
{
    struct bus *bus = context;
    bus_time_before_read(&bus->time);
}

static size_t on_room(void *context)
{
    struct bus *bus = context;
    return sim_room(&bus->sim);
}

static void on_take(void *context, const uint8_t *bytes, size_t length, uint64_t tick)
{
    struct bus *bus = context;
    bus_time_note_bytes(&bus->time);
    if (bus->taken < tick)
        bus->taken = tick;
    sim_queue_bytes(&bus->sim, bytes, length, bus->taken);
}

static void on_break(void *context, bool on)
{
    struct bus *bus = context;
    sim_break(bus_sim(bus), on);
    bus_changed(bus);
}

static void on_purge(void *context)
{
    struct bus *bus = context;
    sim_purge(bus_sim(bus));
    bus_changed(bus);
}

static void on_taken(void *context)
{
    struct bus *bus = context;
    bus_time_update(&bus->time);
}

static uint64_t on_reached(void *context)
{
    struct bus *bus = context;
    return sim_now(&bus->sim);
}

static void on_lost(void *context)
{
    struct bus *bus = context;
    bus->calls->failed(bus->context);
}

static void on_presence(void *context)
{
    struct bus *bus = context;
    bus->calls->presence(bus->context);
}

static const struct bus_ports_calls ports_calls = {
    .expect = on_expect,
    .room = on_room,
    .take = on_take,
    .line_break = on_break,
    .purge = on_purge,
    .changed = on_taken,
    .reached = on_reached,
    .failed = on_lost,
    .presence = on_presence,
};

/* ---- Calls of the time ---------------------------------------------------------------------------------------------- */

static uint64_t on_due(const void *context)
{
    const struct bus *bus = context;
    return bus->gathered > 0 ? bus->answered : DEVICE_NEVER;
}

static void on_advanced(void *context)
{
    struct bus *bus = context;
    if (bus->gathered > 0 && bus->answered <= sim_now(&bus->sim))
        send_gathered(bus);
}

static void before_sleep(void *context)
{
    struct bus *bus = context;
    if (segment_idle(&bus->sim.segment))
        bus_ports_silence(&bus->ports);
    bus_ports_listen(&bus->ports);
    bus_files_flush(&bus->files);
}

static const struct bus_time_calls time_calls = {.due = on_due, .advanced = on_advanced, .before_sleep = before_sleep};

/* ---- For those who drive it from outside ---------------------------------------------------------------------------- */

struct sim *bus_sim(struct bus *bus)
{
    bus_time_update(&bus->time);
    return &bus->sim;
}

void bus_changed(struct bus *bus)
{
    bus_time_changed(&bus->time);
}

void bus_wait(struct bus *bus, struct bus_waiter *waiter)
{
    bus_time_wait(&bus->time, waiter);
}

void bus_cancel_wait(struct bus *bus, struct bus_waiter *waiter)
{
    bus_time_cancel_wait(&bus->time, waiter);
}

bool bus_advance(struct bus *bus, struct bus_waiter *waiter)
{
    return bus_time_advance(&bus->time, waiter);
}

bool bus_is_stepped(const struct bus *bus)
{
    return bus_time_is_stepped(&bus->time);
}

bool bus_set_clock(struct bus *bus, const char *text, struct refusal *refusal)
{
    return bus_time_set_clock(&bus->time, text, refusal);
}

uint64_t bus_present(const struct bus *bus)
{
    return bus_time_present(&bus->time);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static bool configure_plant(struct bus *bus)
{
    const char *text = bus->options->plant_text;
    char *said = NULL;
    size_t length;
    FILE *errors = text ? open_memstream(&said, &length) : NULL;
    bool ok = !text || (errors && sim_configure_plants(&bus->sim, bus->options->plant, text, strlen(text), errors));
    if (errors)
        fclose(errors);
    if (said)
        log_text(said);
    free(said);
    return ok;
}

/* For snapshots to files, which only clients of a control socket can ask for. */
static bool keep_journal(struct bus *bus)
{
    if (bus->options->no_control || snapshots_keep_journal(&bus->sim))
        return true;
    log_error("out of memory");
    return false;
}

static void on_service_out(void *context, unsigned client, const uint8_t *bytes, size_t length)
{
    const struct bus *bus = context;
    bus_services_send(bus->services, client, bytes, length);
}

static struct sim *on_sim(void *context)
{
    return bus_sim(context);
}

static void on_command(void *context)
{
    bus_changed(context);
}

static const struct bus_service_calls service_calls = {.sim = on_sim, .changed = on_command, .presence = on_presence};

static void plug_adapter(void *context, bool plugged)
{
    struct bus *bus = context;
    bus_ports_plug(&bus->ports, plugged);
}

static bool begin_sim(struct bus *bus)
{
    const struct bus_options *options = bus->options;
    struct sim_config config = {
        .device = options->device.kind,
        .unit = options->device.config,
        .nodes = options->nodes,
        .timed = bus->time.timed && !bus_is_stepped(bus),
        .turnaround = options->turnaround,
        .seed = options->seed,
        .out = gather_bytes,
        .service_out = on_service_out,
        .adapter = plug_adapter,
        .context = bus,
    };
    if (options->flash)
        config.flash = (struct sim_flash){.read = flash_read, .erase = flash_erase, .program = flash_program, .context = bus};
    if (sim_begin(&bus->sim, &config) && snapshots_attach(&bus->sim))
        return true;
    log_error("out of memory");
    return false;
}

static uint64_t present_tick(const void *context)
{
    return bus_present(context);
}

bool bus_begin(struct bus *bus, unsigned number, const struct bus_options *options, uv_loop_t *loop, struct line_watch *watch,
               struct coverage *coverage, const struct bus_calls *calls, void *context)
{
    bus->log = (struct bus_log){number, options->lines > 1, options->verbose, present_tick, bus};
    bus->options = options;
    bus->coverage = coverage;
    bus->calls = calls;
    bus->context = context;
    bus_ports_prepare(&bus->ports, options, &bus->log, &ports_calls, bus);
    if (!bus_ports_open(&bus->ports, loop, watch) || !open_flash(bus))
        return false;
    bool timed = options->baud != 0 && !bus->ports.line.is_wire;
    bus_time_prepare(&bus->time, options, timed, &bus->sim, &bus->log, &time_calls, bus);
    if (!begin_sim(bus))
        return false;
    watch_for_log(bus);
    if (!bus_services_open(&bus->services, options, &bus->log, loop, &service_calls, bus))
        return false;
    return configure_plant(bus) && keep_journal(bus) && bus_time_begin(&bus->time, loop);
}

bool bus_start(struct bus *bus)
{
    if (!bus_ports_publish(&bus->ports))
        return false;
    bus_time_start(&bus->time);
    return true;
}

bool bus_reserve_files(const struct bus *bus)
{
    return bus_files_reserve(bus->options, bus->log.number);
}

bool bus_begin_files(struct bus *bus)
{
    return bus_files_begin(&bus->files, bus->options, bus->log.number, &bus->sim);
}

bool bus_end(struct bus *bus)
{
    bool ok = true;
    bus_ports_close(&bus->ports);
    bus_services_close(bus->services);
    bus_time_end(&bus->time);
    sim_store(&bus->sim);
    if (!bus_files_end(&bus->files))
        ok = false;
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        if (bus->unit[at].open && !flash_file_close(&bus->unit[at].flash))
            ok = false;
    return ok;
}

void bus_free(struct bus *bus)
{
    sim_end(&bus->sim);
    for (unsigned at = 0; at < NODE_LIST_MAX; at++)
        free(bus->unit[at].flash_path);
    bus_ports_free(&bus->ports);
    bus_services_free(bus->services);
    free(bus);
}
