/* SPDX-License-Identifier: MIT */
/* rkm04 explain: programs in words. */
#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include <jansson.h>

#include "explain.h"
#include "options/options.h"
#include "program_tools.h"
#include "tool_files.h"

enum option_key { KEY_LANG = 256 };

struct options {
    struct tool_files files;
    enum explain_language language;
    bool json;
};

static const struct argp_option option_table[] = {
    {"lang", KEY_LANG, "LANGUAGE", 0, "en (the default) or cs, the manual's terms", 0},
    {"json", 'j', NULL, 0, "Print as JSON", 0},
    {0},
};

static const char doc[] =
    "Describe in words what programs of the RKM04 do, command by command. For each motion, the parameters are shown that are "
    "the same on all paths to it. FILE is a program text (.rks), - standard input; M is its motor, 1 to 4 or 0 for all; without "
    "it 1."
    "\v"
    "Examples:\n"
    "  rkm04 explain drill.rks\n"
    "  rkm04 explain --lang cs drill.rks\n"
    "\n"
    "Exit status: 0 success; 1 the unit would refuse a text (see rkm04 check), or a file could not be read; 2 wrong usage.";

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case KEY_LANG:
        options->language = explain_language_named(text);
        if (options->language == EXPLAIN_LANGUAGES)
            argp_error(state, "--lang: expected en or cs, found '%s'", text);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case ARGP_KEY_ARG:
        tool_files_add(&options->files, text, state);
        return 0;
    case ARGP_KEY_END:
        if (options->files.count == 0)
            argp_error(state, "no program given");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Columns of a text in UTF-8. */
static int columns_of(const char *text, size_t length)
{
    int columns = 0;
    for (size_t at = 0; at < length; at += text_character_length(text, length, at))
        columns++;
    return columns;
}

static void print_text(const struct explanations *all, const struct program_source *sources)
{
    for (size_t i = 0; i < all->count; i++) {
        const struct explanation *one = &all->list[i];
        const char *command = sources[one->source].text + one->offset;
        const int columns = columns_of(command, one->length);
        printf("%s:%zu:%zu: ", sources[one->source].name, one->line, one->column);
        for (size_t at = 0; at < one->length; at++)
            putchar((unsigned char)command[at] < ' ' ? ' ' : command[at]);
        printf("%*s  %s\n", columns < 8 ? 8 - columns : 0, "", one->text);
    }
}

static void print_json(const struct explanations *all, const struct program_source *sources)
{
    json_t *array = json_array();
    for (size_t i = 0; i < all->count; i++) {
        const struct explanation *one = &all->list[i];
        json_t *name = json_string(sources[one->source].name);
        json_array_append_new(array, json_pack("{s:o, s:I, s:I, s:I, s:I, s:s}", "file",
                                               name != NULL ? name : json_string("?"), "line", (json_int_t)one->line, "column",
                                               (json_int_t)one->column, "offset", (json_int_t)one->offset, "length",
                                               (json_int_t)one->length, "text", one->text));
    }
    json_dumpf(array, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(array);
}

static int explain_files(struct options *options)
{
    struct tool_files *files = &options->files;
    struct program_source *sources = calloc(files->count + 1, sizeof *sources);
    struct explanations all = {0};
    bool ok = sources != NULL;
    for (size_t i = 0; sources != NULL && i < files->count; i++) {
        ok = tool_file_read(&files->list[i], "rkm04 explain") && ok;
        sources[i] = files->list[i].source;
    }
    ok = ok && tool_check_errors(sources, files->count, &(struct rkm04_readings){0});
    if (ok && !explain_programs(sources, files->count, options->language, &all)) {
        fputs("rkm04 explain: out of memory\n", stderr);
        ok = false;
    }
    if (ok && options->json)
        print_json(&all, sources);
    else if (ok)
        print_text(&all, sources);
    explain_free(&all);
    free(sources);
    return ok ? STATUS_SUCCESS : STATUS_FAILURE;
}

int explain_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, "[M=]FILE...", doc, NULL, NULL, NULL};
    struct options options = {.language = EXPLAIN_ENGLISH};
    tool_files_begin(&options.files, argc);
    arguments_parse(&argp, argc, argv, &options);
    int status = explain_files(&options);
    tool_files_end(&options.files);
    return arguments_printed() != 0 ? STATUS_FAILURE : status;
}
