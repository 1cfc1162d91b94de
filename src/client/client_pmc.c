/* SPDX-License-Identifier: MIT */
#include "client_pmc.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "client_find.h"
#include "client_pmc_way.h"
#include "client_port.h"
#include "client_report.h"

struct doing {
    const struct client_pmc *pmc;
    struct pmc_link link;
    const char *const *words; /* after the name of the command */
    size_t count;
};

static const char *const axis_names[PMC_AXES] = {"x", "y"};

/* ---- The way to the unit ---------------------------------------------------------------------------------------------- */

/* The speed of a real line; a pty takes any. */
static bool set_baud(int fd, unsigned baud)
{
    static const struct {
        unsigned baud;
        speed_t speed;
    } speeds[] = {{9600, B9600}, {19200, B19200}, {38400, B38400}, {57600, B57600}, {115200, B115200}};
    struct termios settings;
    if (tcgetattr(fd, &settings) != 0)
        return true; /* no terminal: TCP */
    for (size_t i = 0; i < sizeof speeds / sizeof *speeds; i++)
        if (speeds[i].baud == baud)
            return cfsetspeed(&settings, speeds[i].speed) == 0 && tcsetattr(fd, TCSANOW, &settings) == 0;
    return false;
}

static enum exit_status open_line(struct doing *doing, const char *port)
{
    const struct client_pmc *pmc = doing->pmc;
    if (!client_port_valid(port))
        return client_usage("--port: expected tcp:HOST:PORT, PORT 1 to 65535, like tcp:localhost:4001, found '%s'", port);
    doing->link.way = pmc->face && strcmp(pmc->face, "modbus") == 0 ? &client_pmc_modbus : &client_pmc_lines;
    doing->link.port = port;
    doing->link.node = (uint8_t)pmc->node;
    doing->link.fd = client_port_open(port, pmc->timeout_ms);
    if (doing->link.fd < 0)
        return STATUS_FAILURE;
    if (set_baud(doing->link.fd, pmc->baud > 0 ? pmc->baud : PMC_BAUD))
        return STATUS_SUCCESS;
    client_report("%s: cannot set %u baud", port, pmc->baud);
    return STATUS_FAILURE;
}

/* The line if a port is named; else the control socket, if that is; else the bus of the emulator that is running. Once, when all
 * words have been read: what is wrong with them needs no unit. */
static enum exit_status open_link(struct doing *doing)
{
    const struct client_pmc *pmc = doing->pmc;
    const char *named = pmc->port != NULL ? pmc->port : getenv("RKM04_PORT");
    if (doing->link.way != NULL)
        return STATUS_SUCCESS;
    if (pmc->port == NULL && pmc->job->path != NULL) {
        doing->link.way = &client_pmc_control;
        return pmc->face == NULL ? STATUS_SUCCESS : client_usage("--face is for a port: expected --port");
    }
    if (named == NULL || named[0] == '\0') {
        const struct client_found *found = client_find_one("--port");
        if (found == NULL)
            return STATUS_FAILURE;
        named = found->port;
    }
    return open_line(doing, named);
}

/* ---- Words ---------------------------------------------------------------------------------------------------------- */

static unsigned axis_of(char letter)
{
    return letter == 'x' || letter == 'X' ? 0 : letter == 'y' || letter == 'Y' ? 1 : PMC_AXES;
}

/* "x", "Y", "xy". Returns the axes; 0: it is something else. */
static uint8_t axes_of(const char *word)
{
    uint8_t axes = 0;
    for (; *word != '\0'; word++) {
        unsigned axis = axis_of(*word);
        if (axis == PMC_AXES || (axes & 1u << axis) != 0)
            return 0;
        axes |= (uint8_t)(1u << axis);
    }
    return axes;
}

/* The axes of the first word; 0, all that the unit has, if it is something else. */
static uint8_t read_axes(struct doing *doing)
{
    uint8_t axes = doing->count > 0 ? axes_of(doing->words[0]) : 0;
    if (axes != 0) {
        doing->words++;
        doing->count--;
    }
    return axes;
}

static enum exit_status expect_no_more(const struct doing *doing)
{
    return doing->count == 0 ? STATUS_SUCCESS : client_usage("pmc: `%s' is too much", doing->words[0]);
}

/* Words like x=1000. Returns a usage error if one is of another form or out of range. */
static enum exit_status read_values(const struct doing *doing, int32_t low, int32_t high, struct pmc_request *request)
{
    for (size_t i = 0; i < doing->count; i++) {
        const char *word = doing->words[i];
        char *end;
        unsigned axis = word[0] != '\0' && word[1] == '=' ? axis_of(word[0]) : PMC_AXES;
        long value = axis < PMC_AXES ? strtol(word + 2, &end, 10) : 0;
        if (axis == PMC_AXES || *end != '\0' || end == word + 2 || value < low || value > high)
            return client_usage("pmc: expected x=N or y=N, N a whole number from %" PRId32 " to %" PRId32 ", found '%s'", low,
                                high, word);
        request->axes |= (uint8_t)(1u << axis);
        request->value[axis] = (int32_t)value;
    }
    return request->axes != 0 ? STATUS_SUCCESS : client_usage("pmc: expected x=N, y=N or both");
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static enum exit_status done(const struct doing *doing)
{
    return doing->pmc->json ? client_print_json(json_object()) : STATUS_SUCCESS;
}

/* Send a request; its axes 0: all that the unit has. */
static enum exit_status ask(struct doing *doing, struct pmc_request *request)
{
    int32_t position[PMC_AXES];
    unsigned count = 0;
    enum exit_status status = open_link(doing);
    if (status == STATUS_SUCCESS && request->axes == 0) {
        status = doing->link.way->positions(&doing->link, position, &count);
        request->axes = count == 1 ? 1 : 3;
    }
    if (status == STATUS_SUCCESS)
        status = doing->link.way->ask(&doing->link, request);
    return status == STATUS_SUCCESS ? done(doing) : status;
}

static enum exit_status do_run(struct doing *doing)
{
    unsigned reg = 0;
    struct pmc_request request = {.kind = PMC_RUN, .axes = read_axes(doing)};
    if (doing->count > 0) {
        if (!client_usage_number("pmc run: register", doing->words[0], 0, PMC_REGISTERS - 1u, &reg))
            return STATUS_USAGE;
        doing->words++;
        doing->count--;
    }
    request.value[0] = request.value[1] = (int32_t)reg;
    enum exit_status status = expect_no_more(doing);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

/* x+ y-, or x for x+. */
static enum exit_status do_jog(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_JOG};
    for (size_t i = 0; i < doing->count; i++) {
        const char *word = doing->words[i];
        unsigned axis = axis_of(word[0]);
        bool is_minus = axis < PMC_AXES && strcmp(word + 1, "-") == 0;
        if (axis == PMC_AXES || (!is_minus && strcmp(word + 1, "+") != 0 && word[1] != '\0'))
            return client_usage("pmc jog: expected x+, x-, y+ or y-, found '%s'", word);
        request.axes |= (uint8_t)(1u << axis);
        request.value[axis] = is_minus ? -1 : 1;
    }
    return request.axes != 0 ? ask(doing, &request) : client_usage("pmc jog: expected x+, x-, y+ or y-");
}

static enum exit_status do_move(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_MOVE_TO};
    bool is_by = doing->count > 0 && strcmp(doing->words[0], "by") == 0;
    if (is_by || (doing->count > 0 && strcmp(doing->words[0], "to") == 0)) {
        request.kind = is_by ? PMC_MOVE_BY : PMC_MOVE_TO;
        doing->words++;
        doing->count--;
    }
    enum exit_status status = read_values(doing, PMC_COUNTER_MIN, PMC_COUNTER_MAX, &request);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

static enum exit_status do_speed(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_SET_SPEED};
    enum exit_status status = read_values(doing, 1, PMC_SPEED_MAX, &request);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

static enum exit_status do_stop(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_STOP, .axes = read_axes(doing)};
    if (doing->count > 0 && strcmp(doing->words[0], "now") == 0) {
        request.kind = PMC_STOP_NOW;
        doing->words++;
        doing->count--;
    }
    enum exit_status status = expect_no_more(doing);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

static enum exit_status do_home(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_SEARCH, .axes = read_axes(doing)};
    enum exit_status status = expect_no_more(doing);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

static enum exit_status do_position(struct doing *doing)
{
    int32_t position[PMC_AXES];
    unsigned axes;
    enum exit_status status = expect_no_more(doing);
    if (status == STATUS_SUCCESS)
        status = open_link(doing);
    if (status == STATUS_SUCCESS)
        status = doing->link.way->positions(&doing->link, position, &axes);
    if (status != STATUS_SUCCESS)
        return status;
    json_t *object = json_object();
    for (unsigned axis = 0; axis < axes; axis++) {
        if (!doing->pmc->json)
            printf("%s: %" PRId32 "\n", axis_names[axis], position[axis]);
        json_object_set_new(object, axis_names[axis], json_integer(position[axis]));
    }
    if (doing->pmc->json)
        return client_print_json(object);
    json_decref(object);
    return STATUS_SUCCESS;
}

static json_t *errors_json(uint8_t errors)
{
    static const char *const names[] = {"sl+", "sl-", "hl+", "hl-", "emg", "pgm", "hom", "inx"};
    json_t *list = json_array();
    for (unsigned bit = 0; bit < 8; bit++)
        if ((errors & 1u << bit) != 0)
            json_array_append_new(list, json_string(names[bit]));
    return list;
}

static void print_errors(const char *axis, const json_t *list)
{
    size_t i;
    json_t *name;
    printf("%s:%s", axis, json_array_size(list) == 0 ? " none" : "");
    json_array_foreach(list, i, name)
        printf(" %s", json_string_value(name));
    puts("");
}

static enum exit_status show_errors(struct doing *doing)
{
    uint8_t errors[PMC_AXES];
    unsigned axes;
    enum exit_status status = open_link(doing);
    if (status == STATUS_SUCCESS)
        status = doing->link.way->errors(&doing->link, errors, &axes);
    if (status != STATUS_SUCCESS)
        return status;
    json_t *object = json_object();
    for (unsigned axis = 0; axis < axes; axis++) {
        json_t *list = errors_json(errors[axis]);
        if (!doing->pmc->json)
            print_errors(axis_names[axis], list);
        json_object_set_new(object, axis_names[axis], list);
    }
    if (doing->pmc->json)
        return client_print_json(object);
    json_decref(object);
    return STATUS_SUCCESS;
}

/* errors; errors clear [AXES] */
static enum exit_status do_errors(struct doing *doing)
{
    struct pmc_request request = {.kind = PMC_CLEAR_ERRORS};
    if (doing->count == 0)
        return show_errors(doing);
    if (strcmp(doing->words[0], "clear") != 0)
        return client_usage("pmc errors: expected clear or nothing, found '%s'", doing->words[0]);
    doing->words++;
    doing->count--;
    request.axes = read_axes(doing);
    enum exit_status status = expect_no_more(doing);
    return status == STATUS_SUCCESS ? ask(doing, &request) : status;
}

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

static enum exit_status show_file(struct doing *doing, enum pmc_text_kind kind)
{
    char *text;
    enum exit_status status = open_link(doing);
    if (status == STATUS_SUCCESS)
        status = doing->link.way->get(&doing->link, kind, &text);
    if (status != STATUS_SUCCESS)
        return status;
    if (doing->pmc->json)
        status = client_print_json(json_pack("{s:s}", "text", text));
    else
        fputs(text, stdout);
    free(text);
    return status;
}

static enum exit_status send_file(struct doing *doing, enum pmc_text_kind kind, const char *path)
{
    struct program_text file = {0};
    const char *name = strcmp(path, "-") == 0 ? "<stdin>" : path, *wrong = program_text_read_raw(&file, path);
    if (wrong != NULL) {
        client_report("cannot read %s: %s", name, wrong);
        return STATUS_FAILURE;
    }
    char *text = strndup(file.text, file.length);
    enum exit_status status = text ? open_link(doing) : STATUS_FAILURE;
    if (status == STATUS_SUCCESS)
        status = doing->link.way->put(&doing->link, kind, name, text);
    free(text);
    program_text_free(&file);
    return status == STATUS_SUCCESS ? done(doing) : status;
}

static enum exit_status do_text(struct doing *doing, enum pmc_text_kind kind)
{
    const char *what = kind == PMC_TEXT_PROGRAM ? "program" : "parameters";
    if (doing->count == 1 && strcmp(doing->words[0], "get") == 0)
        return show_file(doing, kind);
    if (doing->count == 2 && strcmp(doing->words[0], "put") == 0)
        return send_file(doing, kind, doing->words[1]);
    return client_usage("pmc %s: expected get, or put FILE", what);
}

static enum exit_status do_program(struct doing *doing)
{
    return do_text(doing, PMC_TEXT_PROGRAM);
}

static enum exit_status do_parameters(struct doing *doing)
{
    return do_text(doing, PMC_TEXT_PARAMETERS);
}

static enum exit_status do_store(struct doing *doing)
{
    uint8_t axes = doing->count > 0 ? axes_of(doing->words[0]) : 0;
    if (doing->count > 1 || (doing->count == 1 && axes == 0))
        return client_usage("pmc store: expected x, y, xy or nothing");
    enum exit_status status = open_link(doing);
    if (status == STATUS_SUCCESS)
        status = doing->link.way->store(&doing->link, axes);
    return status == STATUS_SUCCESS ? done(doing) : status;
}

/* ---- All of them ---------------------------------------------------------------------------------------------------- */

static const struct {
    const char *name;
    enum exit_status (*function)(struct doing *doing);
} commands[] = {
    {"run", do_run},           {"jog", do_jog},       {"move", do_move},       {"speed", do_speed},
    {"stop", do_stop},         {"home", do_home},     {"position", do_position}, {"errors", do_errors},
    {"program", do_program},   {"parameters", do_parameters}, {"store", do_store},
};

#define COMMANDS (sizeof commands / sizeof commands[0])

enum exit_status client_pmc(const struct client_pmc *pmc)
{
    struct doing doing = {.pmc = pmc, .link = {.fd = -1, .timeout_ms = pmc->timeout_ms, .job = pmc->job}};
    size_t row = 0;
    if (pmc->count == 0)
        return client_usage("pmc: expected " CLIENT_PMC_COMMANDS);
    while (row < COMMANDS && strcmp(commands[row].name, pmc->words[0]) != 0)
        row++;
    if (row == COMMANDS)
        return client_usage("pmc: expected " CLIENT_PMC_COMMANDS ", found '%s'%s", pmc->words[0],
                            nearest_hint(pmc->words[0], CLIENT_PMC_COMMANDS));
    doing.words = pmc->words + 1;
    doing.count = pmc->count - 1;
    enum exit_status status = commands[row].function(&doing);
    if (doing.link.fd >= 0)
        close(doing.link.fd);
    if (pmc->job->connected)
        client_rpc_close(&pmc->job->rpc);
    return status;
}
