/* SPDX-License-Identifier: MIT */
/* `rkm04 exec`: programs in virtual time. Its options, texts and exit status; the run itself is exec_run.c. */
#include <argp.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "exec_inputs.h"
#include "exec_report.h"
#include "exec_run.h"
#include "file/file.h"
#include "interrupt.h"
#include "options/options.h"
#include "run.h"
#include "text/text.h"
#include "trace/trace.h"

struct options {
    struct exec_inputs inputs;
    const char *trace, *until_text, *backup;
    uint64_t until;
    bool json;
    unsigned output_flags; /* of output_file.h */
    struct device_arguments device;
};

enum option_key { KEY_FORCE = 256, KEY_BACKUP };

static const struct argp_option option_table[] = {
    {"until", 'u', "TIME", 0, "Stop after this time (250us, 1500ms, 2.5s)", 0},
    {"stimulus", 's', "FILE", 0, "Inputs and messages that come while the programs run", 0},
    {"trace", 't', "FILE", 0, "Record every event (" TRACE_ENDINGS "; any other name: CSV); - is CSV on standard output", 0},
    {"backup", KEY_BACKUP, "FILE", 0,
     "Of a CNC872: file of its backup memory, read at the start and saved as the PLC program asks for it, and at the end", 0},
    {"json", 'j', NULL, 0, "Print the final state as JSON", 0},
    {"force", KEY_FORCE, NULL, 0,
     "Also overwrite a file of another kind with the trace; never one that is also read or written otherwise", 0},
    {0},
};

static const char doc[] =
    "Run programs of an RKM04, or of another device, in virtual time, as fast as the machine can, until every motor is idle, "
    "stopped, or waits for an input that no stimulus sets; without --until also until the state repeats, because the program "
    "would never end. M is the motor, 1 to 4 or 0 for all; without it 1, or all if programs of the device are always for all. "
    "FILE is a program text (.rks), - standard input. Several files for the same motor are sent in order."
    "\v"
    "Lines of a stimulus file (times as in --until, from the start of the run):\n"
    "  TIME di NN 0|1        input 01 to 08\n"
    "  TIME set M TEXT       program text for motor M, to the end of the line\n"
    "  TIME message HEX      a message of the protocol; the answer is shown\n"
    "  # comment\n"
    "\n"
    "A trace as CSV has the columns t_us,source,event,value:\n"
    "  m1,step,POSITION   m1,dir,1|-1        m1,motion,begin|end\n"
    "  m1,led,off|on|blink                   m1,command,INDEX (0: idle)\n"
    "  m1,position,POSITION   changed without a pulse: C100, =, a motion under T41\n"
    "  unit,di|do|var,MASK\n"
    "docs/TRACES.md describes the other formats.\n"
    "\n"
    "Examples:\n"
    "  rkm04 exec drill.rks\n"
    "  rkm04 exec 1=x.rks 2=y.rks --until 10s --trace run.csv\n"
    "  echo 'F1000 R' | rkm04 exec --json -\n"
    "  rkm04 exec --readings planning=20ms drill.rks\n"
    "\n"
    "Exit status: 0 success; 1 a text was refused, a motor ended in a fault, a file could not be read or written, or the run was "
    "interrupted; 2 wrong usage; 124 --until was reached with a motor still running, or without it "
    "the program never ends: its state repeats.";

/* ---- Command line ------------------------------------------------------------------------------------------------- */

static void take_until(struct argp_state *state, struct options *options, const char *text)
{
    size_t wrong;
    const char *form = time_value_read(text, strlen(text), &options->until, &wrong);
    if (form != NULL)
        argp_error(state, "--until: expected %s, found '%s'", form, text);
    options->until_text = text;
}

/* A program among the settings of the device is started if none is named besides. */
static bool has_own_program(const struct options *options)
{
    const struct device_kind *device = options->device.kind;
    return device->has_program && device->has_program(&options->device.config);
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT:
        state->child_inputs[0] = &options->device;
        return 0;
    case 'u':
        take_until(state, options, text);
        return 0;
    case 's':
        exec_inputs_stimulus(&options->inputs, text);
        return 0;
    case 't':
        options->trace = text;
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case KEY_BACKUP:
        options->backup = text;
        return 0;
    case KEY_FORCE:
        options->output_flags |= OUTPUT_FORCE;
        return 0;
    case ARGP_KEY_ARG:
        exec_inputs_argument(&options->inputs, text);
        return 0;
    case ARGP_KEY_END:
        if (exec_inputs_are_none(&options->inputs) && !has_own_program(options))
            argp_error(state, "no program given");
        if (options->backup)
            device_arguments_check_backup(options->device.kind, false, state);
        exec_inputs_complete(&options->inputs, options->device.kind, state);
        if (options->json && options->trace != NULL && strcmp(options->trace, "-") == 0)
            argp_error(state, "--json and --trace - cannot both use standard output");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static void parse_options(int argc, char **argv, struct options *options)
{
    const struct argp_child children[] = {{.argp = device_arguments_argp(&options->device)}, {0}};
    const struct argp argp = {option_table, parse_option, "[M=]FILE...", doc, children, NULL, NULL};
    argp_err_exit_status = STATUS_USAGE;
    log_as("rkm04 exec: ");
    arguments_parse(&argp, argc, argv, options);
}

/* ---- Run ---------------------------------------------------------------------------------------------------------- */

/* What repeats from slot to slot are motions: a program takes more than one for a turn. */
static void report_endless(struct exec_run *run)
{
    const uint64_t period = run->period, slot = run->device->slot;
    char text[DEVICE_ERROR_SIZE];
    fputs("rkm04 exec: the program never ends: ", stderr);
    for (unsigned motor = 1; period == slot && motor <= run->device->axes; motor++)
        if (run->device->is_endless(exec_run_unit(run), motor, text))
            fprintf(stderr, "motor %u %s; ", motor, text);
    if (period != slot)
        fprintf(stderr, "its state repeats every %" PRIu64 ".%06" PRIu64 " s; ", period / US_PER_SECOND,
                period % US_PER_SECOND);
    fputs("set an end with --until\n", stderr);
}

static int exit_status(struct exec_run *run, const struct options *options, enum exec_end end, bool written)
{
    bool fault = report_faults(run) || run->refused;
    if (end == EXEC_UNTIL && exec_run_is_running(run)) {
        if (options->until_text == NULL)
            fprintf(stderr, "rkm04 exec: virtual time has reached its end with a motor still running\n");
        else
            fprintf(stderr, "rkm04 exec: --until %s reached with a motor still running\n", options->until_text);
        return written ? STATUS_UNTIL : STATUS_FAILURE;
    }
    if (end == EXEC_ENDLESS) {
        report_endless(run);
        return written ? STATUS_UNTIL : STATUS_FAILURE;
    }
    if (end == EXEC_INTERRUPTED)
        fprintf(stderr, "rkm04 exec: interrupted\n");
    return end == EXEC_INTERRUPTED || fault || !written ? STATUS_FAILURE : STATUS_SUCCESS;
}

/* What goes wrong with the trace. Returns whether nothing did. */
static bool report_trace_error(const struct options *options, int wrong)
{
    if (wrong != 0)
        fprintf(stderr, "rkm04 exec: cannot write the trace %s: %s\n", options->trace, strerror(wrong));
    return wrong == 0;
}

/* A trace on `out`, or none. Returns false if out of memory. */
static bool begin_trace(struct exec_run *run, const struct options *options, FILE *out, struct trace_file **trace)
{
    *trace = NULL;
    if (out == NULL)
        return true;
    enum trace_format format = trace_file_format(options->trace);
    *trace = trace_file_begin_on(&run->sim, out, format == TRACE_FORMATS ? TRACE_CSV : format);
    run->trace = *trace;
    return *trace != NULL;
}

/* Run with the trace open on `out`, or without. Returns the exit status. */
static int run_programs(struct exec_run *run, const struct options *options, FILE *out)
{
    struct report report;
    struct trace_file *trace;

    run->stimuli = &options->inputs.stimuli;
    run->stimulus_name = options->inputs.stimulus_file.name;
    run->until = options->until;
    run->device = options->device.kind;
    run->config = options->device.config;
    run->flash_path = options->backup;
    run->progress = isatty(STDERR_FILENO) != 0;
    run->answered = report_answer;
    run->context = &report;
    interrupt_catch(exec_run_interrupt);
    if (!exec_run_begin(run) || !begin_trace(run, options, out, &trace)) {
        if (!options->backup || run->flash_path)
            fprintf(stderr, "rkm04 exec: %s\n", strerror(ENOMEM));
        return STATUS_FAILURE;
    }
    report_begin(&report, options->json);
    exec_inputs_store(&options->inputs, run);
    if (exec_inputs_are_none(&options->inputs))
        exec_run_set(run, 0, NULL, 0, "rkm04 exec");
    enum exec_end end = exec_run(run);

    bool written = exec_run_store(run);
    written = (trace == NULL || report_trace_error(options, trace_file_end(trace))) && written;
    if (!report_end(&report, run, end, out == stdout ? stderr : stdout))
        written = false;
    return exit_status(run, options, end, written);
}

static int run_traced(struct exec_run *run, const struct options *options)
{
    if (options->trace == NULL)
        return run_programs(run, options, NULL);
    if (strcmp(options->trace, "-") == 0)
        return run_programs(run, options, stdout);
    enum trace_format format = trace_file_format(options->trace);
    const struct output_kind *kind = trace_file_kind(format == TRACE_FORMATS ? TRACE_CSV : format);
    char *why;
    FILE *file = output_file_open(options->trace, kind, options->output_flags | OUTPUT_MAY_WAIT, &why);
    if (file == NULL) {
        fprintf(stderr, "rkm04 exec: cannot write the trace %s: %s\n", options->trace, why != NULL ? why : strerror(ENOMEM));
        free(why);
        return STATUS_FAILURE;
    }
    setvbuf(file, NULL, _IONBF, 0); /* gathered in a buffer already */
    int status = run_programs(run, options, file);
    if (output_file_close(file) != 0 && status == STATUS_SUCCESS) {
        report_trace_error(options, errno);
        status = STATUS_FAILURE;
    }
    return status;
}

int exec_main(int argc, char **argv)
{
    static struct exec_run run;
    struct options options = {.until = DEVICE_NEVER, .device = {.without = DEVICE_OPTION_BUS, .config.node = 1}};
    int status = STATUS_FAILURE;

    if (exec_inputs_begin(&options.inputs, "rkm04 exec", argc)) {
        parse_options(argc, argv, &options);
        if (exec_inputs_read(&options.inputs, options.device.kind, &options.device.config))
            status = run_traced(&run, &options);
    }
    exec_run_end(&run);
    exec_inputs_free(&options.inputs);
    device_arguments_free(&options.device);
    return status;
}
