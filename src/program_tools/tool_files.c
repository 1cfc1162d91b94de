/* SPDX-License-Identifier: MIT */
#include "tool_files.h"

#include <err.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "check_cnc.h"
#include "check_print.h"
#include "options/options.h"

void tool_files_begin(struct tool_files *files, int argc)
{
    *files = (struct tool_files){.list = calloc((size_t)argc + 1, sizeof *files->list)};
    if (files->list == NULL)
        err(STATUS_FAILURE, "memory");
}

void tool_files_end(struct tool_files *files)
{
    for (size_t i = 0; i < files->count; i++)
        tool_file_free(&files->list[i]);
    free(files->list);
}

void tool_files_add(struct tool_files *files, const char *argument, struct argp_state *state)
{
    struct tool_file *file = &files->list[files->count];
    if (!program_argument_read(argument, RKM04_MOTORS, &file->source.motor, &file->path))
        argp_error(state, "%s: expected a motor 1 to 4, or 0 for all, before '='", argument);
    file->has_motor = file->path != argument;
    file->source.name = file->path;
    if (strcmp(file->path, "-") == 0) {
        if (files->stdin_taken)
            argp_error(state, "standard input (-) can be read only once");
        files->stdin_taken = true;
        file->source.name = "<stdin>";
    }
    files->count++;
}

bool tool_file_read(struct tool_file *file, const char *program)
{
    const char *wrong = program_text_read_raw(&file->text, file->path);
    file->source.text = file->text.text;
    file->source.length = file->text.length;
    if (wrong != NULL)
        fprintf(stderr, "%s: cannot read %s: %s\n", program, file->source.name, wrong);
    else if (!check_cnc_takes(file->source.name))
        file_guess_note(program, file->source.name, NULL, file->source.text, file->source.length);
    return wrong == NULL;
}

bool tool_check_errors(const struct program_source *sources, size_t count, const struct rkm04_readings *readings)
{
    const struct check_options options = {.off = UINT64_MAX, .readings = *readings};
    struct diagnostics found;
    struct check_printer printer;
    bool ok = check_programs(sources, count, &options, &found);
    check_print_begin(&printer, CHECK_TEXT, stderr);
    check_print(&printer, sources, &found);
    ok = check_print_end(&printer) && ok && found.errors == 0;
    diagnostics_free(&found);
    return ok;
}

void tool_file_free(struct tool_file *file)
{
    program_text_free(&file->text);
}
