/* SPDX-License-Identifier: MIT */
/* The report of coverage.h: for people, as JSON, and into files. */
#include "coverage.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "log.h"

#define JSON_ENDING ".json"

static double per_cent(struct coverage_sum sum)
{
    return sum.total == 0 ? 0.0 : 1000 * sum.covered / sum.total / 10.0;
}

const char *coverage_group_name(enum coverage_group group)
{
    static const char *const names[] = {"messages", "motors", "commands", "flags", "errors", "faults", "all"};
    return names[group <= COVERAGE_GROUPS ? group : COVERAGE_GROUPS];
}

double coverage_percent(const struct coverage *coverage)
{
    return per_cent(coverage_sum(coverage, COVERAGE_GROUPS));
}

/* ---- For people ----------------------------------------------------------------------------------------------------- */

static void print_items(const struct coverage *coverage, bool covered, FILE *out)
{
    fprintf(out, "\n%s\n", covered ? "covered (how often)" : "missing");
    size_t printed = 0;
    for (size_t i = 0; i < coverage->items; i++) {
        const struct coverage_item *item = &coverage->item[i];
        const char *group = coverage_group_name((enum coverage_group)item->group);
        if ((item->count > 0) != covered)
            continue;
        printed++;
        if (covered)
            fprintf(out, "  %-10s%-40s%12" PRIu64 "\n", group, item->name, item->count);
        else
            fprintf(out, "  %-10s%s\n", group, item->name);
    }
    if (printed == 0)
        fprintf(out, "  nothing\n");
}

void coverage_print(const struct coverage *coverage, FILE *out)
{
    fprintf(out, "%-12s%8s%8s%8s\n", "protocol", "covered", "of", "%");
    for (unsigned group = 0; group <= COVERAGE_GROUPS; group++) {
        struct coverage_sum sum = coverage_sum(coverage, (enum coverage_group)group);
        const char *name = coverage_group_name((enum coverage_group)group);
        fprintf(out, "%-12s%8u%8u%8.1f\n", name, sum.covered, sum.total, per_cent(sum));
    }
    print_items(coverage, false, out);
    print_items(coverage, true, out);
}

/* ---- JSON ------------------------------------------------------------------------------------------------------------- */

static json_t *items_json(const struct coverage *coverage, enum coverage_group group)
{
    json_t *items = json_array();
    for (size_t i = 0; items != NULL && i < coverage->items; i++) {
        const struct coverage_item *item = &coverage->item[i];
        if (item->group != group)
            continue;
        json_t *entry = json_pack("{s:s, s:I}", "name", item->name, "count", (json_int_t)item->count);
        if (json_array_append_new(items, entry) != 0) {
            json_decref(items);
            items = NULL;
        }
    }
    return items;
}

json_t *coverage_json(const struct coverage *coverage)
{
    json_t *groups = json_array();
    for (unsigned group = 0; groups != NULL && group < COVERAGE_GROUPS; group++) {
        struct coverage_sum sum = coverage_sum(coverage, (enum coverage_group)group);
        json_t *items = items_json(coverage, (enum coverage_group)group);
        json_t *entry = json_pack("{s:s, s:i, s:i, s:o}", "group", coverage_group_name((enum coverage_group)group), "covered",
                                  (int)sum.covered, "total", (int)sum.total, "items", items);
        if (json_array_append_new(groups, entry) != 0) {
            json_decref(groups);
            groups = NULL;
        }
    }
    struct coverage_sum all = coverage_sum(coverage, COVERAGE_GROUPS);
    return json_pack("{s:i, s:i, s:f, s:o}", "covered", (int)all.covered, "total", (int)all.total, "percent", per_cent(all),
                     "groups", groups);
}

/* ---- Files ------------------------------------------------------------------------------------------------------------ */

static bool ends_in_json(const char *file)
{
    size_t length = strlen(file), ending = strlen(JSON_ENDING);
    return length >= ending && strcmp(file + length - ending, JSON_ENDING) == 0;
}

/* The name of the JSON beside the text `file`. Returns NULL if memory is short; to be freed. */
static char *json_name(const char *file)
{
    char *name = malloc(strlen(file) + sizeof JSON_ENDING);
    if (name != NULL)
        strcat(strcpy(name, file), ends_in_json(file) ? "" : JSON_ENDING);
    return name;
}

static bool print_json(const struct coverage *coverage, FILE *out)
{
    json_t *object = coverage_json(coverage);
    bool well = object != NULL && json_dumpf(object, out, JSON_INDENT(2) | JSON_REAL_PRECISION(4)) == 0;
    well = fputc('\n', out) != EOF && well;
    json_decref(object);
    return well;
}

/* Write one file, or, with no `coverage`, see that it can be written. Reports what goes wrong. */
static bool write_one(const struct coverage *coverage, const char *name, bool json)
{
    errno = 0;
    FILE *out = name == NULL ? NULL : fopen(name, coverage == NULL ? "a" : "w");
    bool well = out != NULL;
    if (well && coverage != NULL && json)
        well = print_json(coverage, out);
    else if (well && coverage != NULL)
        coverage_print(coverage, out);
    if (out != NULL) {
        well = !ferror(out) && well;
        well = fclose(out) == 0 && well;
    }
    if (!well)
        log_error("cannot write the coverage to %s: %s", name == NULL ? "a file" : name, strerror(errno ? errno : ENOMEM));
    return well;
}

static bool write_both(const struct coverage *coverage, const char *file)
{
    char *json = json_name(file);
    bool well = ends_in_json(file) || write_one(coverage, file, false);
    well = write_one(coverage, json, true) && well;
    free(json);
    return well;
}

bool coverage_write(const struct coverage *coverage, const char *file)
{
    return write_both(coverage, file);
}

bool coverage_try(const char *file)
{
    return write_both(NULL, file);
}
