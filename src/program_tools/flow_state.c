/* SPDX-License-Identifier: MIT */
#include "flow_state.h"

#include <string.h>

struct flow_state flow_state_begin(void)
{
    return (struct flow_state){
        .position = FLOW_UNKNOWN,
        .start_speed = 100, /* U8 */
        .speed = 1000,
        .acceleration = 2000,
        .m_from = FLOW_NONE,
        .n_from = FLOW_NONE,
        .table = 1,
        .guard_m = 1,
        .guard_n = 1,
        .count_from = FLOW_COUNT_NONE,
        .direction = FLOW_FORWARD,
        .after = FLOW_AFTER_OTHER,
        .table_known = true,
    };
}

/* ---- Joins ---------------------------------------------------------------------------------------------------------- */

/* Each takes what else is possible into *value. Returns whether that is news. */
static bool join_value(int64_t *value, int64_t other)
{
    if (*value == other || *value == FLOW_UNKNOWN)
        return false;
    *value = FLOW_UNKNOWN;
    return true;
}

static bool join_from(int32_t *from, int32_t other)
{
    if (*from == other || other == FLOW_NONE || *from == FLOW_SEVERAL)
        return false;
    *from = *from == FLOW_NONE ? other : FLOW_SEVERAL;
    return true;
}

static bool join_set(uint16_t *set, uint16_t other)
{
    const uint16_t before = *set;
    *set |= other;
    return *set != before;
}

static bool join_table(struct flow_state *state, const struct flow_state *other)
{
    bool news = state->table_empty_segment && !other->table_empty_segment;
    state->table_empty_segment = state->table_empty_segment && other->table_empty_segment;
    if (state->table_known && (!other->table_known || state->table != other->table ||
                               memcmp(state->segment, other->segment, sizeof state->segment) != 0)) {
        state->table_known = false;
        memset(state->segment, 0, sizeof state->segment);
        news = true;
    }
    news |= join_set(&state->table, other->table);
    return join_set(&state->table_direction, other->table_direction) || news;
}

bool flow_state_join(struct flow_state *state, const struct flow_state *other)
{
    bool news = join_value(&state->position, other->position);
    news |= join_value(&state->count, other->count);
    news |= join_value(&state->start_speed, other->start_speed);
    news |= join_value(&state->speed, other->speed);
    news |= join_value(&state->acceleration, other->acceleration);
    news |= join_from(&state->m_from, other->m_from);
    news |= join_from(&state->n_from, other->n_from);
    news |= join_set(&state->guard_m, other->guard_m);
    news |= join_set(&state->guard_n, other->guard_n);
    news |= join_set(&state->count_from, other->count_from);
    news |= join_set(&state->direction, other->direction);
    news |= join_set(&state->after, other->after);
    return join_table(state, other) || news;
}

/* ---- Commands ------------------------------------------------------------------------------------------------------- */

static void empty_table(struct flow_state *state)
{
    state->table = 1;
    state->table_direction = 0;
    state->table_known = true;
    state->table_empty_segment = false;
    memset(state->segment, 0, sizeof state->segment);
}

static unsigned certain_segments(const struct flow_state *state)
{
    unsigned count = 0;
    while (state->table >> count != 1)
        count++;
    return count;
}

static void enter_segment(struct flow_state *state, size_t index)
{
    const bool known = state->table_known && state->count != FLOW_UNKNOWN && state->count <= UINT32_MAX &&
                       state->speed != FLOW_UNKNOWN && state->acceleration != FLOW_UNKNOWN;
    const unsigned count = known ? certain_segments(state) : 0;
    if (known && count < RKM04_SEGMENTS_MAX)
        state->segment[count] = (struct flow_segment){(uint32_t)state->count, (uint32_t)index, (uint16_t)state->speed,
                                                      (uint16_t)state->acceleration};
    if (!known)
        memset(state->segment, 0, sizeof state->segment);
    state->table_known = known;
    state->table_empty_segment = state->table_empty_segment || state->count == 0;
    state->table_direction |= state->direction;
    state->table = (uint16_t)(((unsigned)state->table << 1 | (state->table & 0x800u)) & 0xFFFu);
    state->after = FLOW_AFTER_OTHER;
}

bool flow_state_way(const struct flow_state *state, struct rkm04_command command, int64_t *steps, bool *forward)
{
    if (command.op == 'R') {
        *steps = state->count;
        *forward = state->direction == FLOW_FORWARD;
        return state->count != FLOW_UNKNOWN && state->direction != (FLOW_FORWARD | FLOW_BACK);
    }
    if (state->position == FLOW_UNKNOWN || code_is_endless(command) || (command.op != 'G' && command.op != 'H'))
        return false;
    int64_t way = (command.op == 'G' ? (int64_t)command.argument : 0) - state->position;
    *steps = way < 0 ? -way : way;
    *forward = way == 0 ? state->direction == FLOW_FORWARD : way > 0;
    return true;
}

/* The counter after a motion of so many steps; 32 bits, it wraps (R8). */
static int64_t moved(int64_t position, int64_t steps, bool forward)
{
    return position == FLOW_UNKNOWN ? position : (int32_t)(uint32_t)(position + (forward ? steps : -steps));
}

static void run_table(struct flow_state *state)
{
    int64_t steps = 0;
    bool known = state->table_known && state->table_direction != (FLOW_FORWARD | FLOW_BACK);
    for (unsigned i = 0; known && i < certain_segments(state) && i < RKM04_SEGMENTS_MAX; i++)
        steps += state->segment[i].steps;
    state->position = known ? moved(state->position, steps, state->table_direction == FLOW_FORWARD) : FLOW_UNKNOWN;
    empty_table(state);
}

static void run_motion(struct flow_state *state, struct rkm04_command command)
{
    int64_t steps;
    bool forward;
    const bool known = flow_state_way(state, command, &steps, &forward);
    state->after = command.op == 'G' ? FLOW_AFTER_GO : command.op == 'H' ? FLOW_AFTER_HOME : FLOW_AFTER_OTHER;
    if (code_is_endless(command))
        state->after = FLOW_AFTER_OTHER;
    if (command.op == 'G' && !code_is_endless(command)) { /* sets count and direction (C13) */
        state->count = known ? steps : FLOW_UNKNOWN;
        state->count_from = FLOW_COUNT_GO;
        state->direction = known ? (forward ? FLOW_FORWARD : FLOW_BACK) : FLOW_FORWARD | FLOW_BACK;
    }
    if (command.op == 'R' && state->table != 1)
        run_table(state);
    else
        state->position = known ? moved(state->position, steps, forward) : FLOW_UNKNOWN;
    if (flow_state_guarded(state)) {
        state->position = FLOW_UNKNOWN;
        state->guard_m |= 1; /* used up, perhaps (C5) */
        state->guard_n |= 1;
    }
}

static void set_count(struct flow_state *state, uint32_t count, uint16_t direction)
{
    state->count = count;
    state->count_from = FLOW_COUNT_SET;
    state->direction = direction;
    state->after = FLOW_AFTER_OTHER;
}

static void arm(uint16_t *guard, int32_t *from, unsigned input, size_t index)
{
    *guard = (uint16_t)(1u << input);
    *from = (int32_t)index;
}

void flow_state_execute(struct flow_state *state, struct rkm04_command command, size_t index)
{
    switch (command.op) {
    case 'A':
        state->acceleration = command.argument;
        break;
    case 'S':
        state->start_speed = command.argument;
        break;
    case 'V':
        state->speed = command.argument;
        break;
    case 'F':
    case 'B':
        set_count(state, command.argument, command.op == 'F' ? FLOW_FORWARD : FLOW_BACK);
        break;
    case 'D':
        if (state->direction != (FLOW_FORWARD | FLOW_BACK))
            state->direction ^= FLOW_FORWARD | FLOW_BACK;
        state->after = FLOW_AFTER_OTHER;
        break;
    case 'C':
        if (command.argument == 100)
            state->position = 0;
        break;
    case '=':
        state->position = (int32_t)command.argument;
        break;
    case 'M':
        arm(&state->guard_m, &state->m_from, command.argument, index);
        break;
    case 'N':
        arm(&state->guard_n, &state->n_from, command.argument, index);
        break;
    case 'U':
        state->guard_m = state->guard_n = 1;
        state->m_from = state->n_from = FLOW_NONE;
        break;
    case 'Y':
        enter_segment(state, index);
        break;
    case 'W':
    case 'O':
    case 'Z':
    case '[':
        if (state->after == FLOW_AFTER_HOME) /* a new beginning; what R does then is meant */
            state->after = FLOW_AFTER_OTHER;
        break;
    default:
        if (code_is_motion(command))
            run_motion(state, command);
        break;
    }
}
