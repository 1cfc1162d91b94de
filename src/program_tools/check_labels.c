/* SPDX-License-Identifier: MIT */
/* check_labels.c: labels, brackets, the size of the program: what can be seen without following it. */
#include <string.h>

#include "check_inside.h"

static bool is_reached(const struct check_motor *motor, size_t command)
{
    return motor->flow.marks == NULL || !motor->flow.complete || (motor->flow.marks[command] & FLOW_REACHED) != 0;
}

static void check_jump(struct check *check, const struct check_motor *motor, size_t i)
{
    const struct rkm04_command command = motor->code.commands[i].command;
    const unsigned label = code_label(command);
    if (motor->flow.label[label] != FLOW_NO_NODE)
        return;
    check_warn(check, motor, CHECK_MISSING_LABEL, i, i, NULL, "label %u is not in the program: %s waits until it is sent", label,
               command.op == '\'' ? "the call" : "the jump");
}

static void check_label(struct check *check, const struct check_motor *motor, size_t i)
{
    const unsigned label = motor->code.commands[i].command.argument;
    const struct flow *flow = &motor->flow;
    if (flow->label[label] != i)
        check_warn(check, motor, CHECK_DUPLICATE_LABEL, i, i, "jumps go to the last one",
                   "label %u occurs again later: this one has no effect", label);
    else if (!flow->called[label] && !flow->jumped[label] && is_reached(motor, i))
        check_warn(check, motor, CHECK_UNUSED_LABEL, i, i, NULL, "label %u is never used", label);
}

static void check_size(struct check *check, const struct check_motor *motor)
{
    const size_t commands = motor->code.count - motor->code.first;
    if (commands > RKM04_PROGRAM_MAX)
        check_warn(check, motor, CHECK_MEMORY_FULL, motor->code.first + RKM04_PROGRAM_MAX,
                   motor->code.first + RKM04_PROGRAM_MAX, "a motor holds 700 commands; further ones overwrite the oldest",
                   "the program has %zu commands: this one overwrites the first", commands);
}

/* `[` waits for a later `]` (C9). */
static void check_blocks(struct check *check, const struct check_motor *motor)
{
    bool closed = false;
    for (size_t i = motor->code.count; i-- > motor->code.first;) {
        const uint8_t op = motor->code.commands[i].command.op;
        closed = closed || op == ']';
        if (op == '[' && !closed)
            check_warn(check, motor, CHECK_OPEN_BLOCK, i, i, "the motor waits here until a ] is sent", "[ without a ] after it");
    }
}

void check_labels(struct check *check, const struct check_motor *motor)
{
    for (size_t i = motor->code.first; i < motor->code.count; i++) {
        const struct rkm04_command command = motor->code.commands[i].command;
        if (code_is_jump(command))
            check_jump(check, motor, i);
        else if (command.op == '@')
            check_label(check, motor, i);
        if (command.op == 'V' && i > motor->code.first && code_is_endless(motor->code.commands[i - 1].command))
            check_warn(check, motor, CHECK_STAND_ALONE, i, i,
                       "put V before the motion; during a motion, only a V alone in a message changes the speed",
                       "V after an endless motion is executed when the motion has ended");
    }
    check_size(check, motor);
    check_blocks(check, motor);
}
