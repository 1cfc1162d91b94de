/* SPDX-License-Identifier: MIT */
/* Programs and parameters of a PMC as texts: checked, loaded, written. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pmc_device.h"
#include "text/text.h"

/* What a text says. */
struct content {
    struct pmc_command program[PMC_AXES][PMC_REGISTERS];
    struct pmc_parameters parameters[PMC_AXES];
};

static bool read_text(struct content *content, enum pmc_file what, unsigned axes, const char *text, size_t length,
                      pmc_text_report *report, void *context)
{
    if (what == PMC_FILE_PROGRAM)
        return pmc_program_read(text, length, axes, content->program, report, context);
    return pmc_parameters_read(text, length, axes, content->parameters, report, context);
}

struct printing {
    FILE *out;
    const char *name;
    struct error_lines lines;
};

static void print_error(void *context, const struct pmc_text_error *error)
{
    struct printing *printing = context;
    if (!error_lines_add(&printing->lines))
        return;
    fprintf(printing->out, "%s:%u:%u: %s: %s\n", printing->name, error->line, error->column,
            error->is_warning ? "warning" : "error", error->text);
}

bool pmc_file_is_wrong(enum pmc_file what, unsigned axes, const char *name, const char *text, size_t length, FILE *out)
{
    struct content content;
    struct printing printing = {.out = out, .name = name};
    const bool is_right = read_text(&content, what, axes, text, length, out ? print_error : NULL, &printing);
    if (out)
        error_lines_end(&printing.lines, name, out);
    return !is_right;
}

/* Keep the first error. */
static void keep_error(void *context, const struct pmc_text_error *error)
{
    char *text = context;
    if (!error->is_warning && text[0] == '\0')
        snprintf(text, DEVICE_ERROR_SIZE, "%u:%u: %s", error->line, error->column, error->text);
}

enum pmc_answer pmc_file_load(struct pmc_unit *unit, enum pmc_file what, const char *text, size_t length,
                              char error[DEVICE_ERROR_SIZE])
{
    struct content content;
    unsigned axes = unit->config.axes;
    enum pmc_answer answer = PMC_OK;
    error[0] = '\0';
    if (!read_text(&content, what, axes, text, length, keep_error, error))
        return PMC_RANGE;
    for (unsigned axis = 0; axis < axes; axis++)
        if (pmc_is_busy(unit, axis))
            answer = PMC_BUSY;
    for (unsigned axis = 0; axis < axes && answer == PMC_OK; axis++)
        answer = what == PMC_FILE_PROGRAM ? pmc_set_program(unit, axis, content.program[axis])
                                          : pmc_set_parameters(unit, axis, &content.parameters[axis]);
    return answer;
}

char *pmc_file_text(const struct pmc_unit *unit, enum pmc_file what)
{
    size_t room = PMC_PROGRAM_TEXT_MAX, length;
    char *text = malloc(room + 1u);
    const struct pmc_command *const program[PMC_AXES] = {unit->axis[0].program, unit->axis[1].program};
    const struct pmc_parameters *const parameters[PMC_AXES] = {&unit->axis[0].parameters, &unit->axis[1].parameters};
    if (!text)
        return NULL;
    if (what == PMC_FILE_PROGRAM)
        length = pmc_program_write(program, unit->config.axes, text, room);
    else
        length = pmc_parameters_write(parameters, unit->config.axes, text, room);
    text[length < room ? length : room] = '\0';
    return text;
}
