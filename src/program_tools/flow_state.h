/* SPDX-License-Identifier: MIT */
/* flow_state.h: what is known of a motor before a command, whatever way led there: one value, or that there are several. */
#ifndef RKM04_PROGRAM_TOOLS_FLOW_STATE_H
#define RKM04_PROGRAM_TOOLS_FLOW_STATE_H

#include "code.h"

#define FLOW_UNKNOWN INT64_MIN /* several values, or one that is not known */
#define FLOW_NONE (-1)         /* no command */
#define FLOW_SEVERAL (-2)      /* more than one command */

/* Sets of possibilities: one bit each; a single bit is certainty. */
enum { FLOW_COUNT_NONE = 1, FLOW_COUNT_SET = 2, FLOW_COUNT_GO = 4 };  /* where the step count comes from: start, F or B, Gn */
enum { FLOW_FORWARD = 1, FLOW_BACK = 2 };
enum { FLOW_AFTER_OTHER = 1, FLOW_AFTER_GO = 2, FLOW_AFTER_HOME = 4 }; /* since then no step count, direction, motion or Y */

struct flow_segment {
    uint32_t steps, from; /* `from`: its Y */
    uint16_t speed, acceleration;
};

struct flow_state {
    int64_t position, count;            /* counter, steps of R */
    int64_t start_speed, speed, acceleration;
    int32_t m_from, n_from;             /* the M, N that is armed: FLOW_NONE, FLOW_SEVERAL */
    uint16_t table;                     /* bit n: n segments are in the Y table; bit 11: more than ten */
    uint16_t guard_m, guard_n;          /* bit 0: not armed; bit n: armed with input n */
    uint16_t count_from, direction, after;
    uint16_t table_direction;            /* of its segments */
    bool table_known;                   /* the number of segments is certain, and `segment` has them */
    bool table_empty_segment;           /* a segment without steps is certain */
    struct flow_segment segment[RKM04_SEGMENTS_MAX];
};

/* A motor after power-up; its position is not known. */
struct flow_state flow_state_begin(void);

/* The state after command number `index`. */
void flow_state_execute(struct flow_state *state, struct rkm04_command command, size_t index);

/* Both `*state` and `other` are possible. Returns whether that is news to `*state`. */
bool flow_state_join(struct flow_state *state, const struct flow_state *other);

/* May M or N be armed? */
static inline bool flow_state_guarded(const struct flow_state *state)
{
    return state->guard_m > 1 || state->guard_n > 1;
}

/* Steps and direction of the motion that this R, Gn or H makes, unless a table is run. Returns false if they are not known. */
bool flow_state_way(const struct flow_state *state, struct rkm04_command command, int64_t *steps, bool *forward);

#endif
