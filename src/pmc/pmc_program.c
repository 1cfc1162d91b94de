/* SPDX-License-Identifier: MIT */
#include "pmc_program.h"

#include "pmc_home.h"
#include "pmc_motion.h"
#include "pmc_report.h"

static uint64_t slots(uint32_t count)
{
    return (uint64_t)count * PMC_SLOT_TICKS;
}

/* ---- Moves --------------------------------------------------------------------------------------------------------- */

static uint16_t dwell_of(const struct pmc_axis *axis, const struct pmc_command *command)
{
    return command->number == 0 ? command->ms : (uint16_t)axis->parameters.value[PMC_TIMER1 + command->number - 1];
}

/* Move by `way` pulses with the speed and dwell of a command. */
static void move_by(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command, int64_t way)
{
    const int64_t target = axis->commanded + way;
    const struct pmc_move move = {.way = way,
                                  .speed = (uint16_t)axis->parameters.value[PMC_SPEED1 + command->speed - 1],
                                  .start_speed = (uint16_t)axis->parameters.value[PMC_START_SPEED]};
    if (!(axis->parameters.value[PMC_FLAGS] & PMC_FLAG_SOFT_LIMITS) &&
        (target < PMC_COUNTER_MIN || target > PMC_COUNTER_MAX)) {
        pmc_raise(unit, axis, PMC_ERROR_PGM);
        return;
    }
    axis->dwell = dwell_of(axis, command);
    axis->after_move = pmc_motion_move(unit, axis, &move);
    if (!axis->after_move)
        axis->due += slots(axis->dwell);
}

static void execute_abs(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    if (!axis->homed && unit->config.refuse) {
        pmc_raise(unit, axis, PMC_ERROR_PGM);
        return;
    }
    axis->not_homed = axis->not_homed || !axis->homed;
    move_by(unit, axis, command, pmc_pulses_of(&axis->parameters, command->value) - axis->commanded);
}

static void execute_inc(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    move_by(unit, axis, command, pmc_pulses_of(&axis->parameters, command->value));
}

static void execute_hom(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)command;
    pmc_home_begin(unit, axis);
}

/* ---- Inputs and outputs -------------------------------------------------------------------------------------------- */

static void execute_ijp(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)unit;
    if (axis->inputs & (PMC_IN0 << command->number))
        axis->next = command->argument;
}

/* Switch an output; a pulse that held it is over. */
static void switch_output(struct pmc_unit *unit, struct pmc_axis *axis, unsigned output, bool on)
{
    const unsigned bit = 1u << (PMC_OUTPUT_SHIFT * pmc_index(unit, axis) + output);
    axis->off[output] = PMC_NEVER;
    pmc_write_outputs(unit, (uint8_t)(on ? unit->outputs | bit : unit->outputs & ~bit));
}

static void execute_out(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    switch_output(unit, axis, command->number, command->argument != 0);
}

static void execute_otp(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    switch_output(unit, axis, command->number, true);
    axis->off[command->number] = unit->now + slots(command->ms);
    if (command->wait)
        axis->due = axis->off[command->number];
}

void pmc_program_end_pulses(struct pmc_unit *unit, struct pmc_axis *axis)
{
    for (unsigned output = 0; output < 2; output++)
        if (axis->off[output] <= unit->now)
            switch_output(unit, axis, output, false);
}

/* ---- Flow ---------------------------------------------------------------------------------------------------------- */

static void execute_nop(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)unit, (void)axis, (void)command;
}

static void execute_jmp(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)unit;
    axis->next = command->argument;
}

static void execute_rep(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    unsigned level = 0; /* the same REG open already begins again, and closes those inside it */
    while (level < axis->repetitions && axis->repetition[level].reg != axis->reg)
        level++;
    if (level == PMC_REPETITIONS) {
        pmc_raise(unit, axis, PMC_ERROR_PGM);
        return;
    }
    const uint8_t back = unit->config.passes ? (uint8_t)(command->argument - 1) : command->argument;
    axis->repetition[level] = (struct pmc_repetition){.reg = axis->reg, .left = back};
    axis->repetitions = (uint8_t)(level + 1);
}

static void execute_rpe(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)command;
    struct pmc_repetition *last = axis->repetition + axis->repetitions;
    if (axis->repetitions == 0 || (--last)->reg >= axis->reg) {
        pmc_raise(unit, axis, PMC_ERROR_PGM);
    } else if (last->left > 0) {
        last->left--;
        axis->next = (uint8_t)(last->reg + 1);
    } else {
        axis->repetitions--;
    }
}

static void execute_end(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    (void)command;
    pmc_end_program(unit, axis);
}

static void execute_tim(struct pmc_unit *unit, struct pmc_axis *axis, const struct pmc_command *command)
{
    axis->due = unit->now + slots(command->ms);
}

const struct pmc_command_row pmc_command_rows[PMC_OPS] = {
    [PMC_NOP] = {"NOP", 0, execute_nop},
    [PMC_ABS] = {"ABS", PMC_OPERAND_VALUE | PMC_OPERAND_SPEED | PMC_OPERAND_DWELL, execute_abs},
    [PMC_INC] = {"INC", PMC_OPERAND_VALUE | PMC_OPERAND_SPEED | PMC_OPERAND_DWELL, execute_inc},
    [PMC_HOM] = {"HOM", 0, execute_hom},
    [PMC_IJP] = {"IJP", PMC_OPERAND_INPUT | PMC_OPERAND_TARGET, execute_ijp},
    [PMC_OUT] = {"OUT", PMC_OPERAND_OUTPUT | PMC_OPERAND_STATE, execute_out},
    [PMC_OTP] = {"OTP", PMC_OPERAND_OUTPUT | PMC_OPERAND_MS | PMC_OPERAND_WAIT, execute_otp},
    [PMC_JMP] = {"JMP", PMC_OPERAND_TARGET, execute_jmp},
    [PMC_REP] = {"REP", PMC_OPERAND_COUNT, execute_rep},
    [PMC_RPE] = {"RPE", 0, execute_rpe},
    [PMC_END] = {"END", 0, execute_end},
    [PMC_TIM] = {"TIM", PMC_OPERAND_MS, execute_tim},
};

void pmc_program_begin(struct pmc_unit *unit, struct pmc_axis *axis, uint8_t reg)
{
    axis->running = true;
    axis->repetitions = 0;
    axis->next = reg;
    axis->due = unit->now;
}

void pmc_program_turn(struct pmc_unit *unit, struct pmc_axis *axis)
{
    if (!axis->running || axis->phase != 0 || axis->motion.active)
        return;
    if (axis->after_move) {
        axis->after_move = false;
        axis->due = unit->now + slots(axis->dwell);
    }
    if (axis->due > unit->now)
        return;
    if (axis->next >= PMC_REGISTERS) {
        pmc_raise(unit, axis, PMC_ERROR_PGM);
        return;
    }
    axis->reg = axis->next++;
    axis->executing = true;
    axis->due = unit->now + PMC_SLOT_TICKS;
    pmc_report(unit, axis, unit->now, PMC_EVENT_COMMAND, axis->reg + 1u);
    const struct pmc_command *command = &axis->program[axis->reg];
    pmc_command_rows[command->op].execute(unit, axis, command);
}
