/* SPDX-License-Identifier: MIT */
/* rkm04 fmt: program texts in their canonical layout. */
#include <argp.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <jansson.h>

#include "format.h"
#include "options/options.h"
#include "program_tools.h"
#include "text_diff.h"
#include "text_replace.h"
#include "tool_files.h"

enum option_key { KEY_CHECK = 256, KEY_DIFF };

struct options {
    struct tool_files files;
    bool check, diff, json;
};

static const struct argp_option option_table[] = {
    {"check", KEY_CHECK, NULL, 0, "Change nothing; exit status 1 if a file would change", 0},
    {"diff", KEY_DIFF, NULL, 0, "Change nothing; print what would change, as diff -u does", 0},
    {"json", 'j', NULL, 0, "Change nothing; print the texts as JSON", 0},
    {0},
};

static const char doc[] =
    "Format programs of the RKM04: labels start at the margin, loops and subroutines are indented, and a line ends after a "
    "motion, a wait or a jump. Numbers are written as the unit writes them; comments and commands do not change. Files are "
    "changed in place; - reads standard input and writes standard output."
    "\v"
    "Examples:\n"
    "  rkm04 fmt drill.rks\n"
    "  rkm04 fmt --check *.rks\n"
    "  rkm04 fmt - <drill.rks\n"
    "\n"
    "Exit status: 0 success; 1 a file has an error (see rkm04 check), could not be read or written, or would change with "
    "--check; 2 wrong usage.";

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case KEY_CHECK:
        options->check = true;
        return 0;
    case KEY_DIFF:
        options->diff = true;
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
        if (options->json && (options->diff || options->check))
            argp_error(state, "--json cannot be combined with --check or --diff");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static bool add_json(const char *name, const char *text, size_t length, bool changed, json_t *all)
{
    json_t *one = json_pack("{s:s, s:b, s:s%}", "file", name, "changed", changed, "text", text, length);
    if (one == NULL)
        fprintf(stderr, "rkm04 fmt: %s is not UTF-8, which --json needs\n", name);
    return one != NULL && json_array_append_new(all, one) == 0;
}

/* Do with a laid out text what the options say. Returns whether that worked; *changed: it is another one. */
static bool use(const struct options *options, const struct tool_file *file, const char *text, size_t length, json_t *all,
                bool *changed)
{
    const struct program_source *source = &file->source;
    const bool from_stdin = strcmp(file->path, "-") == 0;
    *changed = length != source->length || (length > 0 && memcmp(text, source->text, length) != 0);
    if (options->json)
        return add_json(source->name, text, length, *changed, all);
    if (options->diff && *changed)
        return text_diff(source->name, source->text, source->length, text, length);
    if (options->check && *changed)
        printf("%s would change\n", source->name);
    if (options->check || options->diff)
        return true;
    if (from_stdin)
        return fwrite(text, 1, length, stdout) == length;
    const char *wrong = *changed ? text_replace(file->path, text, length) : NULL;
    if (wrong != NULL)
        fprintf(stderr, "rkm04 fmt: cannot write %s: %s\n", file->path, wrong);
    return wrong == NULL;
}

/* Returns the exit status. */
static int format_file(const struct options *options, struct tool_file *file, json_t *all)
{
    char *text;
    size_t length;
    bool changed = false;
    if (!tool_file_read(file, "rkm04 fmt"))
        return STATUS_FAILURE;
    switch (format_program(&file->source, &text, &length)) {
    case FORMAT_ERRORS:
        tool_check_errors(&file->source, 1, &(struct rkm04_readings){0});
        return STATUS_FAILURE;
    case FORMAT_NO_MEMORY:
        fputs("rkm04 fmt: out of memory\n", stderr);
        return STATUS_FAILURE;
    case FORMAT_DONE:
        break;
    }
    bool ok = use(options, file, text, length, all, &changed);
    free(text);
    return !ok || (options->check && changed) ? STATUS_FAILURE : STATUS_SUCCESS;
}

int fmt_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, "FILE...", doc, NULL, NULL, NULL};
    struct options options = {.json = false};
    int status = STATUS_SUCCESS;
    tool_files_begin(&options.files, argc);
    arguments_parse(&argp, argc, argv, &options);
    json_t *all = json_array();
    for (size_t i = 0; i < options.files.count; i++) {
        if (format_file(&options, &options.files.list[i], all) != STATUS_SUCCESS)
            status = STATUS_FAILURE;
        tool_file_free(&options.files.list[i]);
    }
    if (options.json) {
        json_dumpf(all, stdout, JSON_INDENT(2));
        putchar('\n');
    }
    json_decref(all);
    tool_files_end(&options.files);
    return arguments_printed() != 0 ? STATUS_FAILURE : status;
}
