/* SPDX-License-Identifier: MIT */
#include "test_case.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <rkm04/limits.h>

#include "file/file.h"
#include "text/text.h"

#define TEXT_MAX ((size_t)4 << 20)                    /* bytes of a scenario */
#define FILE_MAX ((size_t)DEVICE_FILE_MIB_MAX << 20) /* bytes of a file that it names */
#define FIRST_ROOM 4096
#define PROGRESS_AFTER 0.5 /* s */
#define PROGRESS_EVERY 0.2

static volatile sig_atomic_t interrupted;

void test_case_interrupt(int signal_number)
{
    (void)signal_number;
    interrupted = 1;
}

bool test_case_interrupted(void)
{
    return interrupted != 0;
}

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

/* Read all of `file`, which is not to be overwritten. Returns a text with a zero after it, to be freed, or NULL and why. */
static char *read_stream(FILE *file, const char *path, size_t *length, const char **why)
{
    char *text = NULL;
    *length = 0;
    for (size_t room = FIRST_ROOM; room <= 2u * FILE_MAX; room *= 2) {
        char *grown = realloc(text, room);
        if (grown == NULL)
            break;
        text = grown;
        *length += fread(text + *length, 1, room - *length, file);
        if (ferror(file)) {
            *why = strerror(errno);
            free(text);
            return NULL;
        }
        if (*length == room)
            continue;
        text[*length] = '\0';
        if (output_file_spare(path))
            return text;
        *why = strerror(ENOMEM);
        free(text);
        return NULL;
    }
    *why = "it is too large";
    free(text);
    return NULL;
}

static char *read_file(void *context, const char *path, size_t *length, const char **why)
{
    (void)context;
    FILE *file = fopen(path, "rb");
    if (file == NULL) {
        *why = strerror(errno);
        return NULL;
    }
    char *text = read_stream(file, path, length, why);
    fclose(file);
    return text;
}

int test_case_read(struct test_case *test, const char *path, const struct device_arguments *device)
{
    const struct scenario_files files = {.read = read_file,
                                         .map = program_text_map,
                                         .device = device->kind,
                                         .config = &device->config};
    bool standard = strcmp(path, "-") == 0;
    const char *why = "";
    size_t length;
    *test = (struct test_case){.file = standard ? "<stdin>" : path};
    char *text = standard ? read_stream(stdin, path, &length, &why) : read_file(NULL, path, &length, &why);
    if (text != NULL && length > TEXT_MAX) {
        free(text);
        text = NULL;
        why = "it is too large";
    }
    if (text == NULL) {
        fprintf(stderr, "rkm04 test: cannot read %s: %s\n", test->file, why);
        return STATUS_FAILURE;
    }
    test->scenario = scenario_read(test->file, text, length, &files, stderr);
    if (test->scenario == NULL)
        file_guess_note("rkm04 test", test->file, "a scenario", text, length);
    free(text);
    return test->scenario != NULL ? STATUS_SUCCESS : STATUS_USAGE;
}

const char *test_case_name(const struct test_case *test)
{
    const char *name = test->scenario != NULL ? scenario_name(test->scenario) : NULL;
    return name != NULL && name[0] != '\0' ? name : test->file;
}

static void free_readings(struct test_readings *under)
{
    for (size_t i = 0; under != NULL && i < under->variants; i++)
        scenario_result_free(&under->variant[i].result);
    if (under != NULL)
        free(under->variant);
    free(under);
}

void test_case_free(struct test_case *test)
{
    scenario_free(test->scenario);
    scenario_result_free(&test->result);
    free(test->record);
    free_readings(test->under);
    *test = (struct test_case){0};
}

/* ---- Records -------------------------------------------------------------------------------------------------------- */

/* The name of the file without folder and suffix. */
static const char *base_name(const struct test_case *test, int *length)
{
    const char *slash = strrchr(test->file, '/'), *base = slash != NULL ? slash + 1 : test->file;
    if (strcmp(base, "<stdin>") == 0)
        base = "stdin";
    const char *dot = strrchr(base, '.');
    *length = dot != NULL && dot != base ? (int)(dot - base) : (int)strlen(base);
    return base;
}

bool test_case_alike(const struct test_case *left, const struct test_case *right)
{
    int left_length, right_length;
    const char *left_base = base_name(left, &left_length), *right_base = base_name(right, &right_length);
    return left_length == right_length && memcmp(left_base, right_base, (size_t)left_length) == 0;
}

static char *record_path(const struct test_case *test, const char *folder, unsigned number)
{
    int length;
    const char *base = base_name(test, &length);
    char *path, suffix[16] = "";
    if (number > 1)
        snprintf(suffix, sizeof suffix, "-%u", number);
    return asprintf(&path, "%s/%.*s%s.record", folder, length, base, suffix) < 0 ? NULL : path;
}

/* Returns false if it did not work; *why as output_file_open(). */
static bool write_record(const char *path, unsigned flags, const char *text, size_t length, char **why)
{
    FILE *file = output_file_open(path, &output_recording, flags | OUTPUT_MAY_WAIT, why);
    if (file == NULL)
        return false;
    bool ok = fwrite(text, 1, length, file) == length;
    ok = output_file_close(file) == 0 && ok;
    if (!ok)
        *why = strdup(strerror(errno));
    return ok && output_file_spare(path); /* from the others of the run */
}

static bool store_recording(struct test_case *test, const char *folder, unsigned flags, unsigned number, const char *text,
                            size_t length)
{
    char *path = record_path(test, folder, number), *why = NULL;
    if (test->result.record_error == 0 && path != NULL && write_record(path, flags, text, length, &why)) {
        /* as one would write it */
        test->record = strncmp(path, "./", 2) == 0 ? strdup(path + 2) : strdup(path);
        free(path);
        return true;
    }
    fprintf(stderr, "rkm04 test: cannot write the recording %s: %s\n", path != NULL ? path : "",
            why != NULL ? why : strerror(test->result.record_error != 0 ? test->result.record_error : ENOMEM));
    free(path);
    free(why);
    return false;
}

/* ---- The run -------------------------------------------------------------------------------------------------------- */

static double seconds_now(void)
{
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + (double)time.tv_nsec * 1e-9;
}

static void show_progress(struct test_progress *progress, uint64_t tick)
{
    double real = seconds_now();
    if (!progress->wanted || real < progress->next)
        return;
    double virtual = (double)tick / US_PER_SECOND;
    progress->next = real + PROGRESS_EVERY;
    progress->shown = true;
    fprintf(stderr, "\r%zu of %zu: %.60s: %.1f s of the units' time; Ctrl-C ends the run\033[K", progress->at, progress->count,
            test_case_name(progress->test), virtual);
}

static bool on_turn(void *context, uint64_t tick)
{
    show_progress(context, tick);
    return interrupted != 0;
}

static enum test_outcome run_once(struct test_case *test, FILE *out, struct scenario_result *result,
                                  struct test_progress *progress)
{
    static const enum test_outcome outcomes[] = {
        [SCENARIO_PASSED] = TEST_PASSED,
        [SCENARIO_FAILED] = TEST_FAILED,
        [SCENARIO_INTERRUPTED] = TEST_NOT_RUN,
        [SCENARIO_NO_MEMORY] = TEST_BROKEN,
    };
    double begin = seconds_now();
    progress->test = test;
    progress->next = begin + PROGRESS_AFTER;
    enum test_outcome outcome = outcomes[scenario_run(test->scenario, out, on_turn, progress, result)];
    test->seconds += seconds_now() - begin;
    if (progress->shown)
        fputs("\r\033[K", stderr);
    progress->shown = false;
    return outcome;
}

enum test_outcome test_case_try(struct test_case *test, struct scenario_result *result, struct test_progress *progress)
{
    return run_once(test, NULL, result, progress);
}

bool test_case_run(struct test_case *test, const char *folder, unsigned flags, unsigned number, struct test_progress *progress)
{
    char *record = NULL;
    size_t length = 0;
    bool ok = true;
    FILE *out = folder != NULL ? open_memstream(&record, &length) : NULL;
    test->outcome = run_once(test, out, &test->result, progress);
    if (out != NULL && fclose(out) != 0)
        test->result.record_error = errno;
    if (test->outcome == TEST_FAILED && folder != NULL)
        ok = store_recording(test, folder, flags, number, record, length);
    free(record);
    return ok;
}
