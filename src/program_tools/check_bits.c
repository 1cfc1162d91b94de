/* SPDX-License-Identifier: MIT */
/* check_bits.c: outputs that stay on; variables by which the motors of a unit wait for each other. */
#include <string.h>

#include "check_inside.h"

#define FIRST_MARK 51u /* T51 sets output 1 */

/* ---- Outputs -------------------------------------------------------------------------------------------------------- */

/* The output that this T sets, or this C clears; 0: none. */
static unsigned output_of(struct rkm04_command command)
{
    if (command.op == 'T' && command.argument >= FIRST_MARK && command.argument < FIRST_MARK + RKM04_OUTPUTS)
        return command.argument - FIRST_MARK + 1;
    return (command.op == 'T' || command.op == 'C') && command.argument <= RKM04_OUTPUTS ? command.argument : 0;
}

void check_outputs(struct check *check)
{
    unsigned done = 0; /* cleared somewhere, or reported: bit n is output n */
    for (size_t m = 0; m < check->motor_count; m++) {
        const struct code *code = &check->motors[m].code;
        for (size_t i = code->first; i < code->count; i++)
            if (code->commands[i].command.op == 'C')
                done |= 1u << output_of(code->commands[i].command);
    }
    for (size_t m = 0; m < check->motor_count; m++) {
        const struct code *code = &check->motors[m].code;
        for (size_t i = code->first; i < code->count; i++) {
            const unsigned output = output_of(code->commands[i].command);
            if (output == 0 || done >> output & 1)
                continue;
            done |= 1u << output;
            check_warn(check, &check->motors[m], CHECK_OUTPUT_STAYS, i, i, "only the next power-up clears it",
                       "output %02u is set and never cleared: there is no C%02u", output, output);
        }
    }
}

/* ---- Variables ------------------------------------------------------------------------------------------------------ */

static uint16_t bit_of(unsigned variable)
{
    return (uint16_t)(1u << (variable - RKM04_FIRST_VARIABLE));
}

/* The variables that this motor may set; `reached`: only by commands that it may reach. */
static uint16_t set_by(const struct check_motor *motor, bool reached)
{
    uint16_t set = 0;
    for (size_t i = motor->code.first; i < motor->code.count; i++) {
        const struct rkm04_command command = motor->code.commands[i].command;
        if (command.op == 'T' && command.argument >= RKM04_FIRST_VARIABLE &&
            (!reached || (motor->flow.marks[i] & FLOW_REACHED) != 0))
            set |= bit_of(command.argument);
    }
    return set;
}

/* Follow all programs, passing waits only for what some motor may have set: until nothing more is reached. */
static bool follow_together(struct check *check, bool *complete)
{
    uint16_t settable = 0, before;
    do {
        before = settable;
        for (size_t m = 0; m < check->motor_count; m++) {
            struct check_motor *motor = &check->motors[m];
            flow_end(&motor->flow);
            if (!flow_begin(&motor->flow, &motor->code, before))
                return false;
            *complete = motor->flow.complete && motor->flow.marks != NULL;
            if (!*complete)
                return true;
            settable |= set_by(motor, true);
        }
    } while (settable != before);
    return true;
}

/* A wait of this motor that never ends; code.count: there is none. */
static size_t stuck_in(const struct check_motor *motor)
{
    size_t i = motor->code.first;
    while (i < motor->code.count && !(motor->code.commands[i].command.op == 'O' && (motor->flow.marks[i] & FLOW_STUCK) != 0))
        i++;
    return i;
}

static void report_deadlock(struct check *check, const struct check_motor *motor, size_t i)
{
    const unsigned variable = motor->code.commands[i].command.argument;
    for (size_t m = 0; m < check->motor_count; m++) {
        const struct check_motor *other = &check->motors[m];
        const size_t wait = stuck_in(other);
        if (!(set_by(other, false) & bit_of(variable)) || wait == other->code.count)
            continue;
        check_warn(check, motor, CHECK_DEADLOCK, i, i, "one of them has to set its variable before it waits",
                   "motor %u waits for VAR %u, which motor %u sets only after its wait for VAR %u", motor->motor, variable,
                   other->motor, (unsigned)other->code.commands[wait].command.argument);
        return;
    }
}

static void report_stuck(struct check *check, const struct check_motor *motor, uint16_t set)
{
    for (size_t i = motor->code.first; i < motor->code.count; i++) {
        const struct rkm04_command command = motor->code.commands[i].command;
        if (!(motor->flow.marks[i] & FLOW_STUCK))
            continue;
        const unsigned variable = code_bit(command);
        if (!(set & bit_of(variable)))
            check_warn(check, motor, CHECK_VARIABLE_NEVER_SET, i, i, NULL, "no motor sets VAR %u: there is no T%u", variable,
                       variable);
        else if (command.op == 'O')
            report_deadlock(check, motor, i);
    }
}

bool check_variables(struct check *check)
{
    uint16_t set = 0;
    bool complete = true;
    if (check->motor_count < 2)
        return true;
    if (!follow_together(check, &complete))
        return false;
    for (size_t m = 0; m < check->motor_count; m++)
        set |= set_by(&check->motors[m], false);
    for (size_t m = 0; complete && m < check->motor_count; m++)
        report_stuck(check, &check->motors[m], set);
    return true;
}
