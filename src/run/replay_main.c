/* SPDX-License-Identifier: MIT */
/* `rkm04 replay`: a recording, again in virtual time. */
#include <argp.h>
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "interrupt.h"
#include "options/options.h"
#include "record/record.h"
#include "run.h"
#include "text/text.h"
#include "trace/trace.h"

#define FILES_MAX 16u
#define PROGRESS_AFTER 2.0 /* s of real time */
#define PROGRESS_EVERY 0.5 /* s */
#define STEPS_A_LOOK 64u   /* steps between two readings of the real clock */

struct options {
    const char *path;
    const char *trace[FILES_MAX], *wire[FILES_MAX];
    size_t traces, wires;
    uint64_t until; /* DEVICE_NEVER: to the end */
    bool json;
    unsigned output_flags; /* of output_file.h */
};

enum option_key { KEY_FORCE = 256 };

static const struct argp_option option_table[] = {
    {"trace", 't', "FILE", 0, "Record every event: " TRACE_HELP "; may be repeated",
     0},
    {"wire", 'w', "FILE", 0, "Record the frames on the bus: FILE.log, or FILE.pcapng for Wireshark; may be repeated", 0},
    {"until", 'u', "TIME", 0, "Stop after this time (250us, 1500ms, 2.5s)", 0},
    {"json", 'j', NULL, 0, "Print the result as JSON", 0},
    {"force", KEY_FORCE, NULL, 0, "Also overwrite files of another kind; never one that is also read or written otherwise", 0},
    {0},
};

static const char doc[] =
    "Repeat a recording of `rkm04 serve --record' in virtual time, as fast as the machine can, and compare the "
    "outputs with the recorded ones. FILE - is standard input."
    "\v"
    "The first difference is named with unit, motor and time. A recording can never make this command read or write "
    "another file. docs/RECORD.md describes recordings.\n"
    "\n"
    "Examples:\n"
    "  rkm04 replay session.record\n"
    "  rkm04 replay --trace run.vcd --wire run.pcapng session.record\n"
    "  rkm04 replay --until 2.5s --trace run.csv session.record\n"
    "  xz -dc session.record.xz | rkm04 replay --json -\n"
    "\n"
    "Exit status: 0 all outputs are as recorded; 1 some differ, a trace could not be written, or the run was "
    "interrupted; 2 wrong usage, or FILE is not a recording.";

/* ---- Command line --------------------------------------------------------------------------------------------------- */

static void add_file(const char **list, size_t *count, const char *name, const char *text, const char *expected, bool valid,
                     struct argp_state *state)
{
    if (!valid)
        argp_error(state, "--%s: `%s' is wrong: expected %s", name, text, expected);
    if (*count == FILES_MAX)
        argp_error(state, "--%s: expected at most %u of these", name, FILES_MAX);
    list[(*count)++] = text;
}

static error_t parse_option(int key, char *text, struct argp_state *state)
{
    struct options *options = state->input;
    size_t wrong;
    const char *form;
    switch (key) {
    case 't':
        add_file(options->trace, &options->traces, "trace", text, TRACE_FILE_EXPECTED, trace_file_named(text), state);
        return 0;
    case 'w':
        add_file(options->wire, &options->wires, "wire", text, WIRE_FILE_EXPECTED, wire_file_named(text), state);
        return 0;
    case 'u':
        form = time_value_read(text, strlen(text), &options->until, &wrong);
        if (form)
            argp_error(state, "--until: expected %s, found '%s'", form, text);
        return 0;
    case 'j':
        options->json = true;
        return 0;
    case KEY_FORCE:
        options->output_flags |= OUTPUT_FORCE;
        return 0;
    case ARGP_KEY_ARG:
        if (options->path)
            argp_error(state, "`%s': expected one FILE only", text);
        options->path = text;
        return 0;
    case ARGP_KEY_END:
        if (!options->path)
            argp_error(state, "no recording given");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* ---- Signals and progress ------------------------------------------------------------------------------------------- */

static volatile sig_atomic_t interrupted;

static void on_signal(int number)
{
    (void)number;
    interrupted = 1;
}

struct progress {
    struct replay *replay;
    FILE *in;
    off_t size; /* 0: unknown */
    bool wanted, shown;
    unsigned steps;
    double begin, next; /* s */
};

static double seconds_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static bool update_progress(void *context)
{
    struct progress *progress = context;
    if (interrupted || !progress->wanted || ++progress->steps % STEPS_A_LOOK != 0)
        return interrupted;
    double now = seconds_now();
    if (now < progress->next)
        return false;
    progress->next = now + PROGRESS_EVERY;
    progress->shown = true;
    double virtual = (double)sim_now(replay_sim(progress->replay)) / US_PER_SECOND;
    fprintf(stderr, "\r%.1f s of the bus's time, %.0f times real time", virtual, virtual / (now - progress->begin));
    if (progress->size > 0)
        fprintf(stderr, "; %.0f %% of the recording", 100.0 * (double)ftello(progress->in) / (double)progress->size);
    fputs("; Ctrl-C ends it\033[K", stderr);
    return false;
}

static void begin_progress(struct progress *progress, struct replay *replay, FILE *in)
{
    struct stat status;
    double now = seconds_now();
    *progress = (struct progress){
        .replay = replay,
        .in = in,
        .wanted = isatty(STDERR_FILENO) != 0,
        .begin = now,
        .next = now + PROGRESS_AFTER,
    };
    if (fstat(fileno(in), &status) == 0 && S_ISREG(status.st_mode))
        progress->size = status.st_size;
}

/* ---- Traces --------------------------------------------------------------------------------------------------------- */

struct files {
    struct trace_file *trace[FILES_MAX];
    struct wire_file *wire[FILES_MAX];
};

static bool check_written(const char *path, int error)
{
    if (error != 0)
        fprintf(stderr, "rkm04 replay: cannot write %s: %s\n", path, strerror(error));
    return error == 0;
}

static bool begin_files(struct files *files, struct sim *sim, const struct options *options)
{
    char *error = NULL;
    bool ok = true;
    for (size_t i = 0; ok && i < options->traces; i++)
        ok = (files->trace[i] = trace_file_begin(sim, options->trace[i], options->output_flags, &error)) != NULL;
    for (size_t i = 0; ok && i < options->wires; i++)
        ok = (files->wire[i] = wire_file_begin(sim, options->wire[i], options->output_flags, &error)) != NULL;
    if (!ok)
        fprintf(stderr, "rkm04 replay: %s\n", error ? error : "out of memory");
    free(error);
    return ok;
}

static bool end_files(struct files *files, const struct options *options)
{
    bool ok = true;
    for (size_t i = 0; i < options->traces; i++)
        if (files->trace[i])
            ok = check_written(options->trace[i], trace_file_end(files->trace[i])) && ok;
    for (size_t i = 0; i < options->wires; i++)
        if (files->wire[i])
            ok = check_written(options->wire[i], wire_file_end(files->wire[i])) && ok;
    return ok;
}

/* ---- Report --------------------------------------------------------------------------------------------------------- */

static const char *const results[] = {
    [REPLAY_SAME] = "same",
    [REPLAY_DIFFERENT] = "different",
    [REPLAY_WRONG] = "not a recording",
    [REPLAY_INTERRUPTED] = "interrupted",
    [REPLAY_NO_MEMORY] = "out of memory",
};

static json_t *difference_json(const struct replay_difference *difference)
{
    if (!difference)
        return json_null();
    return json_pack("{s:s, s:o, s:o, s:I, s:I, s:s, s:s}", "what", difference->what, "unit",
                     difference->unit > 0 ? json_string(difference->name) : json_null(), "motor",
                     difference->motor > 0 ? json_integer(difference->motor) : json_null(), "from_us",
                     (json_int_t)difference->from, "until_us", (json_int_t)difference->until, "recorded", difference->recorded,
                     "came", difference->came);
}

static bool report_json(struct replay *replay, const char *name, enum replay_end end)
{
    struct replay_counts counts = replay_counts(replay);
    struct sim *sim = replay_sim(replay);
    json_t *file = json_string(name); /* NULL: it is not UTF-8 */
    json_t *report = json_pack("{s:o?, s:s, s:I, s:s, s:s?, s:o, s:{s:I, s:I, s:I, s:I, s:I, s:b}}", "file", file, "result",
                               results[end], "t_us",
                               sim ? (json_int_t)sim_now(sim) : 0, "text", replay_text(replay), "note", replay_note(replay),
                               "difference", difference_json(replay_difference(replay)), "counts", "lines",
                               (json_int_t)counts.lines, "inputs", (json_int_t)counts.inputs, "bytes_in",
                               (json_int_t)counts.bytes_in, "bytes_out", (json_int_t)counts.bytes_out, "pulses",
                               (json_int_t)counts.steps, "whole", (int)counts.whole);
    bool ok = report && json_dumpf(report, stdout, JSON_COMPACT) == 0 && putchar('\n') != EOF;
    json_decref(report);
    return ok;
}

static bool report_text(struct replay *replay, const char *name, enum replay_end end)
{
    struct replay_counts counts = replay_counts(replay);
    if (replay_note(replay))
        fprintf(stderr, "rkm04 replay: %s: %s\n", name, replay_note(replay));
    if (end == REPLAY_WRONG && !replay_sim(replay))
        file_guess_note_path("rkm04 replay", name);
    if (end == REPLAY_WRONG)
        return fprintf(stderr, "%s\n", replay_text(replay)) > 0;
    if (end != REPLAY_SAME && end != REPLAY_DIFFERENT)
        return fprintf(stderr, "rkm04 replay: %s: %s\n", name, replay_text(replay)) > 0;
    if (end == REPLAY_DIFFERENT)
        return printf("%s: different: %s\n", name, replay_text(replay)) > 0;
    uint64_t now = sim_now(replay_sim(replay));
    return printf("%s: the same: %" PRIu64 ".%06" PRIu64 " s, %" PRIu64 " inputs, %" PRIu64 " bytes in, %" PRIu64
                  " bytes out, %" PRIu64 " pulses\n",
                  name, now / US_PER_SECOND, now % US_PER_SECOND, counts.inputs,
                  counts.bytes_in, counts.bytes_out, counts.steps) > 0;
}

/* ---- All of it ------------------------------------------------------------------------------------------------------ */

static int run_replay(struct replay *replay, FILE *in, const char *name, const struct options *options)
{
    struct files files = {0};
    struct progress progress;
    enum replay_end end = REPLAY_WRONG;
    bool ok = true;
    begin_progress(&progress, replay, in);
    replay_until(replay, options->until);
    if (replay_sim(replay))
        ok = begin_files(&files, replay_sim(replay), options);
    if (ok)
        end = replay_run(replay, update_progress, &progress);
    if (progress.shown)
        fputs("\r\033[K", stderr);
    ok = end_files(&files, options) && ok;
    if (!ok && end == REPLAY_WRONG && replay_sim(replay))
        return STATUS_FAILURE;
    ok = (options->json ? report_json(replay, name, end) : report_text(replay, name, end)) && ok;
    if (fflush(stdout) != 0)
        ok = check_written("standard output", errno);
    return end == REPLAY_WRONG ? STATUS_USAGE : end == REPLAY_SAME && ok ? STATUS_SUCCESS : STATUS_FAILURE;
}

static bool is_folder(FILE *in)
{
    struct stat status;
    return fstat(fileno(in), &status) == 0 && S_ISDIR(status.st_mode);
}

int replay_main(int argc, char **argv)
{
    static const struct argp argp = {option_table, parse_option, "FILE", doc, NULL, NULL, NULL};
    struct options options = {.until = DEVICE_NEVER};
    arguments_parse(&argp, argc, argv, &options);
    bool is_stdin = strcmp(options.path, "-") == 0;
    const char *name = is_stdin ? "<stdin>" : options.path;
    FILE *in = is_stdin ? stdin : fopen(options.path, "re");
    if (!in || is_folder(in)) {
        fprintf(stderr, "rkm04 replay: cannot read %s: %s\n", options.path, strerror(in ? EISDIR : errno));
        return STATUS_FAILURE;
    }
    if (!output_file_spare(options.path)) {
        fputs("rkm04 replay: out of memory\n", stderr);
        return STATUS_FAILURE;
    }
    interrupt_catch(on_signal);
    struct replay *replay = replay_open(name, in);
    int status = STATUS_FAILURE;
    if (replay)
        status = run_replay(replay, in, name, &options);
    else
        fputs("rkm04 replay: out of memory\n", stderr);
    if (replay)
        replay_free(replay);
    if (!is_stdin)
        fclose(in);
    return status;
}
