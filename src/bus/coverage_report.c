/* SPDX-License-Identifier: MIT */
/* The report of coverage.h: for people, as JSON, and into files. */
#include "device/device.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "file/file.h"
#include "line/line.h"

#define JSON_ENDING ".json"

static double percent_of(struct coverage_sum sum)
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
    return percent_of(coverage_sum(coverage, COVERAGE_GROUPS));
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
        fprintf(out, "%-12s%8u%8u%8.1f\n", name, sum.covered, sum.total, percent_of(sum));
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
    return json_pack("{s:i, s:i, s:f, s:o}", "covered", (int)all.covered, "total", (int)all.total, "percent", percent_of(all),
                     "groups", groups);
}

/* ---- Files ------------------------------------------------------------------------------------------------------------ */

static bool ends_in_json(const char *file)
{
    size_t length = strlen(file), ending = strlen(JSON_ENDING);
    return length >= ending && strcmp(file + length - ending, JSON_ENDING) == 0;
}

static bool print_json(const struct coverage *coverage, FILE *out)
{
    json_t *object = coverage_json(coverage);
    bool ok = object != NULL && json_dumpf(object, out, JSON_INDENT(2) | JSON_REAL_PRECISION(4)) == 0;
    ok = fputc('\n', out) != EOF && ok;
    json_decref(object);
    return ok;
}

static bool open_file(FILE **out, const char *name, const struct output_kind *kind, unsigned flags)
{
    char *why = NULL;
    *out = name ? output_file_open(name, kind, flags | OUTPUT_KEEP, &why) : NULL;
    if (!*out)
        log_error("cannot write the coverage to %s: %s", name ? name : "a file", why ? why : strerror(ENOMEM));
    free(why);
    return *out != NULL;
}

bool coverage_open(struct coverage_files *files, const char *file, unsigned flags)
{
    *files = (struct coverage_files){0};
    if (ends_in_json(file)) {
        files->json_name = strdup(file);
    } else {
        files->text_name = strdup(file);
        if (asprintf(&files->json_name, "%s" JSON_ENDING, file) < 0)
            files->json_name = NULL;
        if (!open_file(&files->text, files->text_name, &output_coverage, flags))
            return false;
    }
    return open_file(&files->json, files->json_name, &output_coverage_json, flags);
}

/* Write and close one file. Reports what goes wrong. */
static bool write_file(const struct coverage *coverage, FILE **file, const char *name, bool json)
{
    FILE *out = *file;
    *file = NULL;
    if (!out)
        return true;
    errno = 0;
    bool ok = output_file_empty(out);
    if (ok && json)
        ok = print_json(coverage, out);
    else if (ok)
        coverage_print(coverage, out);
    ok = !ferror(out) && ok;
    ok = output_file_close(out) == 0 && ok;
    if (!ok)
        log_error("cannot write the coverage to %s: %s", name, strerror(errno ? errno : ENOMEM));
    return ok;
}

bool coverage_write(const struct coverage *coverage, struct coverage_files *files)
{
    bool ok = write_file(coverage, &files->text, files->text_name, false);
    return write_file(coverage, &files->json, files->json_name, true) && ok;
}

void coverage_close(struct coverage_files *files)
{
    if (files->text)
        output_file_close(files->text);
    if (files->json)
        output_file_close(files->json);
    free(files->text_name);
    free(files->json_name);
    *files = (struct coverage_files){0};
}
