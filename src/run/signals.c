/* SPDX-License-Identifier: MIT */
/* rkm04 signals: the cells between CNC system and PLC program of a CNC872. */
#include <argp.h>
#include <stdio.h>

#include <jansson.h>

#include "cnc872/cnc872.h"
#include "options/options.h"
#include "print_json.h"
#include "run.h"

enum { KEY_JSON = 256 };

/* A line of the list: a row of the table, or a field of a row. */
struct signal {
    const struct cnc_row *row;
    const struct cnc_field *field; /* NULL: the row itself */
    bool is_in_queue;
};

static error_t read_option(int key, char *text, struct argp_state *state)
{
    bool *is_json = state->input;
    if (key == KEY_JSON)
        *is_json = true;
    else if (key == ARGP_KEY_ARG)
        argp_error(state, "`%s': expected options only", text);
    else
        return ARGP_ERR_UNKNOWN;
    return 0;
}

/* ---- Texts ----------------------------------------------------------------------------------------------------------- */

static void name_signal(const struct signal *signal, char name[static 64])
{
    snprintf(name, 64, "%s%s%s%s", signal->is_in_queue ? "BLK[n]." : "", signal->row->name, signal->field ? "." : "",
             signal->field ? signal->field->name : "");
}

/* "DWRD[6]", "BIT X..16", "BIT 1..14" */
static void describe_type(const struct signal *signal, char text[static 32])
{
    const struct cnc_row *row = signal->row;
    unsigned last = row->first + row->count - 1u;
    if (signal->field)
        snprintf(text, 32, "%s", cnc_type_name[signal->field->type]);
    else if (row->numbering == CNC_BY_AXIS)
        snprintf(text, 32, "BIT X..%s", cnc_axis_names[row->count - 1]);
    else if (row->numbering == CNC_BY_NUMBER)
        snprintf(text, 32, "BIT %d..%u", row->first, last);
    else if (row->count > 1 && row->type != CNC_STRUCTURE)
        snprintf(text, 32, "%s[%u]", cnc_type_name[row->type], row->count);
    else
        snprintf(text, 32, "%s", cnc_type_name[row->type]);
}

static void print_line(const struct signal *signal, void *context)
{
    const struct cnc_row *row = signal->row;
    char name[64], type[32], preset[16] = "-";
    (void)context;
    name_signal(signal, name);
    describe_type(signal, type);
    if (!signal->is_in_queue && !signal->field)
        snprintf(preset, sizeof preset, "%u", row->preset);
    printf("%-31s %-11s %-6s %-6s %s\n", name, type, row->writable ? "rw" : "r", preset, row->section);
}

static void add_json(const struct signal *signal, void *context)
{
    const struct cnc_row *row = signal->row;
    char name[64];
    name_signal(signal, name);
    unsigned type = signal->field ? signal->field->type : row->type;
    int count = signal->field ? 1 : row->count;
    json_t *object = json_pack("{s:s, s:s, s:i, s:s, s:s}", "name", name, "type", cnc_type_name[type], "count", count, "access",
                               row->writable ? "rw" : "r", "section", row->section);
    if (row->numbering == CNC_BY_AXIS)
        json_object_set_new(object, "last_axis", json_string(cnc_axis_names[row->count - 1]));
    if (row->numbering == CNC_BY_NUMBER)
        json_object_set_new(object, "first", json_integer(row->first));
    if (!signal->is_in_queue && !signal->field)
        json_object_set_new(object, "preset", json_integer(row->preset));
    json_array_append_new(context, object);
}

/* ---- The list -------------------------------------------------------------------------------------------------------- */

/* Calls show() for each cell with its fields, then for each field of a block. */
static void list_signals(void (*show)(const struct signal *signal, void *context), void *context)
{
    for (unsigned i = 0; i < cnc_row_count; i++) {
        show(&(struct signal){&cnc_rows[i], NULL, false}, context);
        for (unsigned field = 0; field < cnc_field_count; field++)
            if (cnc_rows[i].fields != CNC_FIELDS_NONE && cnc_rows[i].fields == cnc_fields[field].fields)
                show(&(struct signal){&cnc_rows[i], &cnc_fields[field], false}, context);
    }
    for (unsigned i = 0; i < CNC_QUEUE_FIELDS; i++)
        show(&(struct signal){&cnc_queue_rows[i], NULL, true}, context);
}

static int print_json(void)
{
    json_t *list = json_array();
    list_signals(add_json, list);
    return print_json_list(list, "rkm04 signals");
}

int signals_main(int argc, char **argv)
{
    static const struct argp_option table[] = {{"json", KEY_JSON, NULL, 0, "As a JSON array of objects", 0}, {0}};
    static const struct argp argp = {
        .options = table,
        .parser = read_option,
        .doc = "List the cells of the interface between CNC system and PLC program that a CNC872 has, a line each: name, type, "
               "access of the PLC program (r: read, rw: read and write), preset, section of the maker's guide to PLC programs "
               "(own: it is this program's). In a name, x is an axis, X, Y, Z or 4 to 16, and n a number; BLK[n] is a block of "
               "the queue, 0 the present one."
               "\v"
               "Examples:\n"
               "  rkm04 signals\n"
               "  rkm04 signals --json\n"
               "\n"
               "Exit status: 0 success, 1 standard output cannot be written, 2 wrong usage.",
    };
    bool is_json = false;
    arguments_parse(&argp, argc, argv, &is_json);
    if (is_json)
        return print_json();
    printf("%-31s %-11s %-6s %-6s %s\n", "name", "type", "access", "preset", "section");
    list_signals(print_line, NULL);
    return arguments_printed();
}
