/* SPDX-License-Identifier: MIT */
/* The names of a CNC872's cells, those of its PLC program with them, for a search by a part of a name. */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "cnc872_device.h"
#include "text/text.h"

#define NAME_SIZE 64u
#define LIMIT 100    /* names of an answer if nothing else is said */
#define LIMIT_MAX 1000

/* A search under way. */
struct search {
    const struct cnc_names *names; /* of the PLC program; NULL: there is none */
    uint32_t axes;                 /* those of the configuration, a bit each */
    const char *part;    /* of a name, letters in either case */
    const char *section; /* NULL: of any */
    json_t *found;
    json_int_t limit, more; /* more: found beyond the limit */
};

static bool has_part(const char *name, const char *part)
{
    const size_t length = strlen(part);
    for (; *name != '\0'; name++)
        if (strncasecmp(name, part, length) == 0)
            return true;
    return length == 0;
}

static void add(struct search *search, const char *name, unsigned type, bool is_writable, const char *section)
{
    if (!has_part(name, search->part) || (search->section && strcmp(section, search->section) != 0))
        return;
    if ((json_int_t)json_array_size(search->found) == search->limit) {
        search->more++;
        return;
    }
    json_array_append_new(search->found, json_pack("{s:s, s:s, s:s, s:s}", "name", name, "type", cnc_type_name[type], "access",
                                                   is_writable ? "rw" : "r", "section", section));
}

/* ---- Cells of the interface --------------------------------------------------------------------------------------------- */

static bool is_configured(const struct search *search, unsigned axis)
{
    return (search->axes >> axis & 1u) != 0;
}

/* "MPxPI", "ZMMnPI": a bit for each axis of the configuration, or each number. */
static void add_numbered(struct search *search, const struct cnc_row *row, const char *before)
{
    char name[NAME_SIZE], number[12];
    const char *mark = strchr(row->name, row->numbering == CNC_BY_AXIS ? 'x' : 'n');
    for (unsigned at = 0; at < row->count; at++) {
        if (row->numbering == CNC_BY_AXIS && !is_configured(search, at))
            continue;
        snprintf(number, sizeof number, "%u", row->first + at);
        snprintf(name, sizeof name, "%s%.*s%s%s", before, (int)(mark - row->name), row->name,
                 row->numbering == CNC_BY_AXIS ? cnc_axis_names[at] : number, mark + 1);
        add(search, name, row->type, row->writable, row->section);
    }
}

/* Elements of an array: of one a configured axis each, of others all up to sixteen, of longer ones the first. */
static void add_elements(struct search *search, const struct cnc_row *row, const char *before)
{
    char name[NAME_SIZE];
    const bool by_axis = row->count == CNC_AXES || row->count == 6;
    const unsigned count = row->count > CNC_AXES ? 1 : row->count;
    for (unsigned at = 0; at < count; at++) {
        snprintf(name, sizeof name, "%s%s[%u]", before, row->name, at);
        if (!by_axis || is_configured(search, at))
            add(search, name, row->type, row->writable, row->section);
    }
}

static void add_fields(struct search *search, const struct cnc_row *row)
{
    char name[NAME_SIZE];
    for (unsigned at = 0; at < cnc_field_count; at++) {
        if (cnc_fields[at].fields != row->fields)
            continue;
        snprintf(name, sizeof name, "%s.%s", row->name, cnc_fields[at].name);
        add(search, name, cnc_fields[at].type, row->writable, row->section);
    }
}

static void add_row(struct search *search, const struct cnc_row *row, const char *before)
{
    char name[NAME_SIZE];
    snprintf(name, sizeof name, "%s%s", before, row->name);
    if (row->numbering != CNC_PLAIN)
        add_numbered(search, row, before);
    else if (row->fields != CNC_FIELDS_NONE)
        add_fields(search, row);
    else if (row->count > 1)
        add_elements(search, row, before);
    else
        add(search, name, row->type, row->writable, row->section);
}

/* ---- Names of the PLC program ------------------------------------------------------------------------------------------- */

static void add_own(struct search *search)
{
    for (unsigned at = 0; search->names != NULL && at < search->names->count; at++) {
        const struct cnc_symbol *symbol = &search->names->symbols[at];
        if (symbol->kind == CNC_SYMBOL_BIT)
            add(search, symbol->name, CNC_BIT, true, symbol->is_mechanism ? "mechanism" : "program");
        else if (symbol->kind == CNC_SYMBOL_VARIABLE)
            add(search, symbol->name, symbol->type, true, "program");
    }
}

static void add_all(struct search *search)
{
    search->found = json_array();
    add_own(search);
    for (unsigned at = 0; at < cnc_row_count; at++)
        add_row(search, &cnc_rows[at], "");
    for (unsigned at = 0; at < CNC_QUEUE_FIELDS; at++)
        add_row(search, &cnc_queue_rows[at], "BLK[0].");
}

const char *cnc_nearest_cell(const struct cnc_names *names, const char *name, const struct cnc_text_fault *fault)
{
    if (strcmp(fault->reason, "there is no cell") != 0)
        return "";
    struct search search = {.names = names, .axes = UINT32_MAX, .part = "", .limit = INT32_MAX};
    char *list = NULL, wanted[NAME_SIZE];
    size_t size, at;
    const json_t *cell;
    add_all(&search);
    FILE *out = open_memstream(&list, &size);
    if (out != NULL) {
        json_array_foreach(search.found, at, cell)
            fprintf(out, "%s, ", json_string_value(json_object_get(cell, "name")));
        fclose(out);
    }
    json_decref(search.found);
    for (at = 0; name[at] != '\0' && at + 1u < sizeof wanted; at++)
        wanted[at] = (char)toupper((unsigned char)name[at]);
    wanted[at] = '\0';
    const char *hint = list ? nearest_hint(wanted, list) : "";
    free(list);
    return hint;
}

json_t *cnc_find_names(const struct cnc_device *device, const json_t *params, struct device_refusal *refusal)
{
    const json_t *part = json_object_get(params, "search"), *limit = json_object_get(params, "limit");
    const json_t *section = json_object_get(params, "section");
    const struct cnc_text *plc = device->own.text[CNC_TEXT_PLC];
    struct search search = {.names = plc ? &plc->plc->names : NULL,
                            .axes = device->cnc.config->axes,
                            .part = part ? json_string_value(part) : "",
                            .section = json_string_value(section),
                            .limit = limit ? json_integer_value(limit) : LIMIT};
    if (!search.part)
        return cnc_refuse(refusal, false, "search: expected a part of a name");
    if (section && !search.section)
        return cnc_refuse(refusal, false, "section: expected its name, as in \"8.1.12\", \"program\", \"mechanism\"");
    if (search.limit < 1 || search.limit > LIMIT_MAX)
        return cnc_refuse(refusal, false, "limit: expected a whole number from 1 to %d", LIMIT_MAX);
    add_all(&search);
    return json_pack("{s:o, s:I}", "cells", search.found, "more", search.more);
}
