/* SPDX-License-Identifier: MIT */
/* A trace has the pulses, not the plan: speeds are means over a few milliseconds. */
#include "read_trace.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "text/text.h"

#define MEAN_OVER 4000.0 /* us, or two pulses if that is longer */
#define HEADER "t_us,source,event,value"

struct reader {
    struct plot_curves *curves;
    const char *name, *unit;
    FILE *errors;
    size_t line;
    uint64_t us; /* of the last row */
    struct {
        double since, last;      /* us of the pulse that the present mean begins with, < 0: none yet; of the last one */
        double from, position;   /* counter there, now */
    } motor[PLOT_MOTORS];
};

struct row {
    const char *line;
    double us;
    const char *source, *event, *value;
};

static bool is_wrong(struct reader *reader, size_t column, const char *expected)
{
    fprintf(reader->errors, "%s:%zu:%zu: error: expected %s\n", reader->name, reader->line, column, expected);
    return false;
}

/* ---- Pulses ----------------------------------------------------------------------------------------------------------- */

static void end_mean(struct reader *reader, unsigned i, double us)
{
    struct plot_motor *motor = &reader->curves->motor[i];
    double since = reader->motor[i].since, way = reader->motor[i].position - reader->motor[i].from;
    if (us > since && way != 0)
        plot_add_point(reader->curves, motor,
                       (struct plot_point){(since + us) / 2, way * 1e6 / (us - since), reader->motor[i].from + way / 2});
    reader->motor[i].since = us;
    reader->motor[i].from = reader->motor[i].position;
}

static void add_rest(struct reader *reader, unsigned i, double us)
{
    plot_add_point(reader->curves, &reader->curves->motor[i], (struct plot_point){us, 0, reader->motor[i].position});
}

static void take_step(struct reader *reader, unsigned i, double us, double position)
{
    bool first = reader->motor[i].since < 0;
    reader->motor[i].position = position;
    if (first) {
        reader->motor[i].since = us;
        reader->motor[i].from = position;
    } else if (us - reader->motor[i].since >= MEAN_OVER && reader->motor[i].last > reader->motor[i].since) {
        end_mean(reader, i, us);
    }
    reader->motor[i].last = us;
}

static void take_motion(struct reader *reader, unsigned i, double us, bool begins)
{
    struct plot_motor *motor = &reader->curves->motor[i];
    if (!begins && reader->motor[i].since >= 0)
        end_mean(reader, i, reader->motor[i].last);
    add_rest(reader, i, us);
    reader->motor[i].since = -1;
    plot_mark_motion(reader->curves, motor, us, begins);
}

/* ---- Rows ------------------------------------------------------------------------------------------------------------- */

static bool take_motor(struct reader *reader, const struct row *row, unsigned number)
{
    int64_t value;
    unsigned i = number - 1;
    if (number > reader->curves->motors)
        reader->curves->motors = number;
    if (strcmp(row->event, "motion") == 0) {
        take_motion(reader, i, row->us, strcmp(row->value, "begin") == 0);
        return true;
    }
    if (strcmp(row->event, "step") != 0 && strcmp(row->event, "position") != 0)
        return true;
    if (!number_read_signed(row->value, INT32_MIN, INT32_MAX, &value))
        return is_wrong(reader, (size_t)(row->value - row->line) + 1, "a position");
    if (strcmp(row->event, "step") == 0) {
        take_step(reader, i, row->us, (double)value);
    } else {
        if (reader->motor[i].since >= 0)
            end_mean(reader, i, reader->motor[i].last);
        reader->motor[i].since = -1;
        add_rest(reader, i, row->us);
        reader->motor[i].position = (double)value;
        add_rest(reader, i, row->us);
    }
    return true;
}

static void take_mask(struct reader *reader, const struct row *row)
{
    static const char *const names[PLOT_MASKS] = {"di", "do", "var"};
    int64_t value;
    for (unsigned mask = 0; mask < PLOT_MASKS; mask++)
        if (strcmp(row->event, names[mask]) == 0 && number_read_signed(row->value, INT32_MIN, INT32_MAX, &value))
            plot_add_level(reader->curves, mask, row->us, (uint32_t)value);
}

/* Is the row about the unit that is meant? Cuts its name off. */
static bool is_meant(const struct reader *reader, struct row *row)
{
    const char *dot = strchr(row->source, '.');
    if (dot == NULL)
        return true;
    size_t length = (size_t)(dot - row->source);
    bool meant = reader->unit != NULL && strlen(reader->unit) == length && strncmp(row->source, reader->unit, length) == 0;
    row->source = dot + 1;
    return meant;
}

static bool take_row(struct reader *reader, char *line)
{
    uint64_t us, number;
    char *part[4];
    part[0] = line;
    for (unsigned i = 1; i < 4; i++) {
        part[i] = strchr(part[i - 1], ',');
        if (part[i] == NULL)
            return is_wrong(reader, (size_t)(part[i - 1] - line) + 1, "a row of four columns: " HEADER);
        *part[i]++ = '\0';
    }
    if (!number_read(part[0], 0, TIME_VALUE_MAX, &us))
        return is_wrong(reader, 1, "a time in us");
    if (us < reader->us) {
        char expected[96];
        snprintf(expected, sizeof expected, "a time of %" PRIu64 " us or later, as in the row before", reader->us);
        return is_wrong(reader, 1, expected);
    }
    reader->us = us;
    struct row row = {line, (double)us, part[1], part[2], part[3]};
    if (strchr(row.source, '.') != NULL && reader->unit == NULL)
        return is_wrong(reader, (size_t)(part[1] - line) + 1, "a trace of one unit: choose one of them with --unit");
    if (row.us > reader->curves->end)
        reader->curves->end = row.us;
    if (!is_meant(reader, &row))
        return true;
    if (row.source[0] == 'm' && number_read(row.source + 1, 1, PLOT_MOTORS, &number))
        return take_motor(reader, &row, (unsigned)number);
    take_mask(reader, &row);
    return true;
}

static bool read_rows(struct reader *reader, FILE *in)
{
    char *line = NULL;
    size_t room = 0;
    ssize_t length;
    bool is_right = true;
    while (is_right && (length = getline(&line, &room, in)) >= 0) {
        reader->line++;
        while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == '\r'))
            line[--length] = '\0';
        if (reader->line == 1)
            is_right = strcmp(line, HEADER) == 0 || is_wrong(reader, 1, "a trace as CSV, which begins with " HEADER);
        else
            is_right = take_row(reader, line);
    }
    free(line);
    if (is_right && reader->line == 0)
        is_right = is_wrong(reader, 1, "a trace as CSV, which begins with " HEADER);
    return is_right;
}

bool plot_read_trace(struct plot_curves *curves, const char *name, FILE *in, const char *unit, FILE *errors)
{
    struct reader reader = {.curves = curves, .name = name, .unit = unit, .errors = errors};
    curves->from_pulses = true;
    curves->mask[PLOT_INPUTS].first = curves->mask[PLOT_OUTPUTS].first = 1;
    curves->mask[PLOT_VARIABLES].first = 80;
    for (unsigned mask = 0; mask < PLOT_MASKS; mask++)
        plot_add_level(curves, mask, 0, 0);
    for (unsigned i = 0; i < PLOT_MOTORS; i++)
        reader.motor[i].since = -1;
    if (!read_rows(&reader, in))
        return false;
    for (unsigned i = 0; i < curves->motors; i++) {
        if (reader.motor[i].since >= 0)
            end_mean(&reader, i, reader.motor[i].last);
        else
            add_rest(&reader, i, curves->end);
        plot_mark_motion(curves, &curves->motor[i], curves->end, false);
        curves->motor[i].is_used = curves->motor[i].motions > 0;
    }
    return true;
}
