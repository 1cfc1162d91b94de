/* SPDX-License-Identifier: MIT */
#include "serve_report.h"

#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "line/line.h"
#include "notify.h"
#include "text/text.h"

#define NODES_TEXT_SIZE (NODE_LIST_MAX * NODE_NAME_SIZE)

/* ---- The start ------------------------------------------------------------------------------------------------------ */

/* "unit 3", "units 1, 2, 5". Returns `text`. */
static const char *units_text(const struct node_list *nodes, char text[NODES_TEXT_SIZE])
{
    size_t length = (size_t)snprintf(text, NODES_TEXT_SIZE, nodes->count > 1 ? "units" : "unit");
    for (unsigned i = 0; i < nodes->count && length < NODES_TEXT_SIZE; i++)
        length += (size_t)snprintf(text + length, NODES_TEXT_SIZE - length, "%s %u", i > 0 ? "," : "", nodes->node[i]);
    return text;
}

static void log_ports(const struct bus *bus)
{
    const struct bus_ports *ports = &bus->ports;
    char units[NODES_TEXT_SIZE];
    units_text(&bus->options->nodes, units);
    if (!bus->options->device.kind->receive)
        bus_log(&bus->log, "%s, device %s, without a bus", units, bus->options->device.kind->name);
    else if (bus->options->port)
        bus_log(&bus->log, "%s on %s", units, bus->options->port);
    else if (bus->options->pty)
        bus_log(&bus->log, "%s on %s, link %s", units, ports->line.path, ports->pty.link.path);
    if (bus->options->wine)
        bus_log(&bus->log, "%s leads to the link", ports->pty.wine.path);
    if (ports->tcp)
        bus_log(&bus->log, "%s on tcp:%s", units, ports->tcp->address);
    if (ports->rfc2217)
        bus_log(&bus->log, "%s on rfc2217://%s", units, ports->rfc2217->address);
    for (unsigned at = 0; bus_services_address(bus->services, at); at++)
        bus_log(&bus->log, "%s: %s on %s", units, bus->options->service[at].name, bus_services_address(bus->services, at));
}

static void log_flash(struct bus *bus)
{
    for (unsigned at = 0; at < sim_units(&bus->sim); at++) {
        const char *name = bus->sim.unit[at].name;
        if (bus->unit[at].flash_path)
            bus_log(&bus->log, "unit %s: %s image %s", name, bus->unit[at].flash.name, bus->unit[at].flash_path);
        for (unsigned motor = 1; motor <= sim_device(&bus->sim)->axes; motor++) {
            const struct device_axis state = sim_axis(&bus->sim, at + 1u, motor);
            if (state.slot == DEVICE_SLOT_LOADED)
                bus_log(&bus->log, "unit %s, motor %u: starts the program of %u commands from flash", name, motor,
                        state.commands);
            else if (state.slot == DEVICE_SLOT_UNTRUSTED)
                bus_log(&bus->log, "unit %s, motor %u: incomplete flash program: starts without a program", name, motor);
        }
    }
}

static const char *framing_name(const struct bus_options *options)
{
    return device_framing_of(options->device.kind, &options->device.config)->link->name;
}

void serve_report_start(const struct bus_options *options, struct bus *const *buses)
{
    const struct device_readings *readings = options->device.kind->readings;
    char text[DEVICE_TEXT_SIZE];
    for (unsigned i = 0; i < options->lines; i++)
        log_ports(buses[i]);
    if (readings && readings->text(&options->device.config, text)[0] != '\0')
        log_at(0, "readings %s", text);
    if (!options->device.kind->receive)
        log_at(0, "clock %s", options->clock_text);
    else if (options->baud == 0 || options->clock.stands)
        log_at(0, "framing %s, bytes take no time, clock %s", framing_name(options), options->clock_text);
    else
        log_at(0, "framing %s, bytes paced at %u baud, turnaround %" PRIu32 " us, clock %s", framing_name(options), options->baud,
               options->turnaround, options->clock_text);
    if (!options->flash && options->device.kind->flash_blocks > 0)
        log_at(0, options->device.kind->flash_name
                      ? "no file for the backup memory: it is lost when the emulator ends (--backup FILE keeps it)"
                      : "no flash image: stored programs are lost when the emulator ends (--flash FILE keeps them)");
    for (unsigned i = 0; i < options->lines; i++)
        log_flash(buses[i]);
}

/* ---- READY ---------------------------------------------------------------------------------------------------------- */

static json_t *nodes_json(const struct node_list *nodes)
{
    json_t *list = json_array();
    for (unsigned i = 0; list && i < nodes->count; i++) {
        if (json_array_append_new(list, json_integer(nodes->node[i])) != 0) {
            json_decref(list);
            return NULL;
        }
    }
    return list;
}

/* Where a line is to be found. */
static json_t *ports_json(const struct bus *bus)
{
    const struct bus_ports *ports = &bus->ports;
    bool pty = bus->options->pty;
    json_t *services = bus_services_address(bus->services, 0) ? json_object() : NULL; /* NULL: left out */
    for (unsigned at = 0; services && bus_services_address(bus->services, at); at++)
        json_object_set_new(services, bus->options->service[at].name, json_string(bus_services_address(bus->services, at)));
    return json_pack("{s:s?, s:s?, s:s?, s:s?, s:s?, s:o*}", "pty", pty ? ports->line.path : NULL, "link",
                     pty ? ports->pty.link.path : NULL, "port", bus->options->port, "tcp",
                     ports->tcp ? ports->tcp->address : NULL, "rfc2217", ports->rfc2217 ? ports->rfc2217->address : NULL,
                     "services", services);
}

/* With several lines the ports at the top are those of line 0, and `lines` has all. */
json_t *serve_report_json(const struct bus_options *options, struct bus *const *buses, const struct control *control)
{
    const struct device_kind *kind = options->device.kind;
    json_t *ready = ports_json(buses[0]), *lines = NULL;
    json_t *rest = json_pack("{s:i, s:o, s:s, s:i, s:i, s:s, s:o*, s:s?, s:s?, s:s, s:s*}", "node", (int)options->nodes.node[0],
                             "nodes", nodes_json(&options->nodes), "framing", framing_name(options), "baud",
                             (int)options->baud, "turnaround", (int)options->turnaround, "clock", options->clock_text,
                             "readings", kind->readings ? kind->readings->json(&options->device.config) : NULL, "flash",
                             options->flash, "control", control_path(control), "device", kind->name, "control_tcp",
                             control_address(control));
    bool ok = ready && rest && json_object_update(ready, rest) == 0;
    json_decref(rest);
    if (ok && options->lines > 1) {
        lines = json_array();
        for (unsigned i = 0; ok && i < options->lines; i++)
            ok = json_array_append_new(lines, ports_json(buses[i])) == 0;
        ok = json_object_set_new(ready, "lines", lines) == 0 && ok;
    }
    if (ok)
        return ready;
    json_decref(ready);
    return NULL;
}

bool serve_report_ready(const struct bus_options *options, struct bus *const *buses, const struct control *control)
{
    json_t *ready = serve_report_json(options, buses, control);
    char *text = ready ? json_dumps(ready, JSON_COMPACT) : NULL, *line = NULL;
    char units[NODES_TEXT_SIZE], status[NODES_TEXT_SIZE + 32];
    json_decref(ready);
    if (!text || asprintf(&line, "READY %s\n", text) < 0) {
        log_error("out of memory");
        free(text);
        return false;
    }
    snprintf(status, sizeof status, "%s on %u bus%s", units_text(&options->nodes, units), options->lines,
             options->lines > 1 ? "es" : "");
    struct delivery *delivery = delivery_begin(STDOUT_FILENO, line, false);
    int error = delivery ? delivery_wait(delivery, NOTIFY_WAIT_MS) : ENOMEM;
    if (error != 0)
        log_error("cannot print the READY line on stdout: %s", strerror(error));
    bool done = error == 0 && notify_ready(options->ready_fd, line, status);
    free(line);
    free(text);
    return done;
}

/* ---- The end -------------------------------------------------------------------------------------------------------- */

void serve_report_end(struct bus *bus)
{
    struct device_counters sum = {0};
    struct segment_counters line = segment_counters(&bus->sim.segment);
    if (!sim_device(&bus->sim)->receive)
        return;
    for (unsigned number = 1; number <= sim_units(&bus->sim); number++) {
        const struct device_counters counters = sim_device(&bus->sim)->counters(sim_core(&bus->sim, number));
        sum.requests += counters.requests;
        sum.answers += counters.answers;
        sum.dropped += counters.dropped;
    }
    bus_log(&bus->log, "requests %" PRIu32 ", answers %" PRIu32 ", frames dropped %" PRIu32 ", bytes dropped %" PRIu64
                 ", collisions %" PRIu64 ", framing errors %" PRIu64 ", overruns %" PRIu64,
            sum.requests, sum.answers, sum.dropped, bus_ports_dropped(&bus->ports), line.collisions, line.framing_errors,
            line.overruns);
}
