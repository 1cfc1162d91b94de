/* SPDX-License-Identifier: MIT */
/* check_flow.c: loops, subroutines, code that is never reached, endless loops. */
#include <stdlib.h>
#include <string.h>

#include "check_inside.h"

/* ---- Marks of single commands --------------------------------------------------------------------------------------- */

static void check_loop(struct check *check, const struct check_motor *motor, size_t i)
{
    const uint8_t marks = motor->flow.marks[i];
    if (marks & FLOW_NO_LOOP)
        check_warn(check, motor, CHECK_LOOP_END, i, i, "the program stops here with a fault", "E without an open loop");
    if (marks & FLOW_LOOP_LEVELS)
        check_warn(check, motor, CHECK_LOOP_DEPTH, i, i, "the program stops here with a fault",
                   "a ninth nested loop: a motor has 8 levels of loops");
    if (motor->code.commands[i].command.op == 'L' && (marks & FLOW_REACHED) && !(marks & FLOW_LOOP_CLOSED) &&
        motor->flow.complete)
        check_warn(check, motor, CHECK_OPEN_LOOP, i, i, "the commands after it are executed once", "L without an E");
}

/* A label at which a subroutine is run into before the `.` at `i`; FLOW_NO_NODE: there is none. */
static uint32_t run_into_before(const struct check_motor *motor, size_t i)
{
    while (i-- > motor->code.first)
        if (motor->flow.marks[i] & FLOW_RUN_INTO)
            return (uint32_t)i;
    return FLOW_NO_NODE;
}

static void check_calls(struct check *check, const struct check_motor *motor, size_t i, uint32_t *told)
{
    const uint8_t marks = motor->flow.marks[i];
    if (marks & FLOW_CALL_LEVELS)
        check_warn(check, motor, CHECK_CALL_DEPTH, i, i, "the program stops here with a fault",
                   "a seventh nested call: a motor has 6 levels of calls");
    if (!(marks & FLOW_NO_CALL))
        return;
    const uint32_t into = run_into_before(motor, i);
    if (into == FLOW_NO_NODE)
        check_warn(check, motor, CHECK_STRAY_RETURN, i, i, "the program stops here with a fault", ". outside a subroutine");
    else if (into != *told)
        check_warn(check, motor, CHECK_RUN_INTO, into, into, "end the program before it, by a jump over the subroutine",
                   "the program enters subroutine %u without a call; its . stops it with a fault",
                   (unsigned)motor->code.commands[into].command.argument);
    if (into != FLOW_NO_NODE)
        *told = into;
}

/* ---- What is never reached ------------------------------------------------------------------------------------------ */

/* The last command of a run that is never reached, in one source. */
static size_t end_of_run(const struct check_motor *motor, size_t from)
{
    size_t i = from;
    while (i + 1 < motor->code.count && !(motor->flow.marks[i + 1] & FLOW_REACHED) &&
           motor->code.commands[i + 1].source == motor->code.commands[from].source)
        i++;
    return i;
}

static void report_run(struct check *check, const struct check_motor *motor, size_t from, size_t last)
{
    const struct rkm04_command command = motor->code.commands[from].command;
    const size_t count = last - from + 1;
    const char *hint = NULL;
    if (command.op == '@' && !motor->flow.called[command.argument] && !motor->flow.jumped[command.argument])
        hint = "no jump or call uses this label";
    else if (from > motor->code.first && code_is_endless(motor->code.commands[from - 1].command))
        hint = "only M, N, X or K ends the motion before it";
    check_warn(check, motor, CHECK_UNREACHABLE, from, last, hint, "%zu command%s never executed", count,
               count == 1 ? " is" : "s are");
}

static void check_reached(struct check *check, const struct check_motor *motor)
{
    const struct code *code = &motor->code;
    if (code->has_reset && code->first > 1)
        check_warn(check, motor, CHECK_UNREACHABLE, 0, code->first - 2, "\\ is executed first, wherever it is",
                   "%zu command%s before \\ dropped", code->first - 1, code->first == 2 ? " is" : "s are");
    if (!motor->flow.complete)
        return;
    for (size_t i = code->first; i < code->count; i++) {
        if (motor->flow.marks[i] & FLOW_REACHED)
            continue;
        const size_t last = end_of_run(motor, i);
        report_run(check, motor, i, last);
        i = last;
    }
}

/* ---- Endless loops -------------------------------------------------------------------------------------------------- */

/* What a component of the flow has. */
struct cycle {
    bool has_exit, takes_time, is_cycle;
    uint32_t first, last; /* indices of commands */
};

static bool takes_time(struct rkm04_command command)
{
    return code_is_motion(command) || command.op == 'W' || command.op == 'O' || command.op == 'Z' || command.op == '[';
}

static void add_node(const struct flow *flow, struct cycle *cycles, uint32_t at)
{
    const struct flow_node *node = &flow->nodes[at];
    struct cycle *cycle = &cycles[node->component];
    uint32_t cursor = 0, next;
    if (node->index < flow->code->count && takes_time(flow->code->commands[node->index].command))
        cycle->takes_time = true;
    while ((next = flow_follower(flow, at, &cursor)) != FLOW_NO_NODE) {
        if (flow->nodes[next].component == node->component)
            cycle->is_cycle = true;
        else
            cycle->has_exit = true;
    }
    if (node->index < cycle->first)
        cycle->first = node->index;
    if (node->index > cycle->last)
        cycle->last = node->index;
}

static void check_cycles(struct check *check, struct check_motor *motor)
{
    struct flow *flow = &motor->flow;
    const size_t count = flow_find_cycles(flow);
    struct cycle *cycles = calloc(count + 1, sizeof *cycles);
    if (count == 0 || cycles == NULL) {
        flow->no_memory = true;
        free(cycles);
        return;
    }
    for (size_t i = 0; i < count; i++)
        cycles[i].first = UINT32_MAX;
    for (uint32_t i = 0; i < flow->node_count; i++)
        add_node(flow, cycles, i);
    for (size_t i = 0; i < count; i++)
        if (cycles[i].is_cycle && !cycles[i].has_exit && !cycles[i].takes_time)
            check_warn(check, motor, CHECK_BUSY_LOOP, cycles[i].first, cycles[i].first, "add W1, so that a pass takes time",
                       "an endless loop without a motion, a dwell or a wait");
    free(cycles);
}

void check_flow(struct check *check, struct check_motor *motor)
{
    uint32_t told = FLOW_NO_NODE;
    for (size_t i = motor->code.first; i < motor->code.count; i++) {
        check_loop(check, motor, i);
        check_calls(check, motor, i, &told);
    }
    check_reached(check, motor);
    if (motor->flow.complete)
        check_cycles(check, motor);
}
