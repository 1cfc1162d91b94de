/* SPDX-License-Identifier: MIT */
/* rkm04 check: what is wrong with programs. */
#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "check_cnc.h"
#include "check_print.h"
#include "options/options.h"
#include "program_tools.h"
#include "tool_files.h"

enum option_key { KEY_NO_WARN = 256, KEY_WERROR, KEY_FORMAT, KEY_READINGS, KEY_LIST, KEY_PLANT, KEY_CONFIG };

struct options {
    struct tool_files files;
    struct check_options check;
    readings_set named;
    enum check_format format;
    const char *plant;
    struct tool_file config;   /* path NULL: none */
    struct cnc_config machine; /* of NC programs */
    bool werror, list;
};

static const struct argp_option option_table[] = {
    {"no-warn", KEY_NO_WARN, "NAME,...", 0, "Switch warnings off; `all' switches off all of them", 0},
    {"werror", KEY_WERROR, NULL, 0, "Exit status 1 also for warnings", 0},
    {"format", KEY_FORMAT, "FORMAT", 0, "Print as " CHECK_FORMAT_NAMES, 0},
    {"json", 'j', NULL, 0, "The same as --format json", 0},
    {"plant", KEY_PLANT, "FILE", 0, "Simulated mechanics (docs/PLANT.md): also check waits for inputs that they drive", 0},
    {"config", KEY_CONFIG, "FILE", 0, "Machine of a CNC872 (docs/CNC872.md) for which NC programs are; default axes X, Y, Z", 0},
    {"list", KEY_LIST, NULL, 0, "List the warnings with a description of each", 0},
    {"readings", KEY_READINGS, "NAME=VALUE,...", 0, READINGS_OPTION_HELP, 0},
    {0},
};

static const char doc[] =
    "Check programs of the RKM04: report everything that a unit would refuse, and warn about commands that it accepts but that "
    "are probably wrong. FILE is a program text (.rks), - standard input. Files given as M=FILE are the programs of one unit, M "
    "is the motor, 1 to 4 or 0 for all; a warning is then also given if motors wait for each other. Each other file is checked "
    "by itself.\n"
    "FILE may also be a text of a CNC872: a configuration (.xml), an NC program (.nc) or a PLC program (.plc)."
    "\v"
    "The comment {nolint NAME NAME} switches warnings off for its line, or for the next line if it is alone on its line; "
    "{nolint-file NAME} switches one off for the whole text. docs/CHECK.md describes each warning.\n"
    "\n"
    "Examples:\n"
    "  rkm04 check drill.rks\n"
    "  rkm04 check 1=x.rks 2=y.rks\n"
    "  rkm04 check --werror --no-warn speed-not-reached *.rks\n"
    "  rkm04 check --format sarif *.rks >check.sarif\n"
    "  rkm04 check --config mill.xml mill.plc part.nc\n"
    "\n"
    "Exit status: 0 no error; 1 an error, with --werror also a warning, or a file could not be read; 2 wrong usage.";

void no_warn_option_read(uint64_t *off, const char *text, struct argp_state *state)
{
    while (*text != '\0') {
        const size_t length = strcspn(text, ",");
        const enum check_warning warning = check_warning_named(text, length);
        if (warning < CHECK_WARNINGS)
            *off |= UINT64_C(1) << warning;
        else if (length == 3 && strncmp(text, "all", 3) == 0)
            *off = UINT64_MAX;
        else {
            char name[64];
            snprintf(name, sizeof name, "%.*s", (int)length, text);
            argp_error(state, "--no-warn: unknown warning `%s' (--list shows all)%s", name,
                       nearest_hint(name, check_warning_names()));
        }
        text += length + (text[length] == ',');
    }
}

static bool is_yaml(const char *name)
{
    const char *end = strrchr(name, '.');
    return end != NULL && (strcmp(end, ".yaml") == 0 || strcmp(end, ".yml") == 0);
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case KEY_NO_WARN:
        no_warn_option_read(&options->check.off, text, state);
        return 0;
    case KEY_WERROR:
        options->werror = true;
        return 0;
    case KEY_FORMAT:
        options->format = check_format_named(text);
        if (options->format == CHECK_FORMATS)
            argp_error(state, "--format: expected " CHECK_FORMAT_NAMES ", found '%s'%s", text,
                       nearest_hint(text, CHECK_FORMAT_NAMES));
        return 0;
    case 'j':
        options->format = CHECK_JSON;
        return 0;
    case KEY_PLANT:
        options->plant = text;
        return 0;
    case KEY_CONFIG:
        options->config = (struct tool_file){.path = text, .source.name = text};
        return 0;
    case KEY_LIST:
        options->list = true;
        return 0;
    case KEY_READINGS:
        readings_option_read(&options->check.readings, &options->named, text, state);
        return 0;
    case ARGP_KEY_ARG:
        if (is_yaml(text))
            argp_error(state, "%s: expected a program; `rkm04 test' runs scenarios, and plants and switches are checked by the "
                              "commands that take them", text);
        tool_files_add(&options->files, text, state);
        return 0;
    case ARGP_KEY_END:
        if (options->files.count == 0 && !options->list)
            argp_error(state, "no program given");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static int print_list(void)
{
    for (unsigned i = 0; i < CHECK_WARNINGS; i++)
        printf("%-20s %s\n", check_warning_name((enum check_warning)i), check_warning_text((enum check_warning)i));
    return arguments_printed();
}

/* Check sources that belong together. */
static bool check_some(struct check_printer *printer, const struct options *options, const struct program_source *sources,
                       size_t count)
{
    struct diagnostics found;
    bool ok = check_programs(sources, count, &options->check, &found);
    check_print(printer, sources, &found);
    const bool bad_plant = found.bad_plant;
    diagnostics_free(&found);
    if (!ok)
        fputs("rkm04 check: out of memory\n", stderr);
    return ok && !bad_plant;
}

/* Check a text of a CNC872. */
static bool check_cnc_file(struct check_printer *printer, const struct program_source *source, struct cnc_config *machine)
{
    struct diagnostics found;
    const bool ok = check_cnc(source, machine, &found);
    check_print(printer, source, &found);
    diagnostics_free(&found);
    if (!ok)
        fputs("rkm04 check: out of memory\n", stderr);
    return ok;
}

/* The machine of NC programs: that of --config, whose errors are reported, or X, Y, Z. */
static bool read_machine(struct check_printer *printer, struct options *options)
{
    cnc_config_clear(&options->machine);
    if (options->config.path == NULL)
        return true;
    const bool ok = tool_file_read(&options->config, "rkm04 check") &&
                    check_cnc_file(printer, &options->config.source, &options->machine);
    tool_file_free(&options->config);
    return ok;
}

/* Check a file without a motor by itself. */
static bool check_file(struct check_printer *printer, const struct options *options, const struct program_source *source)
{
    if (!check_cnc_takes(source->name))
        return check_some(printer, options, source, 1);
    struct cnc_config machine = options->machine;
    return check_cnc_file(printer, source, &machine);
}

/* Check each file without a motor by itself, then those with one together. Returns false if something could not be done. */
static bool check_files(struct check_printer *printer, struct options *options)
{
    struct tool_files *files = &options->files;
    struct program_source *together = calloc(files->count + 1, sizeof *together);
    size_t count = 0;
    bool ok = together != NULL;
    for (size_t i = 0; together != NULL && i < files->count; i++) {
        struct tool_file *file = &files->list[i];
        if (!tool_file_read(file, "rkm04 check")) {
            ok = false;
        } else if (file->has_motor) {
            together[count++] = file->source;
            continue;
        } else {
            ok = check_file(printer, options, &file->source) && ok;
        }
        tool_file_free(file);
    }
    if (count > 0)
        ok = check_some(printer, options, together, count) && ok;
    free(together);
    return ok;
}

/* Read the file of --plant. Returns false if that is not possible, which is reported. */
static bool read_plant(struct options *options, struct program_text *plant)
{
    *plant = (struct program_text){0};
    if (options->plant == NULL)
        return true;
    const char *wrong = program_text_read_raw(plant, options->plant);
    if (wrong != NULL)
        fprintf(stderr, "rkm04 check: cannot read %s: %s\n", options->plant, wrong);
    options->check.plant = plant->text;
    options->check.plant_length = plant->length;
    options->check.plant_name = options->plant;
    options->check.errors = stderr;
    return wrong == NULL;
}

int check_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, "[M=]FILE...", doc, NULL, NULL, NULL};
    struct options options = {.format = CHECK_TEXT};
    struct check_printer printer;
    struct program_text plant;
    tool_files_begin(&options.files, argc);
    arguments_parse(&argp, argc, argv, &options);
    if (options.list) {
        tool_files_end(&options.files);
        return print_list();
    }
    check_print_begin(&printer, options.format, stdout);
    bool ok = read_plant(&options, &plant) && read_machine(&printer, &options) && check_files(&printer, &options);
    ok = check_print_end(&printer) && ok;
    program_text_free(&plant);
    tool_files_end(&options.files);
    if (arguments_printed() != 0)
        return STATUS_FAILURE;
    return !ok || printer.errors > 0 || (options.werror && printer.warnings > 0) ? STATUS_FAILURE : STATUS_SUCCESS;
}
