/* SPDX-License-Identifier: MIT */
/* Programs as text (AF1, AF3): a register a line, `[X: |Y: ]REG COMMAND operands [# comment]`. */
#include <string.h>

#include "fields.h"

#define MS_MAX 65535
#define COUNT_MAX 255
#define REG_LAST 63

/* ---- Operands ----------------------------------------------------------------------------------------------------------- */

/* An operand of a command: its text becomes a member of the command. */
struct operand {
    uint16_t bit;         /* of struct pmc_command_row */
    bool may_be_missing;
    const char *expected;
    bool (*read)(const struct pmc_field *field, struct pmc_command *command);
    void (*write)(struct pmc_writer *writer, const struct pmc_command *command);
};

/* A prefix and a number, V1. */
static bool read_numbered(const struct pmc_field *field, const char *prefix, int32_t low, int32_t high, int32_t *number)
{
    size_t length = strlen(prefix);
    if (field->length != length + 1u || memcmp(field->text, prefix, length) != 0)
        return false;
    const struct pmc_field digit = {field->text + length, 1, 0};
    return pmc_field_number(&digit, low, high, number);
}

static void write_numbered(struct pmc_writer *writer, const char *prefix, int32_t number)
{
    pmc_write(writer, prefix);
    pmc_write_number(writer, number, 1);
}

static bool read_value(const struct pmc_field *field, struct pmc_command *command)
{
    return pmc_field_tenths(field, &command->value);
}

static void write_value(struct pmc_writer *writer, const struct pmc_command *command)
{
    pmc_write(writer, " ");
    pmc_write_tenths(writer, command->value);
}

static bool read_speed(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = read_numbered(field, "V", 1, 4, &number);
    command->speed = (uint8_t)number;
    return is_right;
}

static void write_speed(struct pmc_writer *writer, const struct pmc_command *command)
{
    write_numbered(writer, " V", command->speed);
}

static bool read_dwell(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    if (read_numbered(field, "T", 1, 3, &number)) {
        command->number = (uint8_t)number;
        return true;
    }
    bool is_right = pmc_field_number(field, 0, MS_MAX, &number);
    command->ms = (uint16_t)number;
    return is_right;
}

static void write_dwell(struct pmc_writer *writer, const struct pmc_command *command)
{
    if (command->number != 0)
        write_numbered(writer, " T", command->number);
    else if (command->ms != 0)
        write_numbered(writer, " ", command->ms);
}

static bool read_input(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = read_numbered(field, "IN", 0, 1, &number);
    command->number = (uint8_t)number;
    return is_right;
}

static void write_input(struct pmc_writer *writer, const struct pmc_command *command)
{
    write_numbered(writer, " IN", command->number);
}

static bool read_output(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = read_numbered(field, "OUT", 0, 1, &number);
    command->number = (uint8_t)number;
    return is_right;
}

static void write_output(struct pmc_writer *writer, const struct pmc_command *command)
{
    write_numbered(writer, " OUT", command->number);
}

static bool read_state(const struct pmc_field *field, struct pmc_command *command)
{
    command->argument = pmc_field_is(field, "ON");
    return command->argument == 1 || pmc_field_is(field, "OFF");
}

static void write_state(struct pmc_writer *writer, const struct pmc_command *command)
{
    pmc_write(writer, command->argument == 1 ? " ON" : " OFF");
}

static bool read_target(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = pmc_field_number(field, 0, REG_LAST, &number);
    command->argument = (uint8_t)number;
    return is_right;
}

static void write_target(struct pmc_writer *writer, const struct pmc_command *command)
{
    pmc_write(writer, " ");
    pmc_write_number(writer, command->argument, 2);
}

static bool read_count(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = pmc_field_number(field, 1, COUNT_MAX, &number);
    command->argument = (uint8_t)number;
    return is_right;
}

static void write_count(struct pmc_writer *writer, const struct pmc_command *command)
{
    write_numbered(writer, " ", command->argument);
}

static bool read_ms(const struct pmc_field *field, struct pmc_command *command)
{
    int32_t number = 0;
    bool is_right = pmc_field_number(field, 1, MS_MAX, &number);
    command->ms = (uint16_t)number;
    return is_right;
}

static void write_ms(struct pmc_writer *writer, const struct pmc_command *command)
{
    write_numbered(writer, " ", command->ms);
}

static bool read_wait(const struct pmc_field *field, struct pmc_command *command)
{
    command->wait = pmc_field_is(field, "WAIT");
    return command->wait;
}

static void write_wait(struct pmc_writer *writer, const struct pmc_command *command)
{
    pmc_write(writer, command->wait ? " WAIT" : "");
}

/* In the order in which they stand. */
static const struct operand operands[] = {
    {PMC_OPERAND_VALUE, false, "expected a value from -8388608 to 8388607, with one decimal place at most", read_value,
     write_value},
    {PMC_OPERAND_SPEED, false, "expected a speed, V1 to V4", read_speed, write_speed},
    {PMC_OPERAND_DWELL, true, "expected a dwell of 0 to 65535 ms, T1 to T3, or the end of the line", read_dwell, write_dwell},
    {PMC_OPERAND_INPUT, false, "expected IN0 or IN1", read_input, write_input},
    {PMC_OPERAND_OUTPUT, false, "expected OUT0 or OUT1", read_output, write_output},
    {PMC_OPERAND_STATE, false, "expected ON or OFF", read_state, write_state},
    {PMC_OPERAND_TARGET, false, "expected a register from 0 to 63", read_target, write_target},
    {PMC_OPERAND_COUNT, false, "expected a count from 1 to 255", read_count, write_count},
    {PMC_OPERAND_MS, false, "expected a time from 1 to 65535 ms", read_ms, write_ms},
    {PMC_OPERAND_WAIT, true, "expected WAIT or the end of the line", read_wait, write_wait},
};

#define OPERANDS (sizeof operands / sizeof operands[0])

/* ---- Reading ------------------------------------------------------------------------------------------------------------ */

/* What was seen of an axis, for the warnings. */
struct seen {
    unsigned last;                  /* line of the last command; 0: none */
    unsigned line[PMC_REGISTERS];   /* line of a register; 0: it is not named */
};

struct program_reader {
    struct pmc_reader reader;
    unsigned axes;
    struct pmc_command (*program)[PMC_REGISTERS];
    struct seen seen[PMC_AXES];
};

static bool read_reg(const struct pmc_field *field, int32_t *reg)
{
    return field->length >= 1 && field->length <= 2 && field->text[0] != '+' && field->text[0] != '-' &&
           pmc_field_number(field, 0, REG_LAST, reg);
}

/* The axis of a line, and the field that follows. Returns false if the axis is wrong. */
static bool read_axis(struct program_reader *all, struct pmc_field *field, unsigned *axis)
{
    bool is_named = pmc_field_is(field, "X:") || pmc_field_is(field, "Y:");
    *axis = pmc_field_is(field, "Y:");
    if (*axis >= all->axes)
        return pmc_reader_fail(&all->reader, field, "expected axis X, the only one");
    if (is_named)
        *field = pmc_reader_field(&all->reader, "");
    return true;
}

static bool read_op(struct pmc_reader *reader, struct pmc_command *command)
{
    struct pmc_field field = pmc_reader_field(reader, "");
    for (unsigned op = 0; op < PMC_OPS; op++) {
        if (pmc_field_is(&field, pmc_command_rows[op].name)) {
            *command = (struct pmc_command){.op = (uint8_t)op};
            return true;
        }
    }
    return pmc_reader_fail(reader, &field,
                           "expected a command: ABS, INC, HOM, IJP, OUT, OTP, JMP, REP, RPE, END, TIM or NOP");
}

static bool read_operands(struct pmc_reader *reader, struct pmc_command *command)
{
    const char *end = "expected the end of the line";
    uint16_t wanted = pmc_command_rows[command->op].operands;
    struct pmc_field field = pmc_reader_field(reader, "");
    for (size_t i = 0; i < OPERANDS; i++) {
        if ((wanted & operands[i].bit) == 0)
            continue;
        if (field.length == 0 && operands[i].may_be_missing)
            return true;
        if (!operands[i].read(&field, command))
            return pmc_reader_fail(reader, &field, operands[i].expected);
        field = pmc_reader_field(reader, "");
    }
    return field.length == 0 || pmc_reader_fail(reader, &field, end);
}

static void read_line(struct program_reader *all)
{
    struct pmc_reader *reader = &all->reader;
    struct pmc_field field = pmc_reader_field(reader, "");
    struct pmc_command command;
    unsigned axis;
    int32_t reg = 0;
    if (field.length == 0 || !read_axis(all, &field, &axis))
        return;
    if (!read_reg(&field, &reg)) {
        pmc_reader_fail(reader, &field, "expected a register from 0 to 63");
        return;
    }
    struct seen *seen = &all->seen[axis];
    if (seen->line[reg] != 0) {
        pmc_reader_fail(reader, &field, "expected a register that no line before has named");
        return;
    }
    seen->line[reg] = reader->line;
    if (!read_op(reader, &command) || !read_operands(reader, &command))
        return;
    all->program[axis][reg] = command;
    seen->last = reader->line;
}

/* What is legal and hardly meant (AF3). */
static void warn_about(struct program_reader *all, unsigned axis)
{
    const struct seen *seen = &all->seen[axis];
    bool has_rep = false, has_end = false;
    for (unsigned reg = 0; reg < PMC_REGISTERS; reg++) {
        uint8_t op = all->program[axis][reg].op;
        if (op == PMC_RPE && !has_rep)
            pmc_reader_warn(&all->reader, seen->line[reg], 1, "RPE without a REP before it");
        has_rep = has_rep || op == PMC_REP;
        has_end = has_end || op == PMC_END;
    }
    if (seen->last != 0 && !has_end)
        pmc_reader_warn(&all->reader, seen->last, 1, "the program of this axis has no END");
}

bool pmc_program_read(const char *text, size_t length, unsigned axes, struct pmc_command program[PMC_AXES][PMC_REGISTERS],
                      pmc_text_report *report, void *context)
{
    struct program_reader all = {
        .reader = {.text = text, .length = length, .report = report, .context = context}, .axes = axes, .program = program};
    memset(program, 0, PMC_AXES * sizeof program[0]);
    while (pmc_reader_next(&all.reader))
        read_line(&all);
    for (unsigned axis = 0; axis < axes && !all.reader.is_wrong; axis++)
        warn_about(&all, axis);
    return !all.reader.is_wrong;
}

/* ---- Writing ------------------------------------------------------------------------------------------------------------ */

static void write_command(struct pmc_writer *writer, const struct pmc_command *command)
{
    const struct pmc_command_row *row = &pmc_command_rows[command->op];
    pmc_write(writer, row->name);
    for (size_t i = 0; i < OPERANDS; i++)
        if ((row->operands & operands[i].bit) != 0)
            operands[i].write(writer, command);
}

size_t pmc_command_write(const struct pmc_command *command, char text[PMC_COMMAND_TEXT_MAX])
{
    struct pmc_writer writer = {.text = text, .room = PMC_COMMAND_TEXT_MAX};
    write_command(&writer, command);
    return writer.length;
}

size_t pmc_program_write(const struct pmc_command *const program[PMC_AXES], unsigned axes, char *text, size_t room)
{
    struct pmc_writer writer = {.text = text, .room = room};
    for (unsigned axis = 0; axis < axes; axis++) {
        for (unsigned reg = 0; reg < PMC_REGISTERS; reg++) {
            const struct pmc_command *command = &program[axis][reg];
            if (command->op == PMC_NOP)
                continue;
            pmc_write(&writer, axes == 1 ? "" : axis == 0 ? "X: " : "Y: ");
            pmc_write_number(&writer, (int32_t)reg, 2);
            pmc_write(&writer, " ");
            write_command(&writer, command);
            pmc_write(&writer, "\n");
        }
    }
    return writer.length;
}
