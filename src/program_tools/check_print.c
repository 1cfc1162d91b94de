/* SPDX-License-Identifier: MIT */
#include "check_print.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "check.h"
#include "text/text.h"

static const char *const format_names[] = {"text", "json", "sarif", "github", "gcc"};

enum check_format check_format_named(const char *name)
{
    unsigned i = 0;
    while (i < CHECK_FORMATS && strcmp(format_names[i], name) != 0)
        i++;
    return (enum check_format)i;
}

static const char *severity_name(const struct diagnostic *one)
{
    return one->severity == DIAGNOSTIC_ERROR ? "error" : "warning";
}

/* ---- For people ----------------------------------------------------------------------------------------------------- */

#define LINE_SHOWN 160u /* bytes of a source line */

/* The line of the place, and a caret below it. Characters that would move the cursor are blanks. */
static void print_line(const struct diagnostic *one, const struct program_source *source, FILE *out)
{
    size_t begin = one->offset, at;
    size_t end = begin;
    while (begin > 0 && source->text[begin - 1] != '\n' && one->offset - begin < LINE_SHOWN / 2)
        begin--;
    while (end < source->length && source->text[end] != '\n' && end - begin < LINE_SHOWN)
        end++;
    fputs("  ", out);
    for (at = begin; at < end; at++)
        fputc((unsigned char)source->text[at] < ' ' || source->text[at] == 0x7F ? ' ' : source->text[at], out);
    fputs("\n  ", out);
    for (at = begin; at < one->offset; at += text_character_length(source->text, source->length, at))
        fputc(' ', out);
    fputc('^', out);
    if (at < end)
        at += text_character_length(source->text, source->length, at);
    for (; at < one->offset + one->length && at < end; at += text_character_length(source->text, source->length, at))
        fputc('~', out);
    fputc('\n', out);
}

static void print_text(const struct diagnostic *one, const struct program_source *source, FILE *out)
{
    fprintf(out, "%s:%zu:%zu: %s: %s [%s]\n", source->name, one->line, one->column, severity_name(one), one->message, one->name);
    print_line(one, source, out);
    if (one->hint != NULL)
        fprintf(out, "  hint: %s\n", one->hint);
}

static void print_gcc(const struct diagnostic *one, const struct program_source *source, FILE *out)
{
    fprintf(out, "%s:%zu:%zu: %s: %s%s%s [%s%s]\n", source->name, one->line, one->column, severity_name(one), one->message,
            one->hint != NULL ? "; " : "", one->hint != NULL ? one->hint : "", one->severity == DIAGNOSTIC_ERROR ? "" : "-W",
            one->name);
}

/* ---- Workflow commands of GitHub Actions ------------------------------------------------------------------------------ */

static void print_escaped(const char *text, bool property, FILE *out)
{
    for (; *text != '\0'; text++) {
        if (*text == '%' || *text == '\r' || *text == '\n' || (property && (*text == ':' || *text == ',')))
            fprintf(out, "%%%02X", (unsigned char)*text);
        else
            fputc(*text, out);
    }
}

static void print_github(const struct diagnostic *one, const struct program_source *source, FILE *out)
{
    fprintf(out, "::%s file=", severity_name(one));
    print_escaped(source->name, true, out);
    fprintf(out, ",line=%zu,col=%zu,title=%s::", one->line, one->column, one->name);
    print_escaped(one->message, false, out);
    if (one->hint != NULL) {
        fputs("; ", out);
        print_escaped(one->hint, false, out);
    }
    fputc('\n', out);
}

/* ---- JSON ----------------------------------------------------------------------------------------------------------- */

/* A string of a text that need not be UTF-8. */
static json_t *any_string(const char *text)
{
    json_t *string = json_string(text);
    char clean[512];
    size_t length = 0;
    if (string != NULL)
        return string;
    for (; *text != '\0' && length + 1 < sizeof clean; text++)
        clean[length++] = (unsigned char)*text >= 0x80 ? '?' : *text;
    clean[length] = '\0';
    return json_string(clean);
}

json_t *check_json(const struct diagnostic *one, const struct program_source *sources)
{
    return json_pack("{s:o, s:I, s:I, s:I, s:I, s:s, s:s, s:o, s:o}", "file", any_string(sources[one->source].name), "line",
                     (json_int_t)one->line, "column", (json_int_t)one->column, "offset", (json_int_t)one->offset, "length",
                     (json_int_t)one->length, "severity", severity_name(one), "name", one->name, "message",
                     any_string(one->message), "hint", one->hint == NULL ? json_null() : any_string(one->hint));
}

/* A file name as a URI. */
static json_t *uri_string(const char *name)
{
    char *uri = malloc(3 * strlen(name) + 1);
    size_t length = 0;
    if (uri == NULL)
        return NULL;
    for (; *name != '\0'; name++) {
        const unsigned char c = (unsigned char)*name;
        const bool plain = c < 0x80 && (isalnum(c) || strchr("-._~/", c) != NULL);
        length += (size_t)sprintf(uri + length, plain ? "%c" : "%%%02X", c);
    }
    uri[length] = '\0';
    json_t *string = json_string(uri);
    free(uri);
    return string;
}

static json_t *sarif_result(const struct diagnostic *one, const struct program_source *sources)
{
    char text[768];
    snprintf(text, sizeof text, "%s%s%s", one->message, one->hint != NULL ? "; " : "", one->hint != NULL ? one->hint : "");
    json_t *region = json_pack("{s:I, s:I, s:I, s:I}", "startLine", (json_int_t)one->line, "startColumn",
                               (json_int_t)one->column, "byteOffset", (json_int_t)one->offset, "byteLength",
                               (json_int_t)one->length);
    json_t *location = json_pack("{s:{s:{s:o}, s:o}}", "physicalLocation", "artifactLocation", "uri",
                                 uri_string(sources[one->source].name), "region", region);
    return json_pack("{s:s, s:s, s:{s:o}, s:[o]}", "ruleId", one->name, "level", severity_name(one), "message", "text",
                     any_string(text), "locations", location);
}

static json_t *sarif_rules(void)
{
    static const char *const errors[][2] = {
        {"bad-value", "a number is missing, out of range or too long"},
        {"unknown-command", "no command"},
        {"open-comment", "a comment that is never closed"},
        {"config-error", "an error in the configuration of a CNC872"},
        {"nc-error", "an error in an NC program"},
        {"plc-error", "an error in a PLC program"},
    };
    json_t *rules = json_array();
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++)
        json_array_append_new(rules, json_pack("{s:s, s:{s:s}}", "id", errors[i][0], "shortDescription", "text", errors[i][1]));
    for (unsigned i = 0; i < CHECK_WARNINGS; i++)
        json_array_append_new(rules, json_pack("{s:s, s:{s:s}}", "id", check_warning_name((enum check_warning)i),
                                               "shortDescription", "text", check_warning_text((enum check_warning)i)));
    return rules;
}

static json_t *sarif_log(json_t *results)
{
    return json_pack("{s:s, s:s, s:[{s:{s:{s:s, s:s, s:o}}, s:s, s:o}]}", "$schema",
                     "https://json.schemastore.org/sarif-2.1.0.json", "version", "2.1.0", "runs", "tool", "driver", "name",
                     "rkm04 check", "version", RKM04_VERSION, "rules", sarif_rules(), "columnKind", "unicodeCodePoints",
                     "results", results);
}

/* ---- All ------------------------------------------------------------------------------------------------------------ */

void check_print_begin(struct check_printer *printer, enum check_format format, FILE *out)
{
    *printer = (struct check_printer){.format = format, .out = out};
    if (format == CHECK_JSON || format == CHECK_SARIF)
        printer->array = json_array();
}

static void print_one(struct check_printer *printer, const struct diagnostic *one, const struct program_source *sources)
{
    const struct program_source *source = &sources[one->source];
    switch (printer->format) {
    case CHECK_TEXT:
        print_text(one, source, printer->out);
        break;
    case CHECK_GITHUB:
        print_github(one, source, printer->out);
        break;
    case CHECK_GCC:
        print_gcc(one, source, printer->out);
        break;
    default:
        if (json_array_append_new(printer->array, printer->format == CHECK_JSON ? check_json(one, sources)
                                                                                : sarif_result(one, sources)) != 0)
            printer->no_memory = true;
        break;
    }
}

void check_print(struct check_printer *printer, const struct program_source *sources, const struct diagnostics *found)
{
    for (size_t i = 0; i < found->count; i++)
        print_one(printer, &found->list[i], sources);
    if (found->errors + found->warnings > found->count && (printer->format == CHECK_TEXT || printer->format == CHECK_GCC))
        fprintf(printer->out, "%s: %zu more are not shown\n", sources[0].name, found->errors + found->warnings - found->count);
    printer->errors += found->errors;
    printer->warnings += found->warnings;
}

bool check_print_end(struct check_printer *printer)
{
    if (printer->array == NULL)
        return printer->format != CHECK_JSON && printer->format != CHECK_SARIF ? !printer->no_memory : false;
    json_t *all = printer->format == CHECK_SARIF ? sarif_log(printer->array)
                                                 : json_pack("{s:I, s:I, s:o}", "errors", (json_int_t)printer->errors, "warnings",
                                                             (json_int_t)printer->warnings, "diagnostics", printer->array);
    if (all == NULL || json_dumpf(all, printer->out, JSON_INDENT(2)) != 0)
        printer->no_memory = true;
    fputc('\n', printer->out);
    json_decref(all);
    return !printer->no_memory;
}
