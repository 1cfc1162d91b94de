/* SPDX-License-Identifier: MIT */
/* `rkm04 test`: scenarios in virtual time. Its options and exit status; a scenario itself is the room src/scenario. */
#include <argp.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "file/file.h"
#include "interrupt.h"
#include "options/options.h"
#include "run.h"
#include "test_case.h"
#include "test_readings.h"
#include "test_report.h"
#include "text/text.h"

enum option_key { KEY_NO_RECORDS = 256, KEY_FORCE, KEY_READINGS, KEY_STRICT };

struct options {
    const char **path; /* in the order of the command line */
    size_t paths;
    unsigned output_flags; /* of output_file.h */
    bool stdin_taken, json, no_records, strict;
    struct device_arguments device; /* whose readings --readings names */
    enum test_readings_mode mode;
    const char *junit, *records;
};

static const struct argp_option option_table[] = {
    {"junit", 'x', "FILE", 0, "Write the results as JUnit XML", 0},
    {"json", 'j', NULL, 0, "Print the results as JSON, instead of a line for each scenario", 0},
    {"records", 'r', "FOLDER", 0, "Folder for the recordings of failed scenarios; default: the working directory", 0},
    {"no-records", KEY_NO_RECORDS, NULL, 0, "Keep no recordings", 0},
    {"force", KEY_FORCE, NULL, 0,
     "Also overwrite files of another kind with the report and recordings; never one that is also read or written otherwise", 0},
    {"readings", KEY_READINGS, "NAME=VALUE,...", 0,
     "Run under these readings (docs/READINGS.md). `all': run under the defaults and under each other value of each reading, one "
     "at a time, and report on which the result depends; `pairs': also under each pair; `list' lists them. May be given several "
     "times: readings named with a value, here or in a scenario, do not change", 0},
    {"strict", KEY_STRICT, NULL, 0, "With --readings all or pairs: a scenario that depends on a reading has failed", 0},
    {0},
};

static const char doc[] =
    "Run scenarios in virtual time, as fast as the machine can, and report which pass. A scenario is a text with programs and "
    "messages to send, inputs, faults and a plant, and with the expected results; - is standard input. "
    "docs/SCENARIOS.md describes the format."
    "\v"
    "A scenario, in YAML:\n"
    "  name: Five thousand steps and back\n"
    "  steps:\n"
    "    - set: 'S100 V1000 A2000 F5000 R'\n"
    "    - wait: {motor: 1, position: 5000}\n"
    "      within: 6s\n"
    "    - message: '04 \"1\"'\n"
    "      answer: '04 \"1\" 0A \"      5000\"'\n"
    "    - set: 'H'\n"
    "    - wait: {motor: 1, state: idle, position: 0}\n"
    "    - pulses: {motor: 1, forward: 5000, back: 5000}\n"
    "\n"
    "It prints for each \"pass FILE: NAME (TIME)\" or \"FAIL FILE:LINE:COLUMN: NAME: expected ...; seen ...; at tick ...\". The "
    "inputs and outputs of a scenario that fails are kept in NAME.record; `rkm04 replay' repeats them.\n"
    "\n"
    "With --readings all a second line is printed, such as \"FILE: passes under 22 of 23; depends on hold-exit\", and a line for "
    "each run with another result. A scenario for one reading names it: readings: {hold-exit: latch}.\n"
    "\n"
    "Examples:\n"
    "  rkm04 test homing.yaml\n"
    "  rkm04 test --junit report.xml --records build scenarios/*.yaml\n"
    "  rkm04 test --readings all --strict scenarios/*.yaml\n"
    "  rkm04 replay --trace homing.vcd homing.record\n"
    "\n"
    "Exit status: 0 all passed; 3 any failed, or, with --strict, depends on a reading; 1 a file could not be read or "
    "written, or the run was interrupted; 2 wrong usage, or a file that is not a scenario: each error is a line "
    "FILE:LINE:COLUMN: error: ..., and nothing is run.";

/* ---- Command line --------------------------------------------------------------------------------------------------- */

static void take_path(struct argp_state *state, struct options *options, const char *path)
{
    bool standard = strcmp(path, "-") == 0;
    if (standard && options->stdin_taken)
        argp_error(state, "standard input (-) can be read only once");
    options->stdin_taken = options->stdin_taken || standard;
    options->path[options->paths++] = path;
}

static void take_readings(struct argp_state *state, struct options *options, const char *text)
{
    bool all = strcmp(text, "all") == 0, pairs = strcmp(text, "pairs") == 0;
    if (!all && !pairs)
        device_arguments_add(&options->device, "readings", text, state);
    else if (options->mode != TEST_READINGS_ONE)
        argp_error(state, "--readings: expected all or pairs once");
    else
        options->mode = all ? TEST_READINGS_ALL : TEST_READINGS_PAIRS;
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->device;
        return 0;
    case 'x':
        options->junit = text;
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case 'r':
        options->records = text;
        return 0;
    case KEY_NO_RECORDS:
        options->no_records = true;
        return 0;
    case KEY_FORCE:
        options->output_flags |= OUTPUT_FORCE;
        return 0;
    case KEY_READINGS:
        take_readings(state, options, text);
        return 0;
    case KEY_STRICT:
        options->strict = true;
        return 0;
    case ARGP_KEY_ARG:
        take_path(state, options, text);
        return 0;
    case ARGP_KEY_END:
        if (options->paths == 0)
            argp_error(state, "no scenario given");
        if (options->no_records && options->records != NULL)
            argp_error(state, "expected either --records or --no-records");
        if (options->strict && options->mode == TEST_READINGS_ONE)
            argp_error(state, "--strict: expected --readings all or pairs with it");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void parse_options(int argc, char **argv, struct options *options)
{
    options->device.own = "readings";
    options->device.without = DEVICE_OPTION_BUS;
    const struct argp_child children[] = {{.argp = device_arguments_argp(&options->device)}, {0}};
    const struct argp argp = {option_table, parse_option, "SCENARIO...", doc, children, NULL, NULL};
    argp_err_exit_status = STATUS_USAGE;
    arguments_parse(&argp, argc, argv, options);
}

/* ---- The run -------------------------------------------------------------------------------------------------------- */

/* Read all files, to report all their errors. Returns 0 or the exit status. */
static int read_all(struct test_case *tests, const struct options *options)
{
    int status = STATUS_SUCCESS;
    for (size_t i = 0; i < options->paths; i++) {
        int wrong = test_case_read(&tests[i], options->path[i], &options->device);
        if (wrong == STATUS_USAGE || status == STATUS_SUCCESS)
            status = wrong != STATUS_SUCCESS ? wrong : status;
    }
    return status;
}

/* The readings of the command line, if they are those of the scenario's device; else the defaults. */
static const struct device_config *base_of(const struct options *options, const struct test_case *test)
{
    static const struct device_config defaults;
    return scenario_device(test->scenario) == options->device.kind ? &options->device.config : &defaults;
}

/* Under other readings, if that is wanted. Returns false if out of memory. */
static bool run_under_others(struct test_case *test, const struct options *options, struct test_progress *progress)
{
    if (options->mode == TEST_READINGS_ONE || test->outcome == TEST_NOT_RUN || test->outcome == TEST_BROKEN)
        return true;
    fflush(stdout); /* who waits sees the first result */
    test_readings_run(test, base_of(options, test), options->mode, progress);
    if (!options->json)
        test_report_readings(stdout, test);
    if (test->under != NULL && !test->under->broken)
        return true;
    fprintf(stderr, "rkm04 test: %s: %s\n", test->file, strerror(ENOMEM));
    return false;
}

/* Returns false if a recording could not be written. *wrong: 0, or the errno with which a line could not. */
static bool run_all(struct test_case *tests, const struct options *options, int *wrong)
{
    struct test_progress progress = {.wanted = isatty(STDERR_FILENO) != 0, .count = options->paths};
    const char *folder = options->no_records ? NULL : options->records != NULL ? options->records : ".";
    bool ok = true;
    for (size_t i = 0; i < options->paths && !test_case_interrupted(); i++) {
        unsigned number = 1;
        for (size_t before = 0; before < i; before++)
            number += test_case_alike(&tests[before], &tests[i]);
        progress.at = i + 1;
        scenario_set_readings(tests[i].scenario, base_of(options, &tests[i]));
        ok = test_case_run(&tests[i], folder, options->output_flags, number, &progress) && ok;
        if (!options->json)
            test_report_line(stdout, &tests[i]);
        ok = run_under_others(&tests[i], options, &progress) && ok;
        if (fflush(stdout) != 0 && *wrong == 0)
            *wrong = errno;
    }
    return ok;
}

/* `wrong`: an errno of before, or 0. */
static bool finish_file(FILE *file, const char *what, int wrong)
{
    if (fflush(file) != 0 && wrong == 0)
        wrong = errno;
    if (ferror(file) && wrong == 0)
        wrong = EIO;
    if (file != stdout && output_file_close(file) != 0 && wrong == 0)
        wrong = errno;
    if (wrong != 0)
        fprintf(stderr, "rkm04 test: cannot write %s: %s\n", what, strerror(wrong));
    return wrong == 0;
}

static bool report_all(const struct test_case *tests, const struct options *options, FILE *junit, int wrong)
{
    bool ok = true;
    if (junit != NULL) {
        test_report_junit(junit, tests, options->paths, options->strict);
        ok = finish_file(junit, options->junit, 0);
    }
    if (options->json)
        test_report_json(stdout, tests, options->paths);
    else if (options->paths > 1)
        test_report_sum(stdout, tests, options->paths);
    return finish_file(stdout, "the results", wrong) && ok;
}

static int run_files(struct test_case *tests, const struct options *options)
{
    FILE *junit = NULL;
    int status = read_all(tests, options);
    if (status != STATUS_SUCCESS)
        return status;
    if (options->junit != NULL) {
        char *why;
        junit = output_file_open(options->junit, &output_junit, options->output_flags | OUTPUT_MAY_WAIT, &why);
        if (junit == NULL) {
            fprintf(stderr, "rkm04 test: cannot write %s: %s\n", options->junit, why != NULL ? why : strerror(ENOMEM));
            free(why);
            return STATUS_FAILURE;
        }
    }
    interrupt_catch(test_case_interrupt);
    int wrong = 0;
    bool ok = run_all(tests, options, &wrong);
    ok = report_all(tests, options, junit, wrong) && ok;
    if (test_case_interrupted())
        fputs("rkm04 test: interrupted\n", stderr);
    if (test_report_count(tests, options->paths, TEST_FAILED) > 0 ||
        (options->strict && test_report_dependent(tests, options->paths) > 0))
        return STATUS_FAILED;
    ok = ok && !test_case_interrupted() && test_report_count(tests, options->paths, TEST_PASSED) == options->paths;
    return ok ? STATUS_SUCCESS : STATUS_FAILURE;
}

int test_main(int argc, char **argv)
{
    struct options options = {.path = calloc((size_t)argc, sizeof(const char *))};
    struct test_case *tests = calloc((size_t)argc, sizeof *tests);
    int status = STATUS_FAILURE;
    if (options.path == NULL || tests == NULL) {
        fprintf(stderr, "rkm04 test: %s\n", strerror(ENOMEM));
    } else {
        parse_options(argc, argv, &options);
        status = run_files(tests, &options);
    }
    for (size_t i = 0; tests != NULL && i < options.paths; i++)
        test_case_free(&tests[i]);
    device_arguments_free(&options.device);
    free(tests);
    free(options.path);
    return status;
}
