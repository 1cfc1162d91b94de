/* SPDX-License-Identifier: MIT */
/* Parameters as text (AF2, AF3): sections [X] and [Y], lines `key = value`. */
#include <string.h>

#include "fields.h"

struct parameter_reader {
    struct pmc_reader reader;
    unsigned axes;
    unsigned axis;  /* of the present section; PMC_AXES: none yet */
    bool is_begun[PMC_AXES];
    struct pmc_parameters *parameters;
    unsigned line[PMC_AXES][PMC_PARAMETERS]; /* that has set it; 0: none */
    bool is_own[PMC_AXES]; /* the deceleration is a number */
};

static bool read_section(struct parameter_reader *all)
{
    struct pmc_reader *reader = &all->reader;
    struct pmc_field name = pmc_reader_field(reader, "]");
    unsigned axis = pmc_field_is(&name, "Y");
    if (!pmc_reader_take(reader, ']') || (axis == 0 && !pmc_field_is(&name, "X")))
        return pmc_reader_fail(reader, &name, "expected [X] or [Y]");
    if (axis >= all->axes)
        return pmc_reader_fail(reader, &name, "expected [X], the only axis");
    if (all->is_begun[axis])
        return pmc_reader_fail(reader, &name, "expected each section once");
    all->axis = axis;
    all->is_begun[axis] = true;
    struct pmc_field rest = pmc_reader_field(reader, "");
    return rest.length == 0 || pmc_reader_fail(reader, &rest, "expected the end of the line");
}

static const char *const expected_value[PMC_PARAMETERS] = {
    [PMC_MULTIPLIER] = "expected a number from 1 to 500",
    [PMC_DECELERATION] = "expected follow, or a number from 1 to 8000",
    [PMC_SOFT_PLUS] = "expected whole units from -8388608 to 8388607",
    [PMC_SOFT_MINUS] = "expected whole units from -8388608 to 8388607",
    [PMC_NUMERATOR] = "expected a number from 1 to 65535",
    [PMC_DENOMINATOR] = "expected a number from 1 to 65535",
    [PMC_TIMER1] = "expected ms from 0 to 65535",
    [PMC_TIMER2] = "expected ms from 0 to 65535",
    [PMC_TIMER3] = "expected ms from 0 to 65535",
    [PMC_HOME_OFFSET] = "expected pulses from 0 to 8388607",
    [PMC_FLAGS] = "expected 0x and four hexadecimal digits, up to 0x01FF",
    [PMC_STEPS] = "expected 0x and four hexadecimal digits, up to 0x1FFF",
    [PMC_END_PULSE_WIDTH] = "expected a number from 1 to 65535",
    [PMC_JERK] = "expected a number from 1 to 65535",
};
static const char expected_rate[] = "expected a number from 1 to 8000";

static bool read_value(const struct pmc_parameter_row *row, const struct pmc_field *field, int32_t *value)
{
    return row->is_bits ? pmc_field_bits(field, row->high, value) : pmc_field_number(field, row->low, row->high, value);
}

static bool read_parameter(struct parameter_reader *all, const struct pmc_field *key, unsigned which)
{
    struct pmc_reader *reader = &all->reader;
    if (!pmc_reader_take(reader, '=')) {
        struct pmc_field found = pmc_reader_field(reader, "");
        return pmc_reader_fail(reader, &found, "expected =");
    }
    struct pmc_field field = pmc_reader_field(reader, ""), rest = pmc_reader_field(reader, "");
    struct pmc_parameters *parameters = &all->parameters[all->axis];
    bool follows = which == PMC_DECELERATION && pmc_field_is(&field, "follow");
    if (all->line[all->axis][which] != 0)
        return pmc_reader_fail(reader, key, "expected each key once in a section");
    if (!follows && !read_value(&pmc_parameter_rows[which], &field, &parameters->value[which]))
        return pmc_reader_fail(reader, &field, expected_value[which] ? expected_value[which] : expected_rate);
    if (rest.length != 0)
        return pmc_reader_fail(reader, &rest, "expected the end of the line");
    all->line[all->axis][which] = reader->line;
    all->is_own[all->axis] = all->is_own[all->axis] || (which == PMC_DECELERATION && !follows);
    return true;
}

static bool read_line(struct parameter_reader *all)
{
    struct pmc_reader *reader = &all->reader;
    if (pmc_reader_take(reader, '['))
        return read_section(all);
    struct pmc_field key = pmc_reader_field(reader, "=");
    if (key.length == 0 && !pmc_reader_take(reader, '='))
        return true; /* an empty line */
    if (all->axis == PMC_AXES)
        return pmc_reader_fail(reader, &key, "expected a section, [X] or [Y], before the first key");
    for (unsigned which = 0; which < PMC_PARAMETERS; which++)
        if (pmc_field_is(&key, pmc_parameter_rows[which].key))
            return read_parameter(all, &key, which);
    return pmc_reader_fail(reader, &key, "expected a key as in the canonical form, multiplier to jerk");
}

/* Flag 4 goes by `deceleration`, and must agree with it where `flags` is there. */
static void agree(struct parameter_reader *all, unsigned axis)
{
    const unsigned *line = all->line[axis];
    int32_t *flags = &all->parameters[axis].value[PMC_FLAGS];
    bool is_own = all->is_own[axis];
    if (line[PMC_FLAGS] == 0) {
        *flags = is_own ? *flags | PMC_FLAG_DECELERATION : *flags & ~PMC_FLAG_DECELERATION;
    } else if (is_own != ((*flags & PMC_FLAG_DECELERATION) != 0)) {
        const struct pmc_field place = {NULL, 0, 1};
        all->reader.line = line[PMC_FLAGS];
        pmc_reader_fail(&all->reader, &place, is_own ? "expected 0x0010 in flags, as deceleration is a number"
                                                     : "expected flags without 0x0010, as deceleration follows");
    }
}

bool pmc_parameters_read(const char *text, size_t length, unsigned axes, struct pmc_parameters parameters[PMC_AXES],
                         pmc_text_report *report, void *context)
{
    struct parameter_reader all = {.reader = {.text = text, .length = length, .report = report, .context = context},
                                   .axes = axes, .axis = PMC_AXES, .parameters = parameters};
    for (unsigned axis = 0; axis < PMC_AXES; axis++)
        pmc_parameters_clear(&parameters[axis]);
    while (pmc_reader_next(&all.reader))
        (void)read_line(&all);
    for (unsigned axis = 0; axis < axes; axis++)
        agree(&all, axis);
    return !all.reader.is_wrong;
}

/* ---- Writing ------------------------------------------------------------------------------------------------------------ */

static void write_parameter(struct pmc_writer *writer, const struct pmc_parameters *parameters, unsigned which)
{
    const struct pmc_parameter_row *row = &pmc_parameter_rows[which];
    int32_t value = parameters->value[which];
    pmc_write(writer, row->key);
    pmc_write(writer, " = ");
    if (which == PMC_DECELERATION && (parameters->value[PMC_FLAGS] & PMC_FLAG_DECELERATION) == 0)
        pmc_write(writer, "follow");
    else if (row->is_bits)
        pmc_write_bits(writer, value);
    else
        pmc_write_number(writer, value, 1);
    pmc_write(writer, "\n");
}

size_t pmc_parameters_write(const struct pmc_parameters *const parameters[PMC_AXES], unsigned axes, char *text, size_t room)
{
    struct pmc_writer writer = {.text = text, .room = room};
    for (unsigned axis = 0; axis < axes; axis++) {
        pmc_write(&writer, axis == 0 ? "[X]\n" : "\n[Y]\n");
        for (unsigned which = 0; which < PMC_PARAMETERS; which++)
            write_parameter(&writer, parameters[axis], which);
    }
    return writer.length;
}
