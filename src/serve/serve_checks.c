/* SPDX-License-Identifier: MIT */
#include "serve_checks.h"

#include <string.h>

#include "file/file.h"
#include "line/line.h"

void serve_check_patterns(const struct bus_options *options, struct argp_state *state)
{
    const char *const *lists[] = {options->trace, options->wire, &options->record};
    static const char *const names[] = {"trace", "wire", "record"};
    for (size_t which = 0; which < sizeof lists / sizeof lists[0]; which++) {
        for (unsigned at = 0; at < (which < 2 ? BUS_FILES_MAX : 1) && lists[which][at]; at++) {
            if (name_pattern_has(lists[which][at], 'n'))
                argp_error(state, "--%s: %%n names a unit, but the file is about the bus: expected %%l", names[which]);
            if (options->lines > 1 && !name_pattern_has(lists[which][at], 'l'))
                argp_error(state, "--%s: expected %%l in the name, for the number of the bus, with --lines", names[which]);
        }
    }
}

void serve_check_flash(struct bus_options *options, struct argp_state *state)
{
    const struct device_kind *device = options->device.kind;
    const char *given = options->backup ? "backup" : "flash";
    if (options->backup)
        device_arguments_check_backup(device, true, state);
    if (options->backup && options->flash)
        argp_error(state, "expected either --flash or --backup, which are the same");
    if (options->backup)
        options->flash = options->backup;
    if (options->flash && device->flash_blocks == 0)
        argp_error(state, "--flash: the device %s has no flash", device->name);
    if (options->flash && options->lines > 1 && !name_pattern_has(options->flash, 'l'))
        argp_error(state, "--%s: expected %%l in the name, for the number of the bus, with --lines", given);
    if (options->flash && options->nodes.count > 1 && !name_pattern_has(options->flash, 'n'))
        argp_error(state, "--%s: expected %%n in the name, for the address, with several units", given);
}

void serve_check_bus(const struct bus_options *options, const struct argp_state *state)
{
    const struct device_kind *device = options->device.kind;
    const struct {
        const char *name;
        bool is_given;
    } bus[] = {
        {"node", options->nodes_text != NULL},
        {"port", options->port != NULL},
        {"link", options->link != NULL},
        {"tcp", options->tcp != NULL},
        {"rfc2217", options->rfc2217 != NULL},
        {"wine", options->wine != NULL},
        {"wire", options->wire[0] != NULL},
        {"rts", options->rts_text != NULL},
        {"baud", options->baud != SERVE_NO_BAUD},
        {"turnaround", options->turnaround != SERVE_NO_TURNAROUND},
        {"strict-line", options->strict_line},
        {"lines", options->lines_text != NULL},
        {"exit-when-idle", options->exit_when_idle && !device->services}, /* servers have clients, too */
        {"verbose", options->verbose && !device->services},
        {"coverage", options->coverage != NULL},
        {"min-coverage", options->min_coverage >= 0},
    };
    for (size_t at = 0; !device->receive && at < sizeof bus / sizeof bus[0]; at++)
        if (bus[at].is_given)
            argp_error(state, "--%s: the device %s has no bus", bus[at].name, device->name);
}
