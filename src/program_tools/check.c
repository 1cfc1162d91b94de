/* SPDX-License-Identifier: MIT */
#include "check.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "check_inside.h"
#include "source_texts.h"

/* ---- Names ---------------------------------------------------------------------------------------------------------- */

#define CHECK_ROW(constant, name, says) {name, says},
static const struct {
    const char *name, *says;
} warnings[] = {CHECK_TABLE(CHECK_ROW)};
#undef CHECK_ROW

const char *check_warning_name(enum check_warning warning)
{
    return warnings[warning].name;
}

const char *check_warning_text(enum check_warning warning)
{
    return warnings[warning].says;
}

enum check_warning check_warning_named(const char *name, size_t length)
{
    for (unsigned i = 0; i < CHECK_WARNINGS; i++)
        if (strlen(warnings[i].name) == length && memcmp(warnings[i].name, name, length) == 0)
            return (enum check_warning)i;
    return CHECK_WARNINGS;
}

const char *check_warning_names(void)
{
#define CHECK_NAME(constant, name, says) name ", "
    static const char names[] = CHECK_TABLE(CHECK_NAME);
#undef CHECK_NAME
    return names;
}

/* ---- Reports -------------------------------------------------------------------------------------------------------- */

static void warn(struct check *check, struct diagnostic place, enum check_warning warning, const char *hint, const char *format,
                 va_list arguments)
{
    char message[512];
    if (check->options->off >> warning & 1)
        return;
    place.severity = DIAGNOSTIC_WARNING;
    place.name = warnings[warning].name;
    vsnprintf(message, sizeof message, format, arguments);
    diagnostics_add(check->found, &place, hint, "%s", message);
}

void check_warn_at(struct check *check, struct diagnostic place, enum check_warning warning, const char *hint,
                   const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    warn(check, place, warning, hint, format, arguments);
    va_end(arguments);
}

void check_warn(struct check *check, const struct check_motor *motor, enum check_warning warning, size_t first, size_t last,
                const char *hint, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    warn(check, code_place(&motor->code, first, last), warning, hint, format, arguments);
    va_end(arguments);
}

/* ---- The check ------------------------------------------------------------------------------------------------------ */

/* Read the program of a motor: the sources for it and those for all. 0: the motors that have no source of their own. */
static bool read_motor(struct check *check, unsigned number)
{
    struct check_motor *motor = &check->motors[check->motor_count++];
    *motor = (struct check_motor){.motor = number};
    code_begin(&motor->code, check->sources, check->count);
    for (size_t i = 0; i < check->count; i++)
        if ((check->sources[i].motor == number || check->sources[i].motor == 0) && !check_read(check, motor, i))
            return false;
    return true;
}

static bool read_sources(struct check *check)
{
    unsigned given = 0; /* bit n: there is a source for motor n */
    const unsigned all = (1u << (RKM04_MOTORS + 1)) - 2;
    check->motors = calloc(RKM04_MOTORS + 1, sizeof *check->motors);
    if (check->motors == NULL)
        return false;
    for (size_t i = 0; i < check->count; i++)
        given |= 1u << check->sources[i].motor;
    for (unsigned number = 0; number <= RKM04_MOTORS; number++)
        if ((given >> number & 1) != 0 && (number > 0 || (given & all) != all) && !read_motor(check, number))
            return false;
    return true;
}

static bool check_motor_program(struct check *check, struct check_motor *motor)
{
    if (!flow_begin(&motor->flow, &motor->code, UINT16_MAX))
        return false;
    check_labels(check, motor);
    if (motor->flow.first_node == NULL)
        return true;
    check_flow(check, motor);
    check_motions(check, motor);
    check_guards(check, motor);
    return !motor->flow.no_memory;
}

static bool run_check(struct check *check)
{
    check->texts = source_texts_map(check->sources, check->count);
    if (check->texts == NULL || !read_sources(check))
        return false;
    for (size_t i = 0; i < check->motor_count; i++)
        if (!check_motor_program(check, &check->motors[i]))
            return false;
    check_outputs(check);
    if (!check_variables(check) || !check_plant(check))
        return false;
    check_nolint(check);
    return !check->found->no_memory;
}

bool check_programs(const struct program_source *sources, size_t count, const struct check_options *options,
                    struct diagnostics *found)
{
    struct check check = {.sources = sources, .count = count, .options = options, .found = found};
    *found = (struct diagnostics){0};
    bool ok = run_check(&check);
    diagnostics_arrange(found, sources);
    for (size_t i = 0; i < check.motor_count; i++) {
        flow_end(&check.motors[i].flow);
        code_free(&check.motors[i].code);
    }
    source_texts_free(check.texts, count);
    free(check.motors);
    planner_end(&check.planner);
    return ok;
}
