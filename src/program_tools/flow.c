/* SPDX-License-Identifier: MIT */
#include "flow.h"

#include <stdlib.h>

#define LEVELS_FOLLOWED 32u /* loops; beyond the levels of the unit, so that what closes them is found */

/* ---- Memory --------------------------------------------------------------------------------------------------------- */

/* Room for element number `count`. Returns the array, or NULL: out of memory. */
static void *room_for(struct flow *flow, void *array, size_t count, size_t *room, size_t size)
{
    if (count < *room)
        return array;
    size_t more = *room == 0 ? 256 : 2 * *room;
    void *grown = realloc(array, more * size);
    if (grown == NULL)
        flow->no_memory = true;
    else
        *room = more;
    return grown;
}

static bool enqueue(struct flow *flow, uint32_t node)
{
    if (flow->nodes[node].queued)
        return true;
    uint32_t *queue = room_for(flow, flow->queue, flow->queue_count, &flow->queue_room, sizeof *queue);
    if (queue == NULL)
        return false;
    flow->queue = queue;
    queue[flow->queue_count++] = node;
    flow->nodes[node].queued = true;
    return true;
}

/* ---- Nodes ---------------------------------------------------------------------------------------------------------- */

static uint32_t add_node(struct flow *flow, uint32_t context, uint32_t index, uint32_t stack, const struct flow_state *in)
{
    struct flow_node *nodes = room_for(flow, flow->nodes, flow->node_count, &flow->node_room, sizeof *nodes);
    if (nodes == NULL)
        return FLOW_NO_NODE;
    flow->nodes = nodes;
    uint32_t added = (uint32_t)flow->node_count++;
    nodes[added] = (struct flow_node){.index = index,
                                      .context = context,
                                      .stack = stack,
                                      .next = {FLOW_NO_NODE, FLOW_NO_NODE},
                                      .same = flow->first_node[index],
                                      .caller = FLOW_NO_NODE};
    nodes[added].in = *in;
    flow->first_node[index] = added;
    enqueue(flow, added);
    return added;
}

/* The state `in` leads to this command. Returns its node; FLOW_NO_NODE: it is not followed. */
static uint32_t reach(struct flow *flow, uint32_t context, uint32_t index, uint32_t stack, const struct flow_state *in)
{
    unsigned situations = 0;
    if (index < flow->code->count)
        flow->marks[index] |= FLOW_REACHED;
    for (uint32_t node = flow->first_node[index]; node != FLOW_NO_NODE; node = flow->nodes[node].same, situations++) {
        struct flow_node *known = &flow->nodes[node];
        if (known->context != context || known->stack != stack)
            continue;
        if (flow_state_join(&known->in, in))
            enqueue(flow, node);
        return node;
    }
    if (situations < FLOW_SITUATIONS_MAX && flow->node_count < FLOW_NODES_MAX)
        return add_node(flow, context, index, stack, in);
    flow->complete = false;
    return FLOW_NO_NODE;
}

/* The stack with this loop opened: begun again if it is open already, which closes those inside it (C7). */
static uint32_t open_loop(struct flow *flow, uint32_t stack, uint32_t loop)
{
    for (uint32_t at = stack; at != 0; at = flow->stacks[at].parent)
        if (flow->stacks[at].loop == loop)
            return at;
    for (uint32_t at = flow->first_stack[loop]; at != 0; at = flow->stacks[at].same)
        if (flow->stacks[at].parent == stack)
            return at;
    struct flow_stack *stacks = room_for(flow, flow->stacks, flow->stack_count, &flow->stack_room, sizeof *stacks);
    if (stacks == NULL)
        return stack;
    flow->stacks = stacks;
    uint32_t added = (uint32_t)flow->stack_count++;
    stacks[added] = (struct flow_stack){stack, loop, stacks[stack].depth + 1, flow->first_stack[loop]};
    flow->first_stack[loop] = added;
    return added;
}

static uint32_t find_context(struct flow *flow, uint32_t entry, uint32_t loops, uint32_t calls)
{
    for (uint32_t i = 0; i < flow->context_count; i++) {
        const struct flow_context *known = &flow->contexts[i];
        if (known->entry == entry && known->loops == loops && known->calls == calls)
            return i;
    }
    if (flow->context_count == FLOW_CONTEXTS_MAX) {
        flow->complete = false;
        return FLOW_NO_NODE;
    }
    struct flow_context *contexts =
        room_for(flow, flow->contexts, flow->context_count, &flow->context_room, sizeof *contexts);
    if (contexts == NULL)
        return FLOW_NO_NODE;
    flow->contexts = contexts;
    contexts[flow->context_count] =
        (struct flow_context){.entry = entry, .loops = loops, .calls = calls, .callers = FLOW_NO_NODE};
    return (uint32_t)flow->context_count++;
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

/* A node under way: what it is, and the state after it. */
struct step {
    uint32_t node, context, index, stack;
    struct rkm04_command command;
    struct flow_state out;
};

/* The command `index` follows, with this stack. `which`: of node.next. */
static void follow(struct flow *flow, const struct step *step, unsigned which, uint32_t index, uint32_t stack)
{
    uint32_t next = reach(flow, step->context, index, stack, &step->out);
    flow->nodes[step->node].next[which] = next;
}

/* A command outside of any call leads on to the next one: that may be a subroutine, which is run into. */
static void mark_run_into(struct flow *flow, uint32_t context, uint32_t index)
{
    const struct code *code = flow->code;
    if (index == code->count || flow->contexts[context].calls > 0)
        return;
    const struct rkm04_command next = code->commands[index].command;
    if (next.op == '@' && flow->called[next.argument] && flow->label[next.argument] == index)
        flow->marks[index] |= FLOW_RUN_INTO;
}

static void fall_through(struct flow *flow, const struct step *step)
{
    mark_run_into(flow, step->context, step->index + 1);
    follow(flow, step, 0, step->index + 1, step->stack);
}

/* The call at this node returns with the state `out`. */
static void come_back(struct flow *flow, uint32_t call, const struct flow_state *out)
{
    const struct flow_node caller = flow->nodes[call];
    mark_run_into(flow, caller.context, caller.index + 1);
    uint32_t back = reach(flow, caller.context, caller.index + 1, caller.stack, out);
    flow->nodes[call].next[1] = back;
}

static void follow_loop_begin(struct flow *flow, const struct step *step)
{
    uint32_t stack = step->stack;
    const uint32_t outside = flow->contexts[step->context].loops;
    if (outside + flow->stacks[stack].depth < LEVELS_FOLLOWED)
        stack = open_loop(flow, stack, step->index);
    if (outside + flow->stacks[stack].depth == RKM04_LOOP_LEVELS + 1)
        flow->marks[step->index] |= FLOW_LOOP_LEVELS;
    follow(flow, step, 0, step->index + 1, stack);
}

static void follow_loop_end(struct flow *flow, const struct step *step)
{
    if (step->stack == 0) {
        flow->marks[step->index] |= FLOW_NO_LOOP;
        fall_through(flow, step);
        return;
    }
    const struct flow_stack loop = flow->stacks[step->stack];
    flow->marks[loop.loop] |= FLOW_LOOP_CLOSED;
    if (flow->code->commands[loop.loop].command.argument > 1)
        follow(flow, step, 1, loop.loop + 1, step->stack);
    follow(flow, step, 0, step->index + 1, loop.parent);
}

static void follow_call(struct flow *flow, const struct step *step)
{
    const struct flow_context here = flow->contexts[step->context];
    const uint32_t label = flow->label[step->command.argument];
    if (here.calls == RKM04_CALL_LEVELS)
        flow->marks[step->index] |= FLOW_CALL_LEVELS;
    if (here.calls == RKM04_CALL_LEVELS || label == FLOW_NO_NODE) {
        fall_through(flow, step);
        return;
    }
    uint32_t called = find_context(flow, label, here.loops + flow->stacks[step->stack].depth, here.calls + 1);
    if (called == FLOW_NO_NODE)
        return;
    uint32_t entry = reach(flow, called, label, 0, &step->out);
    struct flow_node *node = &flow->nodes[step->node];
    if (node->next[0] == FLOW_NO_NODE && entry != FLOW_NO_NODE) {
        node->next[0] = entry;
        node->caller = flow->contexts[called].callers;
        flow->contexts[called].callers = step->node;
    }
    if (!flow->contexts[called].returns)
        return;
    const struct flow_state out = flow->contexts[called].out;
    come_back(flow, step->node, &out);
}

static void follow_return(struct flow *flow, const struct step *step)
{
    struct flow_context *here = &flow->contexts[step->context];
    if (here->calls == 0) {
        flow->marks[step->index] |= FLOW_NO_CALL;
        return;
    }
    if (!here->returns)
        here->out = step->out;
    else if (!flow_state_join(&here->out, &step->out))
        return;
    here->returns = true;
    const struct flow_state out = here->out;
    for (uint32_t at = here->callers; at != FLOW_NO_NODE; at = flow->nodes[at].caller)
        come_back(flow, at, &out);
}

/* Can the bit ever be 1? */
static bool may_be_set(const struct flow *flow, unsigned bit)
{
    return bit < RKM04_FIRST_VARIABLE || (flow->settable >> (bit - RKM04_FIRST_VARIABLE) & 1) != 0;
}

static void follow_jump_if(struct flow *flow, const struct step *step)
{
    const uint32_t label = flow->label[code_label(step->command)];
    const bool high = (step->command.argument >> 8 & 1) != 0;
    fall_through(flow, step);
    if (high && !may_be_set(flow, code_bit(step->command)))
        flow->marks[step->index] |= FLOW_STUCK;
    else if (label != FLOW_NO_NODE)
        follow(flow, step, 1, label, step->stack);
}

static void follow_command(struct flow *flow, const struct step *step)
{
    const struct rkm04_command command = step->command;
    switch (command.op) {
    case 'L':
        follow_loop_begin(flow, step);
        break;
    case 'E':
        follow_loop_end(flow, step);
        break;
    case '\'':
        follow_call(flow, step);
        break;
    case '.':
        follow_return(flow, step);
        break;
    case 'J':
        if (flow->label[command.argument] != FLOW_NO_NODE)
            follow(flow, step, 0, flow->label[command.argument], step->stack);
        break;
    case 'I':
        follow_jump_if(flow, step);
        break;
    case 'O':
        if (!may_be_set(flow, command.argument))
            flow->marks[step->index] |= FLOW_STUCK;
        else
            fall_through(flow, step);
        break;
    default:
        fall_through(flow, step);
        break;
    }
}

static void process(struct flow *flow, uint32_t at)
{
    struct flow_node *node = &flow->nodes[at];
    node->queued = false;
    if (node->index == flow->code->count)
        return;
    struct step step = {.node = at, .context = node->context, .index = node->index, .stack = node->stack};
    step.command = flow->code->commands[node->index].command;
    step.out = node->in;
    const bool for_ever = code_is_endless(step.command) && !flow_state_guarded(&step.out);
    flow_state_execute(&step.out, step.command, step.index);
    if (!for_ever)
        follow_command(flow, &step);
}

/* ---- Begin and end -------------------------------------------------------------------------------------------------- */

static void find_labels(struct flow *flow)
{
    const struct code *code = flow->code;
    for (unsigned i = 0; i <= RKM04_LABELS; i++)
        flow->label[i] = FLOW_NO_NODE;
    for (size_t i = code->first; i < code->count; i++) {
        struct rkm04_command command = code->commands[i].command;
        if (command.op == '@')
            flow->label[command.argument] = (uint32_t)i; /* the one written last counts (C8) */
        else if (command.op == '\'')
            flow->called[command.argument] = true;
        else if (code_is_jump(command))
            flow->jumped[code_label(command)] = true;
    }
}

static bool make_tables(struct flow *flow)
{
    const size_t count = flow->code->count + 1;
    flow->first_node = malloc(count * sizeof *flow->first_node);
    flow->first_stack = calloc(count, sizeof *flow->first_stack);
    flow->marks = calloc(count, 1);
    flow->stacks = room_for(flow, NULL, 0, &flow->stack_room, sizeof *flow->stacks);
    if (flow->first_node == NULL || flow->first_stack == NULL || flow->marks == NULL || flow->stacks == NULL)
        return false;
    for (size_t i = 0; i < count; i++)
        flow->first_node[i] = FLOW_NO_NODE;
    flow->stacks[0] = (struct flow_stack){0};
    flow->stack_count = 1;
    return find_context(flow, (uint32_t)flow->code->first, 0, 0) == 0;
}

bool flow_begin(struct flow *flow, const struct code *code, uint16_t settable)
{
    *flow = (struct flow){.code = code, .settable = settable, .complete = true};
    find_labels(flow);
    if (code->count - code->first > FLOW_COMMANDS_MAX) {
        flow->complete = false;
        return true;
    }
    if (!make_tables(flow))
        return false;
    struct flow_state start = flow_state_begin();
    reach(flow, 0, (uint32_t)code->first, 0, &start);
    while (flow->queue_count > 0 && !flow->no_memory)
        process(flow, flow->queue[--flow->queue_count]);
    return !flow->no_memory;
}

void flow_end(struct flow *flow)
{
    free(flow->nodes);
    free(flow->contexts);
    free(flow->stacks);
    free(flow->first_node);
    free(flow->first_stack);
    free(flow->marks);
    free(flow->queue);
    *flow = (struct flow){0};
}
