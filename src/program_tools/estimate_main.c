/* SPDX-License-Identifier: MIT */
/* rkm04 estimate: how long programs take, how far and how fast they move. */
#include <argp.h>
#include <stdlib.h>
#include <string.h>

#include "estimate.h"
#include "estimate_print.h"
#include "options/options.h"
#include "program_tools.h"
#include "tool_files.h"

enum option_key { KEY_PLANT = 256, KEY_PASS_INPUTS, KEY_READINGS };

struct options {
    struct tool_files files;
    struct estimate_options estimate;
    const char *plant;
    readings_set named;
    bool json;
};

static const struct argp_option option_table[] = {
    {"plant", KEY_PLANT, "FILE", 0, "Simulated mechanics (docs/PLANT.md): limit switches act, collisions are reported", 0},
    {"pass-inputs", KEY_PASS_INPUTS, NULL, 0, "When all motors wait for inputs, set these inputs at once", 0},
    {"json", 'j', NULL, 0, "Print as JSON", 0},
    {"readings", KEY_READINGS, "NAME=VALUE,...", 0, READINGS_OPTION_HELP, 0},
    {0},
};

static const char doc[] =
    "Run programs of one unit in virtual time and print the steps, duration, peak speed and break points (as in Get Tabul Run) "
    "of each motion, and the total time; for an endless loop, the time of one round. M is the motor, 1 to 4 or 0 for all; "
    "without it 1. FILE is a program text (.rks), - standard input."
    "\v"
    "Examples:\n"
    "  rkm04 estimate drill.rks\n"
    "  rkm04 estimate 1=x.rks 2=y.rks --plant axes.yaml\n"
    "  rkm04 estimate --pass-inputs --json drill.rks\n"
    "\n"
    "Exit status: 0 success; 1 the unit would refuse a text (see rkm04 check), a motor stops with a fault or collides, motors "
    "wait for each other, or a file could not be read; 2 wrong usage.";

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case KEY_PLANT:
        options->plant = text;
        return 0;
    case KEY_PASS_INPUTS:
        options->estimate.pass_inputs = true;
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case KEY_READINGS:
        readings_option_read(&options->estimate.readings, &options->named, text, state);
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

static int print_estimate(const struct options *options, const struct program_source *sources, const struct estimate *estimate)
{
    if (options->json) {
        json_t *json = estimate_json(estimate, sources);
        json_dumpf(json, stdout, JSON_INDENT(2));
        putchar('\n');
        json_decref(json);
    } else {
        estimate_print(estimate, sources, stdout);
    }
    return estimate->end == ESTIMATE_STOPPED || estimate->collisions_all > 0 || estimate->deadlock ? STATUS_FAILURE
                                                                                                  : STATUS_SUCCESS;
}

static int run_estimate(const struct options *options, const struct program_source *sources, size_t count)
{
    struct estimate estimate;
    int status = STATUS_FAILURE;
    switch (estimate_programs(sources, count, &options->estimate, &estimate)) {
    case ESTIMATE_OK:
        status = print_estimate(options, sources, &estimate);
        break;
    case ESTIMATE_REFUSED:
        tool_check_errors(sources, count, &options->estimate.readings);
        break;
    case ESTIMATE_NO_PLANT:
        break; /* reported */
    case ESTIMATE_NO_MEMORY:
        fputs("rkm04 estimate: out of memory\n", stderr);
        break;
    }
    estimate_free(&estimate);
    return status;
}

/* Read the plant and all programs, and run them. */
static int read_and_run(struct options *options)
{
    struct tool_files *files = &options->files;
    struct program_source *sources = calloc(files->count + 1, sizeof *sources);
    struct program_text plant = {0};
    bool ok = sources != NULL;
    if (options->plant != NULL) {
        const char *wrong = program_text_read_raw(&plant, options->plant);
        if (wrong != NULL) {
            fprintf(stderr, "rkm04 estimate: cannot read %s: %s\n", options->plant, wrong);
            ok = false;
        }
        options->estimate.plant = plant.text != NULL ? plant.text : "";
        options->estimate.plant_length = plant.length;
        options->estimate.plant_name = options->plant;
        options->estimate.errors = stderr;
    }
    for (size_t i = 0; sources != NULL && i < files->count; i++) {
        ok = tool_file_read(&files->list[i], "rkm04 estimate") && ok;
        sources[i] = files->list[i].source;
    }
    int status = ok ? run_estimate(options, sources, files->count) : STATUS_FAILURE;
    program_text_free(&plant);
    free(sources);
    return status;
}

int estimate_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, "[M=]FILE...", doc, NULL, NULL, NULL};
    struct options options = {.json = false};
    tool_files_begin(&options.files, argc);
    arguments_parse(&argp, argc, argv, &options);
    int status = read_and_run(&options);
    tool_files_end(&options.files);
    return arguments_printed() != 0 ? STATUS_FAILURE : status;
}
