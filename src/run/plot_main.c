/* SPDX-License-Identifier: MIT */
/* `rkm04 plot`: its options; where the curves come from; where the picture goes. */
#include <argp.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "exec_inputs.h"
#include "exec_run.h"
#include "file/file.h"
#include "options/options.h"
#include "plot/plot.h"
#include "record/record.h"
#include "run.h"
#include "test_case.h"
#include "text/text.h"

#define COMMAND "rkm04 plot"
#define WIDTH 800u
#define PNG_SCALE 2u
#define SCALE_MAX 4u
#define TITLE_SIZE 256u
#define CRUISE_AFTER 1000000u /* us of an endless motion that are drawn at least */

enum form { FORM_SVG, FORM_PNG, FORM_HTML, FORM_CSV, FORMS };

static const struct {
    const char *name;
    struct output_kind kind;
} forms[FORMS] = {
    [FORM_SVG] = {"svg", {.name = "a picture as SVG", .begins = {"<svg", "<?xml"}, .is_report = true}},
    [FORM_PNG] = {"png", {.name = "a picture as PNG", .begins = {"\x89PNG"}, .is_report = true}},
    [FORM_HTML] = {"html", {.name = "a page", .begins = {"<!DOCTYPE html", "<!doctype html"}, .is_report = true}},
    [FORM_CSV] = {"csv", {.name = "the corners of a plot as CSV", .begins = {"t_us,motor,speed,position"}, .is_report = true}},
};

struct options {
    struct exec_inputs inputs;
    const char *output, *plant, *title, *unit;
    enum form form;
    uint64_t from, until;
    unsigned width, scale, output_flags;
    struct device_arguments device;
};

enum option_key { KEY_FORCE = 256, KEY_FROM, KEY_PLANT, KEY_TITLE, KEY_UNIT, KEY_WIDTH, KEY_SCALE, KEY_FORMAT };

static const struct argp_option option_table[] = {
    {"output", 'o', "FILE", 0, "The picture: .svg, .png, .html or .csv; - is standard output", 0},
    {"format", KEY_FORMAT, "FORM", 0, "svg, png, html or csv, regardless of the name of FILE", 0},
    {"from", KEY_FROM, "TIME", 0, "Start of the part that is shown (250us, 1500ms, 2.5s)", 0},
    {"until", 'u', "TIME", 0, "Stop after this time", 0},
    {"stimulus", 's', "FILE", 0, "Inputs and messages that come while the programs run, as for exec", 0},
    {"plant", KEY_PLANT, "FILE", 0, "Attach simulated mechanics and draw true positions, too", 0},
    {"unit", KEY_UNIT, "NAME", 0, "The unit to show, if a trace or recording has several", 0},
    {"title", KEY_TITLE, "TEXT", 0, "Heading of the picture", 0},
    {"width", KEY_WIDTH, "PX", 0, "Width of the picture in px, 240 to 8000; default 800", 0},
    {"scale", KEY_SCALE, "N", 0, "Dots of a PNG per px, 1 to 4; default 2", 0},
    {"force", KEY_FORCE, NULL, 0, "Also overwrite a file of another kind", 0},
    {0},
};

static const char doc[] =
    "Draw what motors do: planned speed and position over time, as in the manual's figures, what each motor waits for, "
    "and the inputs, outputs and variables that change."
    "\v"
    "FILE is a program text and M its motor, as for `rkm04 exec'; or one trace as CSV (its speeds are averages over a few "
    "milliseconds); or one recording, which is replayed; or one scenario (.yaml). A program that never ends is drawn until "
    "its state repeats.\n"
    "A PNG is made by rsvg-convert (package librsvg2-bin).\n"
    "\n"
    "Examples:\n"
    "  rkm04 plot drill.rks -o drill.svg\n"
    "  rkm04 plot 1=x.rks 2=y.rks --until 10s -o both.html\n"
    "  rkm04 plot --plant axis.yaml homing.rks -o homing.png --width 1200\n"
    "  rkm04 plot session.record --unit 3 -o session.svg\n"
    "  rkm04 plot homing.yaml -o homing.png\n"
    "\n"
    "Exit status: 0 success; 1 a text was refused, a file could not be read or written; 2 wrong usage.";

/* ---- Command line --------------------------------------------------------------------------------------------------- */

static uint64_t read_time(struct argp_state *state, const char *option, const char *text)
{
    uint64_t us = 0;
    size_t wrong;
    const char *form = time_value_read(text, strlen(text), &us, &wrong);
    if (form != NULL)
        argp_error(state, "--%s: expected %s, found '%s'", option, form, text);
    return us;
}

static unsigned read_number(struct argp_state *state, const char *option, const char *text, unsigned low, unsigned high)
{
    uint64_t number = low;
    if (!number_read(text, low, high, &number))
        argp_error(state, "--%s: expected a number %u to %u, found '%s'", option, low, high, text);
    return (unsigned)number;
}

static enum form form_named(const char *name)
{
    unsigned form = 0;
    while (form < FORMS && (name == NULL || strcasecmp(forms[form].name, name) != 0))
        form++;
    return form;
}

static enum form read_form(struct argp_state *state, const char *name)
{
    enum form form = form_named(name);
    if (form == FORMS)
        argp_error(state, "--format: expected svg, png, html or csv, found '%s'", name);
    return form;
}

/* A picture on a terminal is of no use. */
static void end_options(struct options *options, struct argp_state *state)
{
    if (exec_inputs_are_none(&options->inputs))
        argp_error(state, "no program, trace or recording given");
    exec_inputs_complete(&options->inputs, options->device.kind, state);
    if (options->from >= options->until)
        argp_error(state, "--from: expected a time before --until");
    const char *dot = options->output == NULL ? NULL : strrchr(options->output, '.');
    bool is_stdout = options->output == NULL || strcmp(options->output, "-") == 0;
    if (options->form == FORMS && !is_stdout)
        options->form = form_named(dot != NULL ? dot + 1 : NULL);
    if (options->form == FORMS && !is_stdout)
        argp_error(state, "--output: expected a name that ends with .svg, .png, .html or .csv, or --format with '%s'",
                   options->output);
    if (options->form == FORMS)
        options->form = FORM_SVG;
    if (is_stdout && isatty(STDOUT_FILENO))
        argp_error(state, "standard output is a terminal: give a file with --output");
    if (is_stdout)
        options->output = NULL;
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &options->device; return 0;
    case 'o': options->output = text; return 0;
    case 'u': options->until = read_time(state, "until", text); return 0;
    case 's': exec_inputs_stimulus(&options->inputs, text); return 0;
    case KEY_FORMAT: options->form = read_form(state, text); return 0;
    case KEY_FROM: options->from = read_time(state, "from", text); return 0;
    case KEY_PLANT: options->plant = text; return 0;
    case KEY_UNIT: options->unit = text; return 0;
    case KEY_TITLE: options->title = text; return 0;
    case KEY_WIDTH: options->width = read_number(state, "width", text, PLOT_WIDTH_MIN, PLOT_WIDTH_MAX); return 0;
    case KEY_SCALE: options->scale = read_number(state, "scale", text, 1, SCALE_MAX); return 0;
    case KEY_FORCE: options->output_flags |= OUTPUT_FORCE; return 0;
    case ARGP_KEY_ARG: exec_inputs_argument(&options->inputs, text); return 0;
    case ARGP_KEY_END: end_options(options, state); return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static bool is_wrong(const char *what, const char *why)
{
    fprintf(stderr, COMMAND ": %s%s%s\n", what, *what != '\0' ? ": " : "", why);
    return false;
}

/* ---- From programs ---------------------------------------------------------------------------------------------------- */

static void on_advanced(void *context)
{
    collector_update(context);
}

static void ignore_answer(void *context, uint64_t tick, const struct stimulus *stimulus, const uint8_t *answer, size_t length)
{
    (void)context, (void)tick, (void)stimulus, (void)answer, (void)length;
}

static bool attach_plant(struct sim *sim, const char *path)
{
    struct program_text file;
    const char *wrong = program_text_read(&file, path);
    bool is_right = wrong == NULL && output_file_spare(path) && sim_configure_plants(sim, path, file.text, file.length, stderr);
    if (wrong != NULL)
        is_wrong(path, wrong);
    program_text_free(&file);
    return is_right;
}

/* What repeats from slot to slot is an endless motion: it is drawn on to where it can be seen to continue. */
static void run_on(struct exec_run *run)
{
    uint64_t now = sim_now(&run->sim);
    if (run->period <= run->device->slot) {
        run->until = 2 * now > now + CRUISE_AFTER ? 2 * now : now + CRUISE_AFTER;
        exec_run(run);
    }
    fprintf(stderr, COMMAND ": the program never ends: it is drawn up to %.6g s, --until sets another end\n",
            (double)run->reached * 1e-6);
}

static bool draw_programs(struct options *options, struct plot_curves *curves)
{
    static struct exec_run run;
    struct collector collector;
    run.stimuli = &options->inputs.stimuli;
    run.stimulus_name = options->inputs.stimulus_file.name;
    run.until = options->until;
    run.device = options->device.kind;
    run.config = options->device.config;
    run.progress = isatty(STDERR_FILENO) != 0;
    run.answered = ignore_answer;
    run.advanced = on_advanced;
    run.context = &collector;
    bool is_right = exec_run_begin(&run) && (options->plant == NULL || attach_plant(&run.sim, options->plant));
    if (is_right) {
        exec_inputs_store(&options->inputs, &run);
        collector_begin(&collector, curves, &run.sim, 1, false);
        enum exec_end end = exec_run(&run);
        if (end == EXEC_ENDLESS)
            run_on(&run);
        collector_end(&collector);
        is_right = end != EXEC_INTERRUPTED || is_wrong("", "interrupted");
    }
    exec_run_end(&run);
    return is_right;
}

/* ---- From a recording or a trace -------------------------------------------------------------------------------------- */

static bool draw_replay(const struct options *options, struct plot_curves *curves, struct replay *replay)
{
    struct sim *sim = replay_sim(replay);
    struct collector collector;
    if (sim == NULL) {
        fprintf(stderr, "%s\n", replay_text(replay));
        return false;
    }
    unsigned unit = options->unit == NULL ? sim_units(sim) == 1 : sim_unit_named(sim, options->unit);
    if (unit == 0)
        return options->unit != NULL ? is_wrong("--unit: there is no such unit in the recording", options->unit) :
                                       is_wrong("", "the recording has several units: choose one of them with --unit");
    replay_until(replay, options->until);
    collector_begin(&collector, curves, sim, unit, true);
    enum replay_end end = replay_run(replay, NULL, NULL);
    collector_end(&collector);
    if (end != REPLAY_SAME)
        fprintf(stderr, end == REPLAY_WRONG ? "%s\n" : COMMAND ": %s\n", replay_text(replay));
    return end == REPLAY_SAME || end == REPLAY_DIFFERENT;
}

static bool draw_recording(const struct options *options, struct plot_curves *curves, const char *path, FILE *in)
{
    struct replay *replay = replay_open(path, in);
    bool is_right = replay != NULL && draw_replay(options, curves, replay);
    if (replay != NULL)
        replay_free(replay);
    return is_right;
}

/* A scenario is recorded first. One that fails is drawn as far as it came. */
static bool draw_scenario(const struct options *options, struct plot_curves *curves, const char *path)
{
    struct test_case test = {0};
    FILE *recording = tmpfile();
    bool is_right = recording != NULL || is_wrong("cannot keep a recording", strerror(errno));
    if (is_right && test_case_read(&test, path, &options->device) != 0)
        is_right = false;
    if (is_right) {
        enum scenario_end end = scenario_run(test.scenario, recording, NULL, NULL, &test.result);
        if (end == SCENARIO_FAILED)
            fprintf(stderr, "%s:%zu:%zu: failed: expected %s, but %s\n", path, test.result.line, test.result.column,
                    test.result.expected, test.result.seen);
        rewind(recording);
        is_right = end != SCENARIO_NO_MEMORY ? draw_recording(options, curves, path, recording) :
                                               is_wrong("", strerror(ENOMEM));
    }
    test_case_free(&test);
    if (recording != NULL)
        fclose(recording);
    return is_right;
}

/* ---- All of it -------------------------------------------------------------------------------------------------------- */

enum source { FROM_PROGRAMS, FROM_TRACE, FROM_RECORDING, FROM_SCENARIO };

static bool has_ending(const char *path, const char *ending)
{
    size_t length = strlen(path), end = strlen(ending);
    return length > end && strcmp(path + length - end, ending) == 0;
}

/* Scenarios are recognised by their name, traces and recordings by their first bytes. */
static enum source source_of(const char *path, FILE *in)
{
    if (has_ending(path, ".yaml") || has_ending(path, ".yml"))
        return FROM_SCENARIO;
    char bytes[OUTPUT_KIND_BYTES];
    size_t length = fread(bytes, 1, sizeof bytes, in);
    rewind(in);
    if (length > 0 && output_kind_is(&output_recording, bytes, length))
        return FROM_RECORDING;
    return length >= 5 && memcmp(bytes, "t_us,", 5) == 0 ? FROM_TRACE : FROM_PROGRAMS;
}

static bool fill_from_programs(struct options *options, struct plot_curves *curves)
{
    return exec_inputs_read(&options->inputs, options->device.kind, &options->device.config) && draw_programs(options, curves);
}

static bool fill_curves(struct options *options, struct plot_curves *curves)
{
    const char *path = options->inputs.programs == 1 ? options->inputs.program[0].path : "-";
    FILE *in = strcmp(path, "-") == 0 ? NULL : fopen(path, "re");
    enum source source = in == NULL ? FROM_PROGRAMS : source_of(path, in);
    bool is_right = true;
    if (source != FROM_PROGRAMS)
        is_right = output_file_spare(path);
    if (is_right)
        is_right = source == FROM_PROGRAMS ? fill_from_programs(options, curves) :
                   source == FROM_SCENARIO ? draw_scenario(options, curves, path) :
                   source == FROM_TRACE    ? plot_read_trace(curves, path, in, options->unit, stderr) :
                                             draw_recording(options, curves, path, in);
    if (in != NULL)
        fclose(in);
    if (is_right && curves->short_of_memory)
        is_right = is_wrong("", strerror(ENOMEM));
    if (is_right && curves->is_cut)
        fputs(COMMAND ": there is more than can be drawn: the rest is left out; choose a part with --until\n", stderr);
    return is_right;
}

/* Has everything been written? Otherwise errno says why. */
static bool is_written(FILE *file)
{
    errno = EIO;
    return fflush(file) == 0 && !ferror(file);
}

static bool write_png(FILE *out, const struct plot_curves *curves, const struct plot_view *view, const struct options *options)
{
    FILE *svg = tmpfile();
    const char *why = strerror(errno);
    if (svg != NULL) {
        plot_draw_svg(svg, curves, view);
        why = is_written(svg) ? NULL : strerror(errno);
        rewind(svg);
        why = why == NULL ? plot_rasterize(svg, out, options->scale) : why;
        fclose(svg);
    }
    return why == NULL || is_wrong("cannot make the PNG", why);
}

/* "x.rks, y.rks": the names of the files. */
static void name_files(const struct exec_inputs *inputs, char title[TITLE_SIZE])
{
    size_t used = 0;
    title[0] = '\0';
    for (size_t i = 0; i < inputs->programs && used < TITLE_SIZE; i++) {
        const char *path = inputs->program[i].path, *slash = strrchr(path, '/');
        used += (size_t)snprintf(title + used, TITLE_SIZE - used, "%s%s", i > 0 ? ", " : "",
                                 strcmp(path, "-") == 0 ? "standard input" : slash != NULL ? slash + 1 : path);
    }
}

static bool write_picture(FILE *out, const struct plot_curves *curves, const struct options *options)
{
    struct plot_view view = {.title = options->title, .width = options->width, .from = (double)options->from};
    char title[TITLE_SIZE];
    if (view.title == NULL) {
        name_files(&options->inputs, title);
        view.title = title;
    }
    view.to = fmax(fmin(curves->end, (double)options->until), view.from + 1000);
    switch (options->form) {
    case FORM_PNG: return write_png(out, curves, &view, options);
    case FORM_HTML: plot_draw_html(out, curves, &view); return true;
    case FORM_CSV: plot_draw_csv(out, curves, &view); return true;
    default: plot_draw_svg(out, curves, &view); return true;
    }
}

/* Returns false, and errno says why, if it did not work. */
static bool copy_file(FILE *out, FILE *in)
{
    char bytes[BUFSIZ];
    size_t length;
    rewind(in);
    while ((length = fread(bytes, 1, sizeof bytes, in)) > 0)
        if (fwrite(bytes, 1, length, out) != length)
            return false;
    return is_written(out) && !ferror(in);
}

static bool write_to_file(const struct plot_curves *curves, const struct options *options, FILE *picture)
{
    char *why = NULL;
    if (picture == NULL)
        return is_wrong("", strerror(errno));
    if (!write_picture(picture, curves, options))
        return false;
    if (!is_written(picture))
        return is_wrong("a temporary file", strerror(errno));
    FILE *out = output_file_open(options->output, &forms[options->form].kind, options->output_flags | OUTPUT_MAY_WAIT, &why);
    bool is_right = out != NULL;
    if (is_right && !copy_file(out, picture))
        is_right = is_wrong(options->output, strerror(errno));
    if (out != NULL && output_file_close(out) != 0 && is_right)
        is_right = is_wrong(options->output, strerror(errno));
    if (out == NULL)
        fprintf(stderr, COMMAND ": cannot write %s: %s\n", options->output, why != NULL ? why : strerror(ENOMEM));
    free(why);
    return is_right;
}

static bool write_output(const struct plot_curves *curves, const struct options *options)
{
    if ((double)options->from >= fmax(curves->end, 1))
        return is_wrong("--from", "expected a time before the end of what is drawn");
    if (options->output == NULL)
        return write_picture(stdout, curves, options) && (is_written(stdout) || is_wrong("standard output", strerror(errno)));
    FILE *picture = tmpfile(); /* what is at the place already is overwritten by a whole picture only */
    bool is_right = write_to_file(curves, options, picture);
    if (picture != NULL)
        fclose(picture);
    return is_right;
}

int plot_main(int argc, char **argv)
{
    static struct plot_curves curves;
    struct options options = {.until = UINT64_MAX, .form = FORMS, .width = WIDTH, .scale = PNG_SCALE,
                              .device = {.without = DEVICE_OPTION_BUS, .config.node = 1}};
    const struct argp_child children[] = {{.argp = device_arguments_argp(&options.device)}, {0}};
    const struct argp argp = {option_table, parse_option, "[M=]FILE...", doc, children, NULL, NULL};
    int status = STATUS_FAILURE;
    argp_err_exit_status = STATUS_USAGE;
    if (exec_inputs_begin(&options.inputs, COMMAND, argc)) {
        arguments_parse(&argp, argc, argv, &options);
        if (fill_curves(&options, &curves) && write_output(&curves, &options))
            status = STATUS_SUCCESS;
    }
    plot_free(&curves);
    exec_inputs_free(&options.inputs);
    device_arguments_free(&options.device);
    return status;
}
