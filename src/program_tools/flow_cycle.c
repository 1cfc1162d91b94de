/* SPDX-License-Identifier: MIT */
/* flow_cycle.c: the cycles of a flow, by Tarjan's algorithm without recursion. */
#include <stdlib.h>

#include "flow.h"

uint32_t flow_follower(const struct flow *flow, uint32_t node, uint32_t *cursor)
{
    const struct flow_node *at = &flow->nodes[node];
    const struct flow_context *context = &flow->contexts[at->context];
    if (at->index == flow->code->count)
        return FLOW_NO_NODE;
    const uint8_t op = flow->code->commands[at->index].command.op;
    if (op == '.') {
        uint32_t caller = context->calls == 0 ? FLOW_NO_NODE : *cursor == 0 ? context->callers : flow->nodes[*cursor - 1].caller;
        if (caller == FLOW_NO_NODE)
            return FLOW_NO_NODE;
        *cursor = caller + 1;
        return flow->nodes[caller].next[1];
    }
    const unsigned ways = op == '\'' ? 1 : 2; /* the way after a call leads through its return */
    while (*cursor < ways) {
        uint32_t next = at->next[(*cursor)++];
        if (next != FLOW_NO_NODE)
            return next;
    }
    return FLOW_NO_NODE;
}

struct search {
    uint32_t *index, *low, *cursor; /* of each node; index 0: not met */
    uint32_t *stack, *path;         /* nodes without a component; nodes being visited, each a follower of the one before */
    size_t stacked, deep;
    uint32_t met, components;
};

static void enter(struct search *search, uint32_t node)
{
    search->index[node] = search->low[node] = ++search->met;
    search->stack[search->stacked++] = node;
    search->path[search->deep++] = node;
}

static void lower(uint32_t *low, uint32_t other)
{
    if (other < *low)
        *low = other;
}

static void leave(struct flow *flow, struct search *search, uint32_t node)
{
    search->deep--;
    if (search->deep > 0)
        lower(&search->low[search->path[search->deep - 1]], search->low[node]);
    if (search->low[node] != search->index[node])
        return;
    for (uint32_t other = FLOW_NO_NODE; other != node;) {
        other = search->stack[--search->stacked];
        flow->nodes[other].component = search->components;
    }
    search->components++;
}

static void search_from(struct flow *flow, struct search *search, uint32_t node)
{
    enter(search, node);
    while (search->deep > 0) {
        uint32_t at = search->path[search->deep - 1];
        uint32_t next = flow_follower(flow, at, &search->cursor[at]);
        if (next == FLOW_NO_NODE)
            leave(flow, search, at);
        else if (search->index[next] == 0)
            enter(search, next);
        else if (flow->nodes[next].component == FLOW_NO_NODE)
            lower(&search->low[at], search->index[next]);
    }
}

size_t flow_find_cycles(struct flow *flow)
{
    const size_t count = flow->node_count;
    uint32_t *memory = calloc(5 * count + 1, sizeof *memory);
    if (memory == NULL)
        return 0;
    struct search search = {.index = memory,
                            .low = memory + count,
                            .cursor = memory + 2 * count,
                            .stack = memory + 3 * count,
                            .path = memory + 4 * count};
    for (size_t i = 0; i < count; i++)
        flow->nodes[i].component = FLOW_NO_NODE;
    for (size_t i = 0; i < count; i++)
        if (search.index[i] == 0)
            search_from(flow, &search, (uint32_t)i);
    free(memory);
    return search.components;
}
