/* SPDX-License-Identifier: MIT */
#include "exec_inputs.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/limits.h>

#include "file/file.h"
#include "options/options.h"

/* How texts are checked. */
struct check {
    const struct device_kind *device;
    const struct device_config *config;
};

/* ---- Command line --------------------------------------------------------------------------------------------------- */

bool exec_inputs_begin(struct exec_inputs *inputs, const char *command, int argc)
{
    *inputs = (struct exec_inputs){.command = command, .program = calloc((size_t)argc, sizeof *inputs->program)};
    if (inputs->program == NULL)
        fprintf(stderr, "%s: %s\n", command, strerror(ENOMEM));
    return inputs->program != NULL;
}

static void take_path(struct exec_inputs *inputs, const char *path, struct argp_state *state)
{
    if (strcmp(path, "-") != 0)
        return;
    if (inputs->stdin_taken)
        argp_error(state, "standard input (-) can be read only once");
    inputs->stdin_taken = true;
}

void exec_inputs_argument(struct exec_inputs *inputs, const char *text)
{
    inputs->program[inputs->programs++].argument = text;
}

void exec_inputs_stimulus(struct exec_inputs *inputs, const char *path)
{
    inputs->stimulus = path;
}

void exec_inputs_complete(struct exec_inputs *inputs, const struct device_kind *device, struct argp_state *state)
{
    for (size_t i = 0; i < inputs->programs; i++) {
        struct exec_program *program = &inputs->program[i];
        if (!program_argument_read(program->argument, device->axes, &program->motor, &program->path))
            argp_error(state, "%s: expected a motor 1 to %u, or 0 for all, before '='", program->argument, device->axes);
        if (device->is_program_whole && program->path == program->argument)
            program->motor = 0;
        if (device->is_program_whole && program->motor != 0)
            argp_error(state, "%s: a program of the device %s is for all motors: expected none before '='", program->argument,
                       device->name);
        take_path(inputs, program->path, state);
    }
    if (inputs->programs > 0 && !device->set_text)
        argp_error(state, "the device %s takes no texts: expected --stimulus", device->name);
    if (inputs->stimulus)
        take_path(inputs, inputs->stimulus, state);
}

bool exec_inputs_are_none(const struct exec_inputs *inputs)
{
    return inputs->programs == 0 && inputs->stimulus == NULL;
}

/* ---- Texts ---------------------------------------------------------------------------------------------------------- */

/* Read a file, "-" for standard input, which is not to be overwritten. */
static bool read_file(const struct exec_inputs *inputs, struct exec_file *file, const char *path)
{
    file->name = strcmp(path, "-") == 0 ? "<stdin>" : path;
    const char *wrong = program_text_read(&file->text, path);
    if (wrong != NULL)
        fprintf(stderr, "%s: cannot read %s: %s\n", inputs->command, file->name, wrong);
    else if (!output_file_spare(path))
        fprintf(stderr, "%s: %s\n", inputs->command, wrong = strerror(ENOMEM));
    else
        file_guess_note(inputs->command, file->name, NULL, file->text.text, file->text.length);
    return wrong == NULL;
}

/* Report all that a unit refuses. Returns false if there is something. */
static bool check_text(const struct check *check, const char *name, const char *text, size_t length)
{
    return !check->device->check_text || !check->device->check_text(check->config, name, text, length, stderr);
}

static bool read_programs(struct exec_inputs *inputs, const struct check *check)
{
    bool is_right = true;
    for (size_t i = 0; i < inputs->programs; i++) {
        struct exec_file *file = &inputs->program[i].file;
        if (!read_file(inputs, file, inputs->program[i].path) ||
            !check_text(check, file->name, file->text.text, file->text.length))
            is_right = false;
    }
    return is_right;
}

/* Report what is wrong with a text that is in the middle of a file, by its place in the file. */
static bool check_set(const struct check *check, const struct stimulus *s, const char *name)
{
    size_t before = s->line - 1 + s->column - 1;
    char *padded = malloc(before + s->length + 1);
    if (padded == NULL)
        return false;
    memset(padded, '\n', s->line - 1);
    memset(padded + s->line - 1, ' ', s->column - 1);
    memcpy(padded + before, s->data, s->length);
    bool is_right = check_text(check, name, padded, before + s->length);
    free(padded);
    return is_right;
}

static bool is_refused(const struct check *check, const struct stimulus *s)
{
    return check->device->check_text &&
           check->device->check_text(check->config, NULL, (const char *)s->data, s->length, NULL);
}

static bool read_stimuli(struct exec_inputs *inputs, const struct check *check)
{
    struct exec_file *file = &inputs->stimulus_file;
    if (!read_file(inputs, file, inputs->stimulus))
        return false;
    int errors = stimuli_read(&inputs->stimuli, check->device, file->name, file->text.text, file->text.length, stderr);
    if (errors < 0)
        fprintf(stderr, "%s: %s\n", inputs->command, strerror(ENOMEM));
    bool is_right = errors == 0;
    for (size_t i = 0; i < inputs->stimuli.count; i++) {
        const struct stimulus *s = &inputs->stimuli.list[i];
        if (s->kind == STIMULUS_SET && is_refused(check, s) && !check_set(check, s, file->name))
            is_right = false;
    }
    return is_right;
}

bool exec_inputs_read(struct exec_inputs *inputs, const struct device_kind *device, const struct device_config *config)
{
    const struct check check = {device, config};
    bool programs = read_programs(inputs, &check);
    return (inputs->stimulus == NULL || read_stimuli(inputs, &check)) && programs;
}

/* ---- Run ------------------------------------------------------------------------------------------------------------ */

void exec_inputs_store(const struct exec_inputs *inputs, struct exec_run *run)
{
    for (size_t i = 0; i < inputs->programs; i++) {
        const struct exec_program *program = &inputs->program[i];
        const struct exec_file *file = &program->file;
        exec_run_set(run, program->motor, file->text.text, file->text.length, file->name);
    }
}

void exec_inputs_free(struct exec_inputs *inputs)
{
    for (size_t i = 0; i < inputs->programs; i++)
        program_text_free(&inputs->program[i].file.text);
    free(inputs->program);
    program_text_free(&inputs->stimulus_file.text);
    stimuli_free(&inputs->stimuli);
}
