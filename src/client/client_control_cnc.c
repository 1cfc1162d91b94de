/* SPDX-License-Identifier: MIT */
/* cnc: what a CNC872 has of its own, over the control socket. */
#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client_job.h"
#include "text/text.h"

#define CELLS_MAX 1000 /* of a list */
#define LISTING_LINES 500

/* ---- Cells -------------------------------------------------------------------------------------------------------------- */

static void print_values(const json_t *result)
{
    const char *name;
    json_t *value;
    json_object_foreach(json_object_get(result, "cells"), name, value) {
        char *text = json_dumps(value, JSON_ENCODE_ANY);
        printf("%s=%s\n", name, text != NULL ? text : "?");
        free(text);
    }
}

static enum exit_status get_cells(struct client_job *job)
{
    json_t *names = json_array();
    if (job->count < 2) {
        json_decref(names);
        return client_usage("cnc get: expected names of cells, as in `cnc get PO_STOP B_INK_EX[0]'");
    }
    for (size_t i = 1; i < job->count; i++)
        json_array_append_new(names, json_string(job->words[i]));
    return client_job_show(job, "cnc.get", json_pack("{s:o}", "cells", names), print_values);
}

/* Call a method with the words NAME=VALUE as its parameters, or, with `key`, as one of them. */
static enum exit_status call_members(struct client_job *job, const char *method, const char *key, const char *expected)
{
    json_t *members = json_object();
    const bool is_right = job->count > 1 && client_job_members(members, job->words + 1, job->count - 1);
    if (is_right)
        return client_job_show(job, method, key != NULL ? json_pack("{s:o}", key, members) : members, NULL);
    json_decref(members);
    return job->count > 1 ? STATUS_USAGE : client_usage("cnc %s: expected %s", job->words[0], expected);
}

static enum exit_status set_cells(struct client_job *job)
{
    return call_members(job, "cnc.set", "cells", "CELL=VALUE..., as in `cnc set STOP_REQ=1'");
}

static void print_list(const json_t *result)
{
    size_t i;
    json_t *cell;
    json_array_foreach(json_object_get(result, "cells"), i, cell) {
        const char *name, *type, *access, *section;
        if (json_unpack(cell, "{s:s, s:s, s:s, s:s}", "name", &name, "type", &type, "access", &access, "section", &section) == 0)
            printf("%-24s  %-6s  %-2s  %s\n", name, type, access, section);
    }
    const json_int_t more = json_integer_value(json_object_get(result, "more"));
    if (more > 0)
        printf("and %" JSON_INTEGER_FORMAT " more\n", more);
}

static enum exit_status list_cells(struct client_job *job)
{
    if (job->count > 2)
        return client_usage("cnc cells: expected a part of a name, or nothing for all, found '%s'", job->words[2]);
    return client_job_show(job, "cnc.cells", json_pack("{s:i, s:s*}", "limit", CELLS_MAX, "search",
                                                  job->count == 2 ? job->words[1] : NULL),
                print_list);
}

/* ---- Panel -------------------------------------------------------------------------------------------------------------- */

/* start, stop, reset. */
static enum exit_status press(struct client_job *job)
{
    if (job->count > 1)
        return client_usage("cnc %s: expected nothing, found '%s'", job->words[0], job->words[1]);
    return client_job_show(job, "cnc.panel", json_pack("{s:b}", job->words[0], 1), NULL);
}

/* X+, X-; X: its key is let go. */
static enum exit_status jog(struct client_job *job)
{
    json_t *axes = json_object();
    for (size_t i = 1; i < job->count; i++) {
        const char *word = job->words[i];
        const size_t length = strcspn(word, "+-");
        char *name = strndup(word, length);
        if (length == 0 || strlen(word + length) > 1) {
            free(name);
            json_decref(axes);
            return client_usage("cnc jog: expected an axis with + or -, or alone to end its motion, found '%s'", word);
        }
        if (name != NULL)
            json_object_set_new(axes, name, json_string(word + length));
        free(name);
    }
    if (json_object_size(axes) > 0)
        return client_job_show(job, "cnc.panel", json_pack("{s:o}", "jog", axes), NULL);
    json_decref(axes);
    return client_usage("cnc jog: expected axes, as in `cnc jog X+' and then `cnc jog X'");
}

static enum exit_status home(struct client_job *job)
{
    if (job->count != 2)
        return client_usage("cnc home: expected one axis, as in `cnc home X'");
    return client_job_show(job, "cnc.panel", json_pack("{s:s}", "home", job->words[1]), NULL);
}

static enum exit_status work_panel(struct client_job *job)
{
    return call_members(job, "cnc.panel", NULL, "NAME=VALUE..., as in `cnc panel mode=manual feed=50'");
}

/* ---- PLC program -------------------------------------------------------------------------------------------------------- */

/* Does a section or mechanism wait in this line? */
static bool waits_in(const json_t *result, json_int_t line)
{
    size_t i;
    json_t *wait;
    json_array_foreach(json_object_get(result, "waits"), i, wait)
        if (json_integer_value(json_object_get(wait, "line")) == line)
            return true;
    return false;
}

/* "    12 >            0  LDR VENT_I": line, where it waits, the value of the cell, the text. */
static void print_listing(const json_t *result)
{
    size_t i;
    json_t *line, *call;
    const char *name;
    const json_t *halted = json_object_get(result, "halted");
    printf("T %" JSON_INTEGER_FORMAT "  RLO %d  DR %" JSON_INTEGER_FORMAT "  DR_REAL %g  BX %d\n",
           json_integer_value(json_object_get(result, "t")), (int)json_integer_value(json_object_get(result, "rlo")),
           json_integer_value(json_object_get(result, "dr")), json_real_value(json_object_get(result, "dr_real")),
           (int)json_integer_value(json_object_get(result, "bx")));
    json_object_foreach(json_object_get(result, "calls"), name, call)
        printf("%s: %" JSON_INTEGER_FORMAT " instructions, at most %" JSON_INTEGER_FORMAT "\n", name,
               json_integer_value(json_object_get(call, "last")), json_integer_value(json_object_get(call, "most")));
    json_array_foreach(json_object_get(result, "waits"), i, line)
        printf("%s waits in line %" JSON_INTEGER_FORMAT "\n", json_string_value(json_object_get(line, "name")),
               json_integer_value(json_object_get(line, "line")));
    if (json_is_integer(halted))
        printf("halted in line %" JSON_INTEGER_FORMAT "\n", json_integer_value(halted));
    json_array_foreach(json_object_get(result, "listing"), i, line) {
        const json_t *value = json_object_get(line, "value");
        char *shown = value ? json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(9)) : NULL;
        const json_int_t number = json_integer_value(json_object_get(line, "line"));
        printf("%6" JSON_INTEGER_FORMAT " %c %12s  %s\n", number, waits_in(result, number) ? '>' : ' ', shown ? shown : "",
               json_string_value(json_object_get(line, "text")));
        free(shown);
    }
}

static enum exit_status show_plc(struct client_job *job)
{
    uint64_t first = 1, lines = LISTING_LINES;
    if (job->count > 3 || (job->count > 1 && !number_read(job->words[1], 1, INT32_MAX, &first)) ||
        (job->count > 2 && !number_read(job->words[2], 0, LISTING_LINES, &lines)))
        return client_usage("cnc plc: expected the first line and how many, at most %d, as in `cnc plc 20 30'", LISTING_LINES);
    return client_job_show(job, "cnc.plc", json_pack("{s:I, s:I}", "first", (json_int_t)first, "lines", (json_int_t)lines),
                           print_listing);
}

/* ---- Texts -------------------------------------------------------------------------------------------------------------- */

/* What the end of a file's name says that it is: the parameters of cnc.load. */
static const struct {
    const char *end, *key, *name_key;
} text_kinds[] = {{".plc", "plc", "plc_name"}, {".yaml", "machine", "machine_name"}, {".yml", "machine", "machine_name"},
                  {".xml", "config", NULL},    {"", "text", "name"}};

static size_t find_text_kind(const char *file)
{
    size_t at = 0, length = strlen(file);
    while (length < strlen(text_kinds[at].end) || strcmp(file + length - strlen(text_kinds[at].end), text_kinds[at].end) != 0)
        at++;
    return at;
}

/* Read a file into the parameters of cnc.load. */
static enum exit_status add_text(json_t *params, const char *file)
{
    struct program_text text;
    const size_t kind = find_text_kind(file);
    if (text_kinds[kind].name_key == NULL)
        return client_usage("cnc load: the configuration of a machine that runs stays: end the emulator and start it with "
                            "--config %s", file);
    if (json_object_get(params, text_kinds[kind].key) != NULL)
        return client_usage("cnc load: %s: expected one file of a kind", file);
    const char *wrong = program_text_read(&text, file);
    if (wrong != NULL)
        warnx("cannot read %s: %s", file, wrong);
    json_t *content = wrong == NULL ? json_stringn(text.text, text.length) : NULL;
    if (wrong == NULL && content == NULL)
        warnx("%s: expected UTF-8", file);
    program_text_free(&text);
    if (content == NULL)
        return STATUS_FAILURE;
    json_object_set_new(params, text_kinds[kind].key, content);
    json_object_set_new(params, text_kinds[kind].name_key, json_string(file));
    return STATUS_SUCCESS;
}

static enum exit_status load(struct client_job *job)
{
    json_t *params = json_object();
    enum exit_status status = job->count > 1 ? STATUS_SUCCESS : client_usage("cnc load: expected FILE..., - is standard input");
    for (size_t i = 1; i < job->count && status == STATUS_SUCCESS; i++)
        status = add_text(params, job->words[i]);
    if (status == STATUS_SUCCESS)
        return client_job_show(job, "cnc.load", params, NULL);
    json_decref(params);
    return status;
}

enum exit_status client_control_cnc(struct client_job *job)
{
    static const struct {
        const char *name;
        client_job_function *function;
    } parts[] = {{"get", get_cells}, {"set", set_cells}, {"cells", list_cells}, {"start", press}, {"stop", press},
                 {"reset", press},   {"jog", jog},       {"home", home},        {"panel", work_panel}, {"load", load},
                 {"plc", show_plc}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (strcmp(job->words[0], parts[i].name) == 0)
            return parts[i].function(job);
    return client_usage("cnc: expected get, set, cells, start, stop, reset, jog, home, panel, load or plc, found '%s'",
                        job->words[0]);
}
