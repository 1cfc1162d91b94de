/* SPDX-License-Identifier: MIT */
#include "profile.h"

#include "ramp.h"
#include "wide.h"

/* Speeds are handled as their squares, which grow evenly with the way: q = 2 * speed^2 * 2^34 (rkm04_break.speed2), so that
 * q' = q + energy(a, way) with energy = 4 * a * way * 2^34. Every limit and border speed of a motion from standstill is then a
 * whole number. */
#define Q_MAX ((uint64_t)2 * RKM04_SPEED_MAX * RKM04_SPEED_MAX << RAMP_SPEED2_BITS)

static uint64_t q_of(uint32_t speed)
{
    return (uint64_t)2 * speed * speed << RAMP_SPEED2_BITS;
}

static uint64_t lower(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint16_t slower(uint16_t a, uint16_t b)
{
    return a < b ? a : b;
}

/* q + gain, or Q_MAX if that is less. */
static uint64_t raised(uint64_t q, uint64_t gain)
{
    return lower(Q_MAX, q + lower(Q_MAX, gain));
}

static uint64_t lowered(uint64_t q, uint64_t loss)
{
    return q - lower(q, loss);
}

/* ---- Places ------------------------------------------------------------------------------------------------------- */

static struct wide wide_of(struct rkm04_place place)
{
    return (struct wide){place.high, place.low};
}

static struct rkm04_place place_of(struct wide number)
{
    return (struct rkm04_place){number.high, number.low};
}

static struct rkm04_place place_at(uint32_t step)
{
    return (struct rkm04_place){(uint64_t)step << 32, 0};
}

/* The change q / (4 * a * 2^34) in steps, with 96 places, cut off; *inexact: something was. What ends at all does so within
 * 51 places. */
static struct wide way_of(uint64_t q, uint16_t acceleration, bool *inexact)
{
    uint64_t divisor = (uint64_t)4 * acceleration << RAMP_SPEED2_BITS;
    struct wide places = wide_fraction(q % divisor, divisor, inexact);
    return (struct wide){q / divisor << 32 | places.high >> 32, places.high << 32 | places.low >> 32};
}

/* Rounded towards the end of the motion, so that what begins there is not a tick late. */
static struct rkm04_place ahead(struct rkm04_place place, uint64_t q, uint16_t acceleration)
{
    bool inexact;
    struct wide way = way_of(q, acceleration, &inexact);
    return place_of(wide_sum(wide_sum(wide_of(place), way), (struct wide){0, inexact}));
}

/* Rounded towards the beginning. */
static struct rkm04_place behind(struct rkm04_place place, uint64_t q, uint16_t acceleration)
{
    bool inexact;
    struct wide way = way_of(q, acceleration, &inexact);
    return place_of(wide_difference(wide_difference(wide_of(place), way), (struct wide){0, inexact}));
}

static bool is_before(struct rkm04_place a, struct rkm04_place b)
{
    return wide_less(wide_of(a), wide_of(b));
}

/* q gained on the way from `from` to `to`; 2 * Q_MAX if that or more. */
static uint64_t energy(uint16_t acceleration, struct rkm04_place from, struct rkm04_place to)
{
    struct wide way = wide_difference(wide_of(to), wide_of(from));
    uint64_t factor = (uint64_t)4 * acceleration;
    if ((way.high >> 32) > (2 * Q_MAX >> RAMP_SPEED2_BITS) / factor)
        return 2 * Q_MAX;
    /* factor * way has 96 places; keep 34 of them. */
    struct wide gain = {way.high * factor + wide_high(way.low, factor), way.low * factor};
    return lower(2 * Q_MAX, gain.high << 2 | gain.low >> 62);
}

#define ROUNDING 64u /* differences of q up to this are none; those that a plan means are millions of times as large */

/* Is there a way between two places? */
static bool has_length(uint16_t acceleration, struct rkm04_place from, struct rkm04_place to)
{
    return is_before(from, to) && energy(acceleration, from, to) > ROUNDING;
}

/* ---- The table of break points -------------------------------------------------------------------------------------- */

/* Append a break point; where nothing bends, none is needed. The first of a plan, at profile->leg, always is one. The oldest
 * passed one makes room for a change too many. */
static void add_break(struct rkm04_profile *profile, struct rkm04_place at, uint64_t q, int32_t slope)
{
    if (profile->count > profile->leg) {
        const struct rkm04_break *last = &profile->point[profile->count - 1];
        if (last->slope == slope && (slope != 0 || last->speed2 == q))
            return;
    }
    if (profile->count == RKM04_BREAKS_MAX) {
        for (unsigned i = 1; i < RKM04_BREAKS_MAX; i++)
            profile->point[i - 1] = profile->point[i];
        profile->count--;
        profile->leg--;
    }
    profile->point[profile->count++] = (struct rkm04_break){.speed2 = q, .at = at, .slope = slope};
}

static void add_end(struct rkm04_profile *profile, struct rkm04_place at, uint64_t q)
{
    add_break(profile, at, q, INT32_MIN); /* a slope that no other point has */
}

/* ---- The plan ----------------------------------------------------------------------------------------------------- */

/* The present state of planning: a place in a segment, and the speed there. */
struct state {
    struct rkm04_place at;
    uint64_t q;
    unsigned segment;
    bool moving; /* a present speed, which may be above the limit, instead of one to be chosen */
};

/* End of a segment, counted from the begin of the motion. */
static struct rkm04_place end_of(const struct rkm04_motion *motion, unsigned segment)
{
    uint32_t steps = 0;
    for (unsigned i = 0; i <= segment; i++)
        steps += motion->segment[i].steps;
    return place_at(steps);
}

/* The segment that a place belongs to; a border belongs to the later one. */
static unsigned segment_at(const struct rkm04_motion *motion, struct rkm04_place at)
{
    unsigned segment = 0;
    while (segment + 1 < motion->segments && !is_before(at, end_of(motion, segment)))
        segment++;
    return segment;
}

/* Adds the break points that bring a present speed to the limit of its segment; leaves in *state where that is done, at the
 * end of the segment at the latest. At or below S a change happens at once (R6), up to a speed from which the segment's end can
 * be reached with speed `leave`. */
static void reach_limit(struct rkm04_motion *motion, struct state *state, struct rkm04_place end, uint64_t limit, uint64_t leave)
{
    struct rkm04_profile *profile = &motion->profile;
    uint16_t deceleration = motion->segment[state->segment].deceleration;
    uint64_t jump = q_of(motion->start_speed);
    uint64_t at_once = lower(lower(limit, jump), raised(leave, energy(deceleration, state->at, end)));
    if (state->moving && at_once > state->q + ROUNDING) {
        add_break(profile, state->at, state->q, 0);
        state->q = at_once;
    }
    if (state->q <= limit)
        return;
    uint64_t floor = lower(state->q, jump > limit ? jump : limit);
    struct rkm04_place down = ahead(state->at, state->q - floor, deceleration);
    if (floor < state->q)
        add_break(profile, state->at, state->q, -(int32_t)deceleration);
    if (is_before(end, down)) {
        state->q = lowered(state->q, energy(deceleration, state->at, end));
        state->at = end;
        return;
    }
    if (floor > limit)
        add_break(profile, down, floor, 0);
    state->q = limit;
    state->at = down;
}

/* q at which a rise from q meets the fall to `leave`, with nothing between them: q + gain * part, where the way is shared so that
 * both come out the same. gain: of the whole way, rising. */
static uint64_t peak_of(const struct rkm04_segment *segment, uint64_t q, uint64_t leave, uint64_t gain)
{
    const uint32_t a = segment->acceleration, d = segment->deceleration;
    uint64_t rest;
    if (a == d)
        return q / 2 + leave / 2 + gain / 2;
    struct wide sum = wide_sum(wide_product(q, d), wide_product(leave, a));
    sum = wide_sum(sum, wide_product(gain, d));
    return wide_divide(sum, a + d, &rest);
}

/* The break points of one segment from *state to its end with speed `leave` there (R1 between two border speeds). */
static void plan_segment(struct rkm04_motion *motion, const struct state *state, struct rkm04_place end, uint64_t leave)
{
    struct rkm04_profile *profile = &motion->profile;
    const struct rkm04_segment *segment = &motion->segment[state->segment];
    uint64_t limit = q_of(segment->speed);
    uint64_t gain = energy(segment->acceleration, state->at, end);
    uint64_t peak = lower(limit, peak_of(segment, state->q, leave, gain));
    struct rkm04_place top = state->at;
    if (peak > state->q) {
        add_break(profile, state->at, state->q, segment->acceleration);
        top = ahead(state->at, peak - state->q, segment->acceleration);
    }
    struct rkm04_place fall = peak > leave ? behind(end, peak - leave, segment->deceleration) : end;
    /* At the limit: below it the two are the same place. */
    bool level = has_length(slower(segment->acceleration, segment->deceleration), top, fall);
    if (level)
        add_break(profile, top, peak, 0);
    if (peak > leave)
        add_break(profile, level ? fall : top, peak, -(int32_t)segment->deceleration);
}

/* The speeds at the segments' ends: limits, then what can be braked from, then what can be reached (R4). */
static void plan_borders(const struct rkm04_motion *motion, const struct state *from, uint64_t *start, uint64_t *leave)
{
    unsigned last = motion->segments - 1u;
    leave[last] = q_of(slower(motion->start_speed, motion->segment[last].speed));
    for (unsigned i = last; i-- > from->segment;)
        leave[i] = q_of(slower(motion->segment[i].speed, motion->segment[i + 1].speed));
    for (unsigned i = last; i > from->segment; i--) {
        uint64_t gain = energy(motion->segment[i].deceleration, end_of(motion, i - 1), end_of(motion, i));
        leave[i - 1] = lower(leave[i - 1], raised(leave[i], gain));
    }
    if (!from->moving) {
        struct rkm04_place end = end_of(motion, from->segment);
        uint64_t gain = energy(motion->segment[from->segment].deceleration, from->at, end);
        *start = lower(*start, raised(leave[from->segment], gain));
    }
}

static void plan_steps(struct rkm04_motion *motion, struct state state)
{
    uint64_t leave[RKM04_SEGMENTS_MAX];
    plan_borders(motion, &state, &state.q, leave);
    for (; state.segment < motion->segments; state.segment++) {
        const struct rkm04_segment *segment = &motion->segment[state.segment];
        struct rkm04_place end = end_of(motion, state.segment);
        reach_limit(motion, &state, end, q_of(segment->speed), leave[state.segment]);
        uint64_t out = lower(leave[state.segment], raised(state.q, energy(segment->acceleration, state.at, end)));
        uint64_t least = lowered(state.q, energy(segment->deceleration, state.at, end));
        if (out < least) /* a present speed that cannot be braked in time */
            out = least;
        plan_segment(motion, &state, end, out);
        state.q = out;
        state.at = end;
        state.moving = false;
    }
    add_end(&motion->profile, state.at, state.q);
}

static void plan_endless(struct rkm04_motion *motion, struct state state)
{
    uint64_t limit = q_of(motion->segment[0].speed);
    uint16_t acceleration = motion->segment[0].acceleration;
    reach_limit(motion, &state, (struct rkm04_place){UINT64_MAX, UINT64_MAX}, limit, limit);
    if (state.q < limit) {
        add_break(&motion->profile, state.at, state.q, acceleration);
        state.at = ahead(state.at, limit - state.q, acceleration);
    }
    add_break(&motion->profile, state.at, limit, 0);
    motion->profile.endless = true;
}

static void plan_from(struct rkm04_motion *motion, struct state state)
{
    motion->profile.endless = false;
    if (motion->kind == RKM04_MOTION_STEPS)
        plan_steps(motion, state);
    else
        plan_endless(motion, state);
}

void profile_plan(struct rkm04_motion *motion)
{
    struct rkm04_profile *profile = &motion->profile;
    struct rkm04_place at = place_at(motion->done);
    unsigned segment = segment_at(motion, at);
    uint16_t speed = motion->segment[segment].speed;
    if (profile->count != 0) { /* after a hold: its end is no end any more */
        profile->count--;
        profile->leg = profile->count;
    } else {
        profile->leg = 0;
    }
    plan_from(motion, (struct state){at, q_of(slower(speed, motion->start_speed)), segment, false});
}

/* ---- Planning again while moving -------------------------------------------------------------------------------------- */

/* w^2, the places after the point counted in as far as they matter. */
static struct wide square_of(struct rkm04_fixed w)
{
    struct wide square = wide_product((uint64_t)w.whole, (uint64_t)w.whole);
    return wide_sum(square, (struct wide){0, wide_high(w.part, (uint64_t)w.whole * 2)});
}

/* w at `tick`, and y counted from the last whole step instead of the next one: from 0 to RAMP_STEP. */
static void state_since_step(const struct rkm04_motion *motion, uint64_t tick, struct rkm04_fixed *y, struct rkm04_fixed *w)
{
    ramp_state_at(&motion->ramp, tick, y, w);
    y->whole += motion->ramp.step;
}

/* The place and speed at `tick`, from the pulse generator. */
static struct state present_state(const struct rkm04_motion *motion, uint64_t tick)
{
    struct rkm04_fixed y, w;
    state_since_step(motion, tick, &y, &w);
    uint64_t rest;
    /* y / RAMP_STEP, which may be 1, with 127 places. */
    uint64_t high = wide_divide((struct wide){(uint64_t)y.whole, y.part}, 2 * (uint64_t)motion->ramp.step, &rest);
    uint64_t low = wide_divide((struct wide){rest, 0}, 2 * (uint64_t)motion->ramp.step, &rest);
    struct state state = {.moving = true};
    state.at = (struct rkm04_place){((uint64_t)motion->done << 32) + (high >> 31), high << 33 | low >> 31};
    state.q = wide_divide(wide_shifted(square_of(w), RAMP_SPEED2_BITS), (uint64_t)motion->ramp.step, &rest);
    state.segment = segment_at(motion, state.at);
    return state;
}

/* Does the speed only fall from here to the end? */
static bool on_final_ramp(const struct rkm04_motion *motion)
{
    const struct rkm04_profile *profile = &motion->profile;
    if (profile->endless)
        return false;
    for (unsigned i = profile->leg; i < profile->count; i++) /* the end falls, too */
        if (profile->point[i].slope >= 0)
            return false;
    return true;
}

/* Keep the points that were passed; the next one added is where the motion is now. */
static void mark_present_place(struct rkm04_profile *profile)
{
    profile->leg++;
    profile->count = profile->leg;
}

void profile_change_speed(struct rkm04_motion *motion, uint64_t tick, uint16_t speed)
{
    if (on_final_ramp(motion))
        return;
    struct state state = present_state(motion, tick);
    motion->segment[state.segment].speed = speed;
    motion->changed = true;
    mark_present_place(&motion->profile);
    plan_from(motion, state);
    ramp_continue(&motion->ramp, &motion->profile, tick);
}

/* Where a stop ends, in exact arithmetic (R5). In units of 1/(8e12 * a) step the way from a whole step is a whole number:
 * w^2 - (2e6 * S)^2 plus 4 * a * y, with y counted from that step. */
struct stop {
    struct wide energy; /* w^2 - w_S^2 still to be lost; 0 at a speed up to S */
    uint64_t offset;    /* 4 * a * y: how far the motion is behind `step` */
    uint32_t step;
};

/* What lies less than this above a whole number of steps, in units of 1/(8e12 * deceleration) step, counts as that number.
 * Irrational ways shall (R5: a millionth of a step), rational ones only as far as they were rounded up: not at all, or after a
 * change of speed, whose place is kept with 2^-34 of speed2, by a hundred units of the acceleration there at each; the next
 * rational way above a whole number then is 4 000 000 units off. */
static uint64_t tolerance_of_stop(const struct rkm04_motion *motion, uint16_t deceleration)
{
    if (!motion->ramp.exact)
        return (uint64_t)4 * deceleration * (uint64_t)motion->ramp.step / 1000000;
    if (!motion->changed)
        return 1;
    uint16_t least = deceleration;
    for (unsigned i = 0; i < motion->segments; i++)
        least = slower(least, slower(motion->segment[i].acceleration, motion->segment[i].deceleration));
    return (uint64_t)100000 * deceleration / least;
}

/* The motion is y behind stop->step. */
static void set_offset(struct stop *stop, struct rkm04_fixed y, uint16_t deceleration)
{
    const uint64_t factor = (uint64_t)4 * deceleration;
    stop->offset = (uint64_t)y.whole * factor + wide_high(y.part, factor);
}

/* Steps from stop->step to the end of the ramp at this deceleration, rounded up. */
static uint32_t steps_of_stop(const struct rkm04_motion *motion, const struct stop *stop, uint16_t deceleration)
{
    const uint64_t unit = (uint64_t)4 * deceleration * (uint64_t)motion->ramp.step;
    struct wide way = wide_sum(stop->energy, (struct wide){0, stop->offset});
    uint64_t rest, steps = wide_divide(way, unit, &rest);
    return (uint32_t)steps + (rest >= tolerance_of_stop(motion, deceleration));
}

/* Steps from motion->done to the end of a stop in the first segment. */
static uint32_t first_stop(const struct rkm04_motion *motion, struct stop stop, struct rkm04_fixed y)
{
    const uint16_t deceleration = motion->segment[0].deceleration;
    set_offset(&stop, y, deceleration);
    return steps_of_stop(motion, &stop, deceleration);
}

/* The last step of a stop from `state`, where 2e12 * position lies `y` behind the last whole step, and the break points of its
 * ramp, one a segment. */
static uint32_t plan_stop(struct rkm04_motion *motion, struct state *state, struct stop stop, struct rkm04_fixed y)
{
    for (;; state->segment++) {
        uint16_t deceleration = motion->segment[state->segment].deceleration;
        set_offset(&stop, y, deceleration);
        uint32_t last = stop.step + steps_of_stop(motion, &stop, deceleration);
        bool falling = (stop.energy.high | stop.energy.low) != 0;
        add_break(&motion->profile, state->at, state->q, falling ? -(int32_t)deceleration : 0);
        if (motion->kind != RKM04_MOTION_STEPS)
            return last;
        struct rkm04_place end = end_of(motion, state->segment);
        uint32_t end_step = ramp_step_of(end);
        if (last <= end_step || end_step == motion->total)
            return (uint32_t)lower(last, motion->total);
        struct wide lost = wide_product((uint64_t)4 * deceleration * (uint64_t)motion->ramp.step, end_step - stop.step);
        lost = wide_difference(lost, (struct wide){0, stop.offset});
        stop.energy = wide_difference(stop.energy, lost);
        state->q = lowered(state->q, energy(deceleration, state->at, end));
        state->at = end;
        stop.step = end_step;
        y = (struct rkm04_fixed){0};
    }
}

/* How the stop of a motion begins at `tick`. *y: where it is behind the last whole step. */
static struct stop stop_at(const struct rkm04_motion *motion, uint64_t tick, struct rkm04_fixed *y)
{
    const uint64_t w_end = (uint64_t)ramp_speed_unit(&motion->ramp) * motion->start_speed;
    struct stop stop = {.step = motion->done};
    struct rkm04_fixed w;
    state_since_step(motion, tick, y, &w);
    struct wide square = square_of(w), square_end = wide_product(w_end, w_end);
    if (wide_less(square_end, square))
        stop.energy = wide_difference(square, square_end);
    return stop;
}

/* Stop from `state`, the present one. Returns false if no further step is to be done. */
static bool stop_from(struct rkm04_motion *motion, uint64_t tick, struct state state)
{
    struct rkm04_profile *profile = &motion->profile;
    struct rkm04_fixed y;
    struct stop stop = stop_at(motion, tick, &y);
    uint64_t q_end = lower(state.q, q_of(motion->start_speed));
    uint32_t last = plan_stop(motion, &state, stop, y);
    uint16_t deceleration = motion->segment[state.segment].deceleration;
    struct rkm04_place slow = ahead(state.at, lowered(state.q, q_end), deceleration);
    if (has_length(deceleration, slow, place_at(last)))
        add_break(profile, slow, q_end, 0);
    profile->endless = false;
    add_end(profile, place_at(last), q_end);
    if (last == motion->done)
        return false;
    ramp_continue(&motion->ramp, profile, tick);
    return true;
}

bool profile_stop(struct rkm04_motion *motion, uint64_t tick)
{
    if (on_final_ramp(motion))
        return true;
    struct state state = present_state(motion, tick);
    mark_present_place(&motion->profile);
    return stop_from(motion, tick, state);
}

/* ---- Any goal from any state ------------------------------------------------------------------------------------------ */

/* The way ends `early` steps before the place, and a second segment at the start speed leads there; or it ends after the
 * place. */
static void set_early(struct rkm04_motion *motion, int8_t early)
{
    struct rkm04_segment *segment = motion->segment;
    if (early < 0) {
        motion->total += (uint32_t)-early;
        segment[0].steps = motion->total;
        return;
    }
    segment[1] = segment[0];
    segment[1].speed = slower(segment[0].speed, motion->start_speed);
    segment[1].steps = (uint32_t)lower(size_of(early), motion->total);
    segment[0].steps = motion->total - segment[1].steps;
    motion->segments = 2;
}

/* One segment without places yet, of the goal's speeds. */
static void set_goal(struct rkm04_motion *motion, const struct profile_goal *goal)
{
    motion->kind = goal->kind == PROFILE_TO_PLACE ? RKM04_MOTION_STEPS : RKM04_MOTION_ENDLESS;
    motion->start_speed = goal->start_speed;
    motion->segments = 1;
    motion->segment[0] = (struct rkm04_segment){.speed = (uint16_t)size_of(goal->speed),
                                                .acceleration = goal->acceleration,
                                                .deceleration = goal->deceleration};
    motion->total = (uint32_t)size_of(goal->way); /* counts in a motion of steps only */
    motion->segment[0].steps = motion->total;
    motion->profile.count = motion->profile.leg = 0;
    if (goal->kind == PROFILE_TO_PLACE && goal->early != 0)
        set_early(motion, goal->early);
}

static enum profile_answer start_from_rest(struct rkm04_motion *motion, uint64_t tick, uint32_t rate,
                                           const struct profile_goal *goal)
{
    motion->moving = false;
    if (goal->kind == PROFILE_TO_STOP || (goal->kind == PROFILE_TO_PLACE && goal->way == 0))
        return PROFILE_STANDS;
    set_goal(motion, goal);
    motion->forward = (goal->kind == PROFILE_TO_PLACE ? goal->way : goal->speed) > 0;
    motion->done = 0;
    motion->moving = true;
    profile_plan(motion);
    ramp_begin(&motion->ramp, &motion->profile, tick, rate);
    return PROFILE_MOVES;
}

enum profile_answer profile_go(struct rkm04_motion *motion, uint64_t tick, uint32_t rate, const struct profile_goal *goal)
{
    if (!motion->moving)
        return start_from_rest(motion, tick, rate, goal);
    struct state state = present_state(motion, tick);
    struct rkm04_fixed y;
    state.at.high -= (uint64_t)motion->done << 32; /* again from the pulse sent last: no motion runs out of places */
    state.segment = 0;
    motion->done = 0;
    motion->changed = true;
    set_goal(motion, goal);
    const struct stop stop = stop_at(motion, tick, &y);
    const bool forward = motion->forward;
    int64_t way = forward ? goal->way : -goal->way, speed = forward ? goal->speed : -goal->speed;
    if (goal->kind == PROFILE_TO_PLACE && way >= first_stop(motion, stop, y)) {
        motion->moving = way > 0;
        if (way == 0)
            return PROFILE_STANDS;
    } else if (goal->kind != PROFILE_FOR_EVER || speed < 0) {
        motion->kind = RKM04_MOTION_ENDLESS; /* a stop that no planned end cuts short */
        motion->moving = stop_from(motion, tick, state);
        if (motion->moving)
            return goal->kind == PROFILE_TO_STOP ? PROFILE_MOVES : PROFILE_TURNS;
        return start_from_rest(motion, tick, rate, goal);
    }
    state.segment = segment_at(motion, state.at);
    plan_from(motion, state);
    ramp_continue(&motion->ramp, &motion->profile, tick);
    return PROFILE_MOVES;
}

/* ---- What the host sees --------------------------------------------------------------------------------------------- */

bool profile_point(const struct rkm04_motion *motion, unsigned i, struct profile_point *point)
{
    const struct rkm04_profile *profile = &motion->profile;
    if (i >= profile->count)
        return false;
    /* A place planned on the way has lost up to 2^-35 of a step by rounding, a speed up to ROUNDING. */
    const struct wide lost = {0, UINT64_C(1) << 61};
    const struct rkm04_break *at = &profile->point[i];
    bool last = !profile->endless && i + 1u == profile->count;
    uint32_t end = ramp_step_of(profile->point[profile->count - 1].at);
    point->step = ramp_step_of(place_of(wide_sum(wide_of(at->at), lost))) + !last;
    if (!profile->endless)
        point->step = (uint32_t)lower(point->step, end);
    point->speed = last ? 0 : wide_root_of((uint32_t)((at->speed2 + ROUNDING) >> (RAMP_SPEED2_BITS + 1)));
    return true;
}
