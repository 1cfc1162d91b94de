/* SPDX-License-Identifier: MIT */
/* flow.h: which command of a program may follow which, in which loops and calls, and what is known of the motor before each.
 *
 * A node is a command in one situation: the call level with its entry and the number of loops open there (a context), and the
 * loops opened since (a stack). Nodes are found by following the program from its beginning; a subroutine is followed once for
 * each context, not for each call. Where the program stops because of a fault, the flow continues as if there were none, so that
 * one mistake is one diagnostic. */
#ifndef RKM04_PROGRAM_TOOLS_FLOW_H
#define RKM04_PROGRAM_TOOLS_FLOW_H

#include "code.h"
#include "flow_state.h"

#define FLOW_COMMANDS_MAX 7000u   /* a longer program is not followed */
#define FLOW_SITUATIONS_MAX 64u   /* of one command; where there are more, the flow is incomplete */
#define FLOW_NODES_MAX 100000u
#define FLOW_CONTEXTS_MAX 500u
#define FLOW_NO_NODE UINT32_MAX

/* Of a command, in flow.marks. */
enum flow_mark {
    FLOW_REACHED = 1,
    FLOW_NO_LOOP = 2,      /* E: no loop is open in this call level */
    FLOW_LOOP_LEVELS = 4,  /* L: a 9th level */
    FLOW_LOOP_CLOSED = 8,  /* L: some E belongs to it */
    FLOW_NO_CALL = 16,     /* . outside a subroutine */
    FLOW_CALL_LEVELS = 32, /* ': a 7th level */
    FLOW_RUN_INTO = 64,    /* @ of a subroutine, reached from the command before it outside of any call */
    FLOW_STUCK = 128       /* O, I: the variable is never set */
};

struct flow_node {
    uint32_t index;      /* of the command; code->count: the end of the program */
    uint32_t context, stack;
    uint32_t next[2];    /* what may follow; of a call: the subroutine, and what follows its return. FLOW_NO_NODE: nothing */
    uint32_t same;       /* another node of this command */
    uint32_t caller;     /* of a call: another call into its context */
    uint32_t component;  /* flow_find_cycles() */
    bool queued;
    struct flow_state in;
};

struct flow_context {
    uint32_t entry, loops, calls; /* entry: index of the label; loops open at the call; call level */
    uint32_t callers;             /* first call into it */
    bool returns;
    struct flow_state out;        /* after its returns */
};

struct flow_stack {
    uint32_t parent, loop, depth; /* `loop`: index of the L on top */
    uint32_t same;                /* another stack with it on top */
};

struct flow {
    const struct code *code;
    struct flow_node *nodes;
    struct flow_context *contexts;
    struct flow_stack *stacks;  /* 0: no loop */
    uint32_t *first_node;       /* of each command and of the end */
    uint32_t *first_stack;      /* of each L */
    uint8_t *marks;             /* enum flow_mark of each command */
    uint32_t *queue;
    size_t node_count, context_count, stack_count, queue_count;
    size_t node_room, context_room, stack_room, queue_room;
    uint32_t label[RKM04_LABELS + 1]; /* index of the one that counts; FLOW_NO_NODE: none */
    bool called[RKM04_LABELS + 1], jumped[RKM04_LABELS + 1]; /* by some command of the program */
    uint16_t settable;          /* VAR that may be 1: VAR 80 in bit 0 */
    bool complete;              /* everything has been followed */
    bool no_memory;
};

/* Follow the program of `code`. `settable`: variables that may ever be 1. flow_end() is due in any case. Returns false if out of
 * memory. */
bool flow_begin(struct flow *flow, const struct code *code, uint16_t settable);
void flow_end(struct flow *flow);

/* The next node that may follow `node` in time: of a call the subroutine, of a return what follows the calls. `*cursor`: 0 at
 * first. Returns FLOW_NO_NODE after the last one. */
uint32_t flow_follower(const struct flow *flow, uint32_t node, uint32_t *cursor);

/* Give all nodes that reach each other the same component. Returns the number of components, 0 if out of memory. */
size_t flow_find_cycles(struct flow *flow);

#endif
