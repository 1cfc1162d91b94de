/* SPDX-License-Identifier: MIT */
#include "serve_options.h"

#include <argp.h>
#include <jansson.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "control/control.h"
#include "file/file.h"
#include "line/line.h"
#include "notify.h"
#include "options/options.h"
#include "serve_checks.h"
#include "serve_option_table.h"
#include "text/text.h"
#include "trace/trace.h"
#include "wire/wire.h"

#define IDLE_DEFAULT 10u /* s */
#define IDLE_MAX 86400   /* s */

/* A whole number up to `high`, digits only. Returns -1 if it is none. */
static int64_t read_number(const char *text, int64_t high)
{
    uint64_t value;
    return number_read(text, 0, (uint64_t)high, &value) ? (int64_t)value : -1;
}

/* A number from 0 to `high`, or a usage error that says what was expected. */
static unsigned read_bounded_number(const char *name, const char *text, unsigned low, unsigned high, const char *unit,
                                    struct argp_state *state)
{
    int64_t value = read_number(text, high);
    if (value < low)
        argp_error(state, "--%s: `%s' is wrong: expected a number%s from %u to %u", name, text, unit, low, high);
    return (unsigned)value;
}

static unsigned read_baud(const char *text, struct argp_state *state)
{
    int64_t value = read_number(text, 115200);
    if (value < 0)
        argp_error(state, "--baud: `%s' is wrong: expected the rate of the unit, or 0 for no pacing", text);
    return (unsigned)value;
}

/* The rate of the unit, unless it is 0. */
static void complete_baud(struct bus_options *options, const struct argp_state *state)
{
    unsigned baud = device_baud(options->device.kind, &options->device.config);
    if (options->baud != 0 && options->baud != baud && options->baud != SERVE_NO_BAUD)
        argp_error(state, "--baud: `%u' is wrong: expected %u, the rate of the unit, or 0 for no pacing", options->baud, baud);
    if (options->baud != 0)
        options->baud = baud;
}

/* Per cent with at most one decimal, in tenths. */
static int read_percent(const char *text, struct argp_state *state)
{
    char whole[4] = "";
    size_t digits = strspn(text, "0123456789");
    int64_t value = -1, tenths = 0;
    if (digits > 0 && digits < sizeof whole) {
        memcpy(whole, text, digits);
        value = read_number(whole, 100);
        if (text[digits] == '.')
            tenths = read_number(text + digits + 1, 9);
        else if (text[digits])
            value = -1;
    }
    if (value < 0 || tenths < 0 || (text[digits] && strlen(text + digits) != 2) || value * 10 + tenths > 1000)
        argp_error(state, "--min-coverage: `%s' is wrong: expected per cent from 0 to 100, with at most one decimal", text);
    return (int)(value * 10 + tenths);
}

static enum line_rts read_rts(const char *text, struct argp_state *state)
{
    if (strcmp(text, "driver") != 0 && strcmp(text, "toggles") != 0)
        argp_error(state, "--rts: `%s' is unknown: expected driver or toggles", text);
    return strcmp(text, "toggles") == 0 ? LINE_RTS_TOGGLES : LINE_RTS_DRIVER;
}

static const char *read_address(const char *name, const char *text, struct argp_state *state)
{
    if (!net_address_valid(text))
        argp_error(state, "--%s: `%s' is wrong: expected " NET_ADDRESS_EXPECTED, name, text);
    return text;
}

/* A path, which has to fit the READY line. */
static const char *read_path(const char *name, const char *text, struct argp_state *state)
{
    json_t *string = json_string(text);
    if (!*text)
        argp_error(state, "--%s: expected a path, found nothing", name);
    if (!string)
        argp_error(state, "--%s: the path is not valid UTF-8, which the READY line needs", name);
    json_decref(string);
    return text;
}

/* A path, or tcp:HOST:PORT; the last one given counts. */
static void read_control(struct bus_options *options, const char *text, struct argp_state *state)
{
    const bool is_tcp = strncmp(text, "tcp:", 4) == 0;
    options->control = is_tcp ? NULL : read_path("control", text, state);
    options->control_tcp = is_tcp ? text + 4 : NULL;
    if (is_tcp && !control_tcp_valid(text + 4))
        argp_error(state, "--control: `%s' is wrong: expected tcp: and " CONTROL_TCP_EXPECTED, text);
}

/* A path in which %n and %l may be. */
static const char *read_pattern(const char *name, const char *text, struct argp_state *state)
{
    read_path(name, text, state);
    if (!name_pattern_valid(text))
        argp_error(state, "--%s: `%s' has a %% without meaning: expected %%n (address), %%l (number of the bus) or %%%%", name,
                   text);
    return text;
}

/* Add a file of --trace or --wire. */
static void add_file(const char *name, const char *text, bool known, const char *expected, const char **list,
                     struct argp_state *state)
{
    unsigned at = 0;
    read_pattern(name, text, state);
    if (!known)
        argp_error(state, "--%s: `%s' is wrong: expected %s", name, text, expected);
    while (at < BUS_FILES_MAX && list[at])
        at++;
    if (at == BUS_FILES_MAX)
        argp_error(state, "--%s: expected at most %u files", name, BUS_FILES_MAX);
    list[at] = text;
}

static void add_folder(struct bus_options *options, const char *text, struct argp_state *state)
{
    struct stat found;
    unsigned at = 0;
    if (stat(text, &found) != 0 || !S_ISDIR(found.st_mode))
        argp_error(state, "--allow-folder: `%s' is wrong: expected an existing folder", text);
    while (at < BUS_FOLDERS_MAX && options->folder[at])
        at++;
    if (at < BUS_FOLDERS_MAX)
        options->folder[at] = text;
    else
        argp_error(state, "--allow-folder: expected at most %u folders", BUS_FOLDERS_MAX);
}

static void add_service(struct bus_options *options, const char *text, const struct argp_state *state)
{
    unsigned at = 0;
    while (at < DEVICE_SERVICES_MAX && options->service_text[at])
        at++;
    if (at == DEVICE_SERVICES_MAX)
        argp_error(state, "--service: expected at most %u", DEVICE_SERVICES_MAX);
    options->service_text[at] = text;
}

/* "modbus-tcp=127.0.0.1:502", when the device is known. */
static void read_service(struct bus_options *options, unsigned at, const struct argp_state *state)
{
    const struct device_kind *kind = options->device.kind;
    const char *text = options->service_text[at], *equal = strchr(text, '=');
    size_t length = equal ? (size_t)(equal - text) : 0;
    char names[200] = "";
    for (const struct device_service *service = kind->services; service && service->name; service++) {
        if (strlen(service->name) == length && strncmp(service->name, text, length) == 0)
            options->service[at].name = service->name;
        snprintf(names + strlen(names), sizeof names - strlen(names), names[0] ? ", %s" : "%s", service->name);
    }
    if (!names[0])
        argp_error(state, "--service: the device %s has no servers", kind->name);
    if (!options->service[at].name)
        argp_error(state, "--service: `%s' is wrong: expected NAME=HOST:PORT with one of %s", text, names);
    if (!net_address_valid(equal + 1))
        argp_error(state, "--service: `%s' is wrong: expected " NET_ADDRESS_EXPECTED, equal + 1);
    options->service[at].address = equal + 1;
    for (unsigned before = 0; before < at; before++)
        if (options->service[before].name == options->service[at].name)
            argp_error(state, "--service: expected %s once", options->service[at].name);
}

static bool read_late(const char *text, struct argp_state *state)
{
    if (strcmp(text, "catch-up") != 0 && strcmp(text, "skip") != 0)
        argp_error(state, "--late: `%s' is unknown: expected catch-up or skip", text);
    return strcmp(text, "skip") == 0;
}

/* A device without a bus has no ports; serve_check_bus() refuses what would make some. */
static void check_ports(struct bus_options *options, const struct argp_state *state)
{
    const struct device_kind *device = options->device.kind;
    bool net = options->tcp || options->rfc2217;
    for (unsigned at = 0; at < DEVICE_SERVICES_MAX && options->service_text[at]; at++)
        read_service(options, at, state);
    options->pty = device->receive && !options->port && (!net || options->link || options->wine);
    if (options->pty && serve_option_missing(KEY_LINK))
        argp_error(state, "expected --tcp, --rfc2217 or --port: Windows has no pty (docs/WINDOWS.md)");
}

/* What does not go together. */
static void check_combinations(struct bus_options *options, struct argp_state *state)
{
    if (options->port && options->link)
        argp_error(state, "--link names the emulator's own pty: expected either --link or --port");
    if (options->port && options->wine)
        argp_error(state, "--wine leads to the emulator's own pty: expected either --wine or --port");
    if (options->port && options->lines > 1)
        argp_error(state, "--port is one bus: expected either --port or --lines");
    if (options->rts == LINE_RTS_TOGGLES && !options->port)
        argp_error(state, "--rts is for a serial device: expected --port, too");
    if (options->link && name_pattern_has(options->link, 'n'))
        argp_error(state, "--link: %%n names a unit, but a bus has one link: expected %%l for the number of the bus");
    if (options->link && options->lines > 1 && !name_pattern_has(options->link, 'l'))
        argp_error(state, "--link: expected %%l in the name, for the number of the bus, with --lines");
    serve_check_flash(options, state);
    complete_baud(options, state);
    if (options->baud == 0 && options->strict_line)
        argp_error(state, "--strict-line needs bytes that take time: expected it without --baud 0");
    if (options->baud == 0 && options->turnaround != SERVE_NO_TURNAROUND)
        argp_error(state, "--turnaround needs bytes that take time: expected it without --baud 0");
    if (options->turnaround == SERVE_NO_TURNAROUND)
        options->turnaround = options->baud != 0 ? device_turnaround(options->device.kind) : 0;
    if ((options->control || options->control_tcp || options->control_file) && options->no_control)
        argp_error(state, "expected either --control or --no-control");
    if (options->control_file && !options->control_tcp)
        argp_error(state, "--control-file is for a TCP port: expected --control tcp:PORT, too");
    if (options->control_file)
        options->control = options->control_file;
    if (options->window && options->no_control)
        argp_error(state, "--window needs the control socket: expected it without --no-control");
    serve_check_patterns(options, state);
}

/* Options of the units and of time. */
static error_t read_unit_option(int key, char *text, struct argp_state *state)
{
    struct bus_options *options = state->input;
    switch (key) {
    case KEY_NODE:
        options->nodes_text = text;
        return 0;
    case KEY_FLASH:
        options->flash = read_pattern("flash", text, state);
        return 0;
    case KEY_BACKUP:
        options->backup = read_pattern("backup", text, state);
        return 0;
    case KEY_CLOCK:
        options->clock_text = text;
        if (!virtual_clock_read(&options->clock, text))
            argp_error(state, "--clock: `%s' is wrong: expected " VIRTUAL_CLOCK_EXPECTED, text);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Options of the line. */
static error_t read_line_option(int key, char *text, struct argp_state *state)
{
    struct bus_options *options = state->input;
    switch (key) {
    case KEY_BAUD:
        options->baud = read_baud(text, state);
        return 0;
    case KEY_TURNAROUND:
        options->turnaround = read_bounded_number("turnaround", text, 0, SEGMENT_TURNAROUND_MAX, " of us", state);
        return 0;
    case KEY_LINES:
        options->lines = read_bounded_number("lines", text, 1, BUS_LINES_MAX, "", state);
        options->lines_text = text;
        return 0;
    case KEY_LINK:
        options->link = read_pattern("link", text, state);
        return 0;
    case KEY_WINE:
        options->wine = read_path("wine", text, state);
        if (!wine_link_valid(text))
            argp_error(state, "--wine: `%s' is wrong: expected " WINE_PORT_EXPECTED, text);
        return 0;
    case KEY_PORT:
        options->port = read_path("port", text, state);
        return 0;
    case KEY_RTS:
        options->rts = read_rts(text, state);
        options->rts_text = text;
        return 0;
    case KEY_TCP:
        options->tcp = read_address("tcp", text, state);
        return 0;
    case KEY_RFC2217:
        options->rfc2217 = read_address("rfc2217", text, state);
        return 0;
    case KEY_SERVICE:
        add_service(options, text, state);
        return 0;
    case KEY_STRICT_LINE:
        options->strict_line = true;
        return 0;
    default:
        return read_unit_option(key, text, state);
    }
}

/* Options for tests. */
static error_t read_test_option(int key, char *text, struct argp_state *state)
{
    struct bus_options *options = state->input;
    switch (key) {
    case KEY_LATE:
        options->late_skips = read_late(text, state);
        return 0;
    case KEY_SEED:
        options->seed = read_bounded_number("seed", text, 0, UINT32_MAX / 2, "", state);
        return 0;
    case KEY_PLANT:
        options->plant = read_path("plant", text, state);
        return 0;
    case KEY_TRACE:
        add_file("trace", text, trace_file_named(text), TRACE_FILE_EXPECTED, options->trace, state);
        return 0;
    case KEY_WIRE:
        add_file("wire", text, wire_file_named(text), WIRE_FILE_EXPECTED, options->wire, state);
        return 0;
    case KEY_RECORD:
        options->record = read_pattern("record", text, state);
        return 0;
    case KEY_FORCE:
        options->output_flags |= OUTPUT_FORCE;
        return 0;
    case KEY_CONTROL:
        read_control(options, text, state);
        return 0;
    case KEY_CONTROL_FILE:
        options->control_file = read_path("control-file", text, state);
        return 0;
    case KEY_ALLOW_FOLDER:
        add_folder(options, text, state);
        return 0;
    case KEY_NO_SANDBOX:
        options->no_sandbox = true;
        return 0;
    case KEY_NO_CONTROL:
        options->no_control = true;
        return 0;
    case KEY_WINDOW:
        options->window = text ? text : "127.0.0.1:0";
        return 0;
    default:
        return read_line_option(key, text, state);
    }
}

/* The addresses, and what not every device has. */
static void check_device(struct bus_options *options, const struct argp_state *state)
{
    const struct device_kind *device = options->device.kind;
    char expected[DEVICE_ERROR_SIZE];
    if (options->nodes_text && !node_list_read_up_to(&options->nodes, options->nodes_text, device->addresses))
        argp_error(state, "--node: `%s' is wrong: %s", options->nodes_text, device_addresses(device, expected));
    options->device.config.node = options->nodes.node[0];
    if (options->plant && device->has_no_steps)
        argp_error(state, "--plant: the axes of a %s make no steps that a plant could follow", device->name);
    if ((options->coverage || options->min_coverage >= 0) && !device->coverage)
        argp_error(state, "--coverage: not known for the device %s", device->name);
}

static error_t read_option(int key, char *text, struct argp_state *state)
{
    struct bus_options *options = state->input;
    const char *missing = serve_option_missing(key);
    if (missing)
        argp_error(state, "--%s: not in the program for Windows (docs/WINDOWS.md)", missing);
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->device;
        return 0;
    case KEY_READY_FD:
        options->ready_fd = notify_fd_read(text);
        if (options->ready_fd < 0)
            argp_error(state, "--ready-fd: `%s' is wrong: expected " NOTIFY_FD_EXPECTED, text);
        return 0;
    case KEY_EXIT_WHEN_IDLE:
        options->exit_when_idle = true;
        options->idle_seconds = IDLE_DEFAULT;
        if (text)
            options->idle_seconds = read_bounded_number("exit-when-idle", text, 0, IDLE_MAX, " of seconds", state);
        return 0;
    case KEY_VERBOSE:
        options->verbose = true;
        return 0;
    case KEY_COVERAGE:
        options->coverage = read_path("coverage", text, state);
        return 0;
    case KEY_MIN_COVERAGE:
        options->min_coverage = read_percent(text, state);
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "`%s': expected options only", text);
        return 0;
    case ARGP_KEY_END:
        serve_check_bus(options, state);
        check_device(options, state);
        check_ports(options, state);
        check_combinations(options, state);
        return 0;
    default:
        return read_test_option(key, text, state);
    }
}

void serve_options_read(struct bus_options *options, int argc, char **argv)
{
    *options = (struct bus_options){
        .nodes = {.count = 1, .node = {1}},
        .lines = 1,
        .clock_text = "real",
        .baud = SERVE_NO_BAUD,
        .turnaround = SERVE_NO_TURNAROUND,
        .min_coverage = -1,
        .seed = 1,
        .ready_fd = -1,
    };
    virtual_clock_read(&options->clock, "real");
    const struct argp_child children[] = {{.argp = device_arguments_argp(&options->device)}, {0}};
    const struct argp argp = {
        .options = serve_option_table(), .parser = read_option, .doc = serve_option_doc(), .children = children};
    arguments_parse(&argp, argc, argv, options);
}
