/* SPDX-License-Identifier: MIT */
/* check_motions.c: motions without steps, twice, without ramps, too short for their speed; Y tables. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "check_inside.h"

/* One command in one situation; each warning is reported once for a command. */
struct look {
    struct check *check;
    const struct check_motor *motor;
    uint64_t *told; /* of each command: bit w, warning w */
    size_t index;
    struct rkm04_command command;
    const struct flow_state *in;
};

static bool is_news(const struct look *look, enum check_warning warning, size_t index)
{
    const uint64_t bit = UINT64_C(1) << warning;
    if (look->told[index] & bit || look->check->options->off & bit)
        return false;
    look->told[index] |= bit;
    return true;
}

/* ---- R, G, H -------------------------------------------------------------------------------------------------------- */

static void check_run(const struct look *look)
{
    const struct flow_state *in = look->in;
    const size_t i = look->index;
    if (in->table != 1)
        return;
    if (in->count_from == FLOW_COUNT_NONE && is_news(look, CHECK_NO_STEPS, i))
        check_warn(look->check, look->motor, CHECK_NO_STEPS, i, i, "F1000 R moves 1000 steps forward",
                   "R without steps does nothing: no F, B or G before it");
    if ((in->after == FLOW_AFTER_GO || in->after == FLOW_AFTER_HOME) && is_news(look, CHECK_MOVES_AGAIN, i))
        check_warn(look->check, look->motor, CHECK_MOVES_AGAIN, i, i, "G and H need no R", "%s has moved already: R moves again",
                   in->after == FLOW_AFTER_GO ? "G" : "H");
}

static void report_peak(const struct look *look, enum check_warning warning, size_t at, int64_t speed, uint32_t peak)
{
    check_warn(look->check, look->motor, warning, at, at, "more steps, a higher A or S, or a lower V",
               "V%" PRId64 " is not reached: the peak of %s is %" PRIu32 " steps/s", speed,
               at == look->index ? "this motion" : "this segment", peak);
}

static void check_single(const struct look *look)
{
    const struct flow_state *in = look->in;
    int64_t steps;
    bool forward;
    if (in->start_speed == FLOW_UNKNOWN || in->speed == FLOW_UNKNOWN)
        return;
    const bool known = flow_state_way(in, look->command, &steps, &forward);
    if (known && steps == 0)
        return;
    if (in->speed <= in->start_speed) {
        if (is_news(look, CHECK_NO_RAMP, look->index))
            check_warn(look->check, look->motor, CHECK_NO_RAMP, look->index, look->index, NULL,
                       "V%" PRId64 " is not higher than S%" PRId64 ": the motion has constant speed and no ramps", in->speed,
                       in->start_speed);
        return;
    }
    /* Both ramps take (V^2 - S^2) / A steps (R1). Only where that is more than there are the unit is asked. */
    if (!known || in->acceleration == FLOW_UNKNOWN || steps > 2000000000 ||
        in->speed * in->speed - in->start_speed * in->start_speed <= in->acceleration * steps ||
        !is_news(look, CHECK_SPEED_NOT_REACHED, look->index))
        return;
    const struct planner_segment segment = {(uint32_t)steps, (uint16_t)in->speed, (uint16_t)in->acceleration};
    struct planner_point points[PLANNER_POINTS_MAX];
    uint32_t peak = 0;
    size_t count = planner_ask(&look->check->planner, (uint16_t)in->start_speed, &segment, 1, points);
    for (size_t i = 0; i < count; i++)
        peak = points[i].speed > peak ? points[i].speed : peak;
    if (count > 0 && peak < in->speed)
        report_peak(look, CHECK_SPEED_NOT_REACHED, look->index, in->speed, peak);
}

/* ---- Compound motions ----------------------------------------------------------------------------------------------- */

/* The speed at a place, in whole steps from the begin. Between two points the square of the speed is linear (R1). */
static uint32_t speed_at(const struct planner_point *points, size_t count, uint64_t place)
{
    size_t next = 1;
    while (next < count - 1 && points[next].step < place + 1)
        next++;
    const struct planner_point *left = &points[next - 1], *right = &points[next];
    if (left->speed == right->speed || place + 1 <= left->step || right->step == left->step)
        return left->speed;
    const double from = (double)left->speed * left->speed, to = (double)right->speed * right->speed;
    const double part = (double)(place + 1 - left->step) / (double)(right->step - left->step);
    return (uint32_t)sqrt(from + (to - from) * (part < 1 ? part : 1));
}

/* The highest speed between two places of a motion. */
static uint32_t peak_between(const struct planner_point *points, size_t count, uint64_t from, uint64_t to)
{
    const uint32_t begin = speed_at(points, count, from), end = speed_at(points, count, to);
    uint32_t peak = begin > end ? begin : end;
    for (size_t i = 0; i < count; i++)
        if (points[i].step >= from + 1 && points[i].step <= to + 1 && points[i].speed > peak)
            peak = points[i].speed;
    return peak;
}

static void check_table(const struct look *look)
{
    const struct flow_state *in = look->in;
    struct planner_segment segments[RKM04_SEGMENTS_MAX];
    struct planner_point points[PLANNER_POINTS_MAX];
    unsigned count = 0;
    if (!in->table_known || in->table_empty_segment || in->start_speed == FLOW_UNKNOWN || in->table >> 11 != 0 ||
        in->table_direction == (FLOW_FORWARD | FLOW_BACK) || (look->check->options->off >> CHECK_SPEED_NOT_REACHED & 1))
        return;
    for (; in->table >> count != 1; count++) {
        const struct flow_segment *one = &in->segment[count];
        if (one->steps > 16000000)
            return;
        segments[count] = (struct planner_segment){one->steps, one->speed, one->acceleration};
    }
    const size_t answered = planner_ask(&look->check->planner, (uint16_t)in->start_speed, segments, count, points);
    uint64_t from = 0;
    for (unsigned i = 0; answered > 1 && i < count; from += segments[i++].steps) {
        uint32_t peak = peak_between(points, answered, from, from + segments[i].steps);
        if (peak < segments[i].speed && is_news(look, CHECK_SPEED_NOT_REACHED, in->segment[i].from))
            report_peak(look, CHECK_SPEED_NOT_REACHED, in->segment[i].from, segments[i].speed, peak);
    }
}

static void check_segment(const struct look *look)
{
    const struct flow_state *in = look->in;
    const size_t i = look->index;
    const unsigned both = FLOW_FORWARD | FLOW_BACK;
    if (in->table == 1u << RKM04_SEGMENTS_MAX && is_news(look, CHECK_TOO_MANY_SEGMENTS, i))
        check_warn(look->check, look->motor, CHECK_TOO_MANY_SEGMENTS, i, i, "the unit cannot plan the motion: the LED blinks",
                   "an eleventh segment: a compound motion has ten at most");
    if ((in->table & 1) == 0 && in->direction != both && in->table_direction != both && in->direction != in->table_direction &&
        is_news(look, CHECK_MIXED_DIRECTIONS, i))
        check_warn(look->check, look->motor, CHECK_MIXED_DIRECTIONS, i, i, "the unit cannot plan the motion: the LED blinks",
                   "this segment moves %s, those before it %s", in->direction == FLOW_FORWARD ? "forward" : "back",
                   in->direction == FLOW_FORWARD ? "back" : "forward");
    if (in->count == 0 && is_news(look, CHECK_EMPTY_SEGMENT, i))
        check_warn(look->check, look->motor, CHECK_EMPTY_SEGMENT, i, i, "the unit cannot plan the motion: the LED blinks",
                   "a segment without steps: no F, B or G before it");
}

static void check_mark(const struct look *look)
{
    const size_t i = look->index;
    const unsigned number = look->command.argument;
    if (number >= 51 && number <= 58 && (look->in->table & 1) == 0 && is_news(look, CHECK_LATE_MARK, i))
        check_warn(look->check, look->motor, CHECK_LATE_MARK, i, i, "put it before the first Y",
                   "T%u after the first Y has no effect on this motion", number);
}

static void check_command(const struct look *look)
{
    switch (look->command.op) {
    case 'R':
        check_run(look);
        if (look->in->table == 1)
            check_single(look);
        else
            check_table(look);
        break;
    case 'G':
    case 'H':
        check_single(look);
        break;
    case 'Y':
        check_segment(look);
        break;
    case 'T':
        check_mark(look);
        break;
    default:
        break;
    }
}

void check_motions(struct check *check, const struct check_motor *motor)
{
    const struct flow *flow = &motor->flow;
    struct look look = {.check = check, .motor = motor, .told = calloc(motor->code.count + 1, sizeof *look.told)};
    if (look.told == NULL) {
        check->found->no_memory = true;
        return;
    }
    for (size_t i = 0; i < flow->node_count; i++) {
        const struct flow_node *node = &flow->nodes[i];
        if (node->index == motor->code.count)
            continue;
        look.index = node->index;
        look.command = motor->code.commands[node->index].command;
        look.in = &node->in;
        check_command(&look);
    }
    free(look.told);
}
