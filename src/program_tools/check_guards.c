/* SPDX-License-Identifier: MIT */
/* check_guards.c: M and N that guard nothing, or the first pass of a loop alone. */
#include <stdlib.h>

#include "check_inside.h"

/* What is known of each M and N. */
struct use {
    bool used, used_up;
};

struct guards {
    const struct check_motor *motor;
    struct use *use;    /* of each command */
    uint32_t *size;     /* nodes of each component */
    bool several_m, several_n; /* some motion is guarded by one of several */
};

/* Has this command a node in the component? */
static bool is_in(const struct flow *flow, uint32_t index, uint32_t component)
{
    for (uint32_t node = flow->first_node[index]; node != FLOW_NO_NODE; node = flow->nodes[node].same)
        if (flow->nodes[node].component == component)
            return true;
    return false;
}

static void check_guard(struct guards *guards, const struct flow_node *node, int32_t from, bool *several)
{
    if (from == FLOW_SEVERAL)
        *several = true;
    if (from < 0)
        return;
    guards->use[from].used = true;
    if (guards->motor->flow.complete && guards->size[node->component] > 1 &&
        !is_in(&guards->motor->flow, (uint32_t)from, node->component))
        guards->use[from].used_up = true;
}

static void check_guarded_motions(struct guards *guards)
{
    const struct flow *flow = &guards->motor->flow;
    for (size_t i = 0; flow->complete && i < flow->node_count; i++)
        guards->size[flow->nodes[i].component]++;
    for (size_t i = 0; i < flow->node_count; i++) {
        const struct flow_node *node = &flow->nodes[i];
        if (node->index == flow->code->count || !code_is_motion(flow->code->commands[node->index].command))
            continue;
        check_guard(guards, node, node->in.m_from, &guards->several_m);
        check_guard(guards, node, node->in.n_from, &guards->several_n);
    }
}

static void report(struct check *check, const struct guards *guards, size_t i)
{
    const struct rkm04_command command = guards->motor->code.commands[i].command;
    const bool several = command.op == 'M' ? guards->several_m : guards->several_n;
    const char op = (char)command.op;
    if (!(guards->motor->flow.marks[i] & FLOW_REACHED))
        return;
    if (!guards->use[i].used && !several && guards->motor->flow.complete)
        check_warn(check, guards->motor, CHECK_UNUSED_GUARD, i, i, NULL, "%c%02u guards no motion: there is none after it", op,
                   (unsigned)command.argument);
    if (guards->use[i].used_up)
        check_warn(check, guards->motor, CHECK_USED_GUARD, i, i, "arm it inside the loop",
                   "%c%02u is disarmed by the first motion that it stops; later passes run without it", op,
                   (unsigned)command.argument);
}

void check_guards(struct check *check, const struct check_motor *motor)
{
    struct guards guards = {.motor = motor};
    guards.use = calloc(motor->code.count + 1, sizeof *guards.use);
    guards.size = calloc(motor->flow.node_count + 1, sizeof *guards.size);
    if (guards.use == NULL || guards.size == NULL) {
        check->found->no_memory = true;
    } else {
        check_guarded_motions(&guards);
        for (size_t i = motor->code.first; i < motor->code.count; i++)
            if (motor->code.commands[i].command.op == 'M' || motor->code.commands[i].command.op == 'N')
                report(check, &guards, i);
    }
    free(guards.use);
    free(guards.size);
}
