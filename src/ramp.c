/* SPDX-License-Identifier: MIT */
#include "ramp.h"

#include "fixed.h"
#include "ramp_pulses.h"

/* ---- 64.64 numbers ------------------------------------------------------------------------------------------------ */

/* factor * places / 2^128 for a whole factor, cut off after 64 places. */
static struct rkm04_fixed scaled(uint64_t factor, struct wide places)
{
    struct wide product = wide_sum(wide_product(factor, places.high), (struct wide){0, wide_high(factor, places.low)});
    return (struct rkm04_fixed){(int64_t)product.high, product.low};
}

/* a * places / 2^128 for a >= 0, cut off; at most 3 units of the last place too small. */
static struct rkm04_fixed times(struct rkm04_fixed a, struct wide places)
{
    return fixed_sum(scaled((uint64_t)a.whole, places), (struct rkm04_fixed){0, wide_high(a.part, places.high)});
}

/* What cutting off may have lost: always added, so that a pulse due exactly at a tick is never a tick late. */
static const struct rkm04_fixed ROUND_UP = {0, 4}, LAST_PLACE = {0, 1};

/* What LAST_PLACE in w would add to y in 2^40 ticks: a level leg gets it at once, so that its speed stays a whole number. */
static const struct rkm04_fixed LEVEL_ROUND_UP = {0, UINT64_C(1) << 40};

/* ---- Instants ----------------------------------------------------------------------------------------------------- */

static struct rkm04_instant later(struct rkm04_instant a, uint64_t ticks, struct wide places)
{
    struct wide part = wide_sum((struct wide){a.high, a.low}, places);
    bool carry = wide_less(part, places);
    return (struct rkm04_instant){a.tick + ticks + carry, part.high, part.low};
}

static uint64_t tick_from(struct rkm04_instant a)
{
    return a.tick + ((a.high | a.low) != 0);
}

/* Ticks that a change of w by `change` takes at `slope` > 0. */
static struct rkm04_instant after_slope(struct rkm04_instant start, struct rkm04_fixed change, uint32_t slope)
{
    uint64_t divisor = 2 * (uint64_t)slope, rest = (uint64_t)change.whole % divisor;
    struct wide places;
    places.high = wide_divide((struct wide){rest, change.part}, divisor, &rest);
    places.low = wide_divide((struct wide){rest, 0}, divisor, &rest);
    return later(start, (uint64_t)change.whole / divisor, places);
}

/* Ticks that the way from `from` to `to` takes at a constant speed in steps/s, up to 2^-76 of a tick less: whatever begins
 * there must not come late. */
static struct rkm04_instant after_way(struct rkm04_instant start, struct rkm04_place from, struct rkm04_place to, uint32_t speed,
                                      uint32_t rate)
{
    struct wide way = wide_difference((struct wide){to.high, to.low}, (struct wide){from.high, from.low});
    uint64_t rest = way.high % speed;
    struct wide share = {way.high / speed, wide_divide((struct wide){rest, way.low}, speed, &rest)};
    /* share * rate has 96 places and up to 152 bits: take it apart at bit 96 of 192. */
    struct wide low = wide_product(share.low, rate);
    struct wide high = wide_sum(wide_product(share.high, rate), (struct wide){0, low.high});
    uint64_t ticks = high.high << 32 | high.low >> 32;
    return later(start, ticks, (struct wide){high.low << 32 | low.low >> 32, low.low << 32});
}

/* ---- Legs --------------------------------------------------------------------------------------------------------- */

/* y of the part of a step in a place. */
static struct rkm04_fixed y_of_part(const struct rkm04_ramp *ramp, struct rkm04_place place)
{
    struct wide places = {place.high << 32 | place.low >> 32, place.low << 32};
    return fixed_sum(scaled((uint64_t)ramp->step, places), ROUND_UP);
}

/* y and w at ramp->at for a leg that began at `start` at `place` with speed w. */
static void compute_from_start(struct rkm04_ramp *ramp, struct rkm04_instant start, struct rkm04_place place,
                               struct rkm04_fixed w)
{
    struct rkm04_fixed y = y_of_part(ramp, place);
    y.whole -= ramp->step;
    if (start.high | start.low) {
        struct wide gone = wide_difference((struct wide){0, 0}, (struct wide){start.high, start.low});
        uint64_t rise = (uint32_t)ramp->slope;
        y = fixed_sum(fixed_sum(y, times(fixed_sum(w, scaled(rise, gone)), gone)), ROUND_UP);
        if (rise > 0)
            w = fixed_sum(fixed_sum(w, scaled(2 * rise, gone)), LAST_PLACE);
        else
            y = fixed_sum(y, LEVEL_ROUND_UP);
    }
    ramp->y = y;
    ramp->w = w;
}

/* The same for a falling leg that ends at ramp->end at `place` with speed w. The products may pass 2^64; their difference
 * does not. */
static void compute_from_end(struct rkm04_ramp *ramp, struct rkm04_place place, struct rkm04_fixed w)
{
    if (ramp->end.tick < ramp->at) /* shorter than a tick: as if it had begun before */
        ramp->at = ramp->end.tick;
    const uint64_t fall = (uint32_t)-ramp->slope, ticks = ramp->end.tick - ramp->at;
    const struct wide places = {ramp->end.high, ramp->end.low}, part = wide_product(w.part, ticks);
    const struct rkm04_fixed w_whole = {(int64_t)((uint64_t)w.whole + 2 * fall * ticks), w.part};
    struct rkm04_fixed way = {(int64_t)((uint64_t)w.whole * ticks + fall * ticks * ticks + part.high), part.low};
    way = fixed_sum(way, times(fixed_sum(w_whole, scaled(fall, places)), places));
    struct rkm04_fixed y = y_of_part(ramp, place);
    y.whole = (int64_t)((uint64_t)y.whole + (uint64_t)ramp->step * (ramp->left - UINT64_C(1)));
    ramp->y = fixed_difference(y, way);
    ramp->w = fixed_sum(fixed_sum(w_whole, scaled(2 * fall, places)), LAST_PLACE);
}

static void begin_pulses(struct rkm04_ramp *ramp)
{
    ramp->block = ramp->sent = 0;
    if (ramp->left > 0)
        ramp_find_first(ramp);
    else
        ramp->next = ramp->last ? RKM04_NEVER : tick_from(ramp->end);
}

/* How the leg's pulses are worked out. */
static void set_slope(struct rkm04_ramp *ramp, int32_t slope, struct rkm04_fixed w)
{
    const int64_t unit = ramp_speed_unit(ramp);
    ramp->slope = slope;
    ramp->level = slope == 0 && w.part == 0 && w.whole % unit == 0 ? (uint32_t)(w.whole / unit) : 0;
    ramp->fast = ramp_fast_from((uint32_t)size_of(slope), ramp->rate);
}

/* How long the leg takes from `start`, and how many pulses it has. */
static void set_end(struct rkm04_ramp *ramp, const struct ramp_leg *leg, struct rkm04_instant start)
{
    ramp->last = leg->last;
    if (leg->open) {
        ramp->end.tick = RKM04_NEVER;
        ramp->left = UINT32_MAX;
        return;
    }
    ramp->left = ramp_step_of(leg->to) - ramp_step_of(leg->from);
    if (leg->slope > 0)
        ramp->end = after_slope(start, fixed_difference(leg->w_end, leg->w), (uint32_t)leg->slope);
    else if (leg->slope < 0)
        ramp->end = after_slope(start, fixed_difference(leg->w, leg->w_end), (uint32_t)-leg->slope);
    else /* a speed that is no whole number is taken as higher: the end must not come before ramp->end */
        ramp->end = after_way(start, leg->from, leg->to, (uint32_t)((leg->w.whole - 1) / ramp_speed_unit(ramp)) + 1, ramp->rate);
}

void ramp_begin_leg(struct rkm04_ramp *ramp, const struct ramp_leg *leg, struct rkm04_instant start)
{
    set_slope(ramp, leg->slope, leg->w);
    ramp->at = tick_from(start);
    set_end(ramp, leg, start);
    if (leg->slope < 0)
        compute_from_end(ramp, leg->to, leg->w_end);
    else
        compute_from_start(ramp, start, leg->from, leg->w);
    begin_pulses(ramp);
}

void ramp_set_rate(struct rkm04_ramp *ramp, uint32_t rate)
{
    ramp->rate = rate;
    ramp->step = 2 * (int64_t)rate * rate;
    ramp->exact = true;
}

struct motion_state ramp_moved(const struct rkm04_ramp *ramp, int64_t d)
{
    return motion_moved(ramp->y, ramp->w, ramp->slope, d);
}

void ramp_state_at(const struct rkm04_ramp *ramp, uint64_t tick, struct rkm04_fixed *y, struct rkm04_fixed *w)
{
    struct motion_state then = ramp_moved(ramp, (int64_t)(tick - ramp->at));
    *y = then.y;
    y->whole -= ramp->step * ramp->sent;
    *w = then.w;
}

uint64_t ramp_quiet_until(const struct rkm04_ramp *ramp)
{
    const uint64_t margin = 4; /* more than any rounding of a leg's end */
    return ramp->end.tick - margin;
}

uint64_t ramp_quiet_pulses(const struct rkm04_ramp *ramp, uint32_t most)
{
    int64_t w = ramp->w.whole + 1;
    if (ramp->slope > 0) /* the mean speed of the leg, which its first pulses do not reach */
        w += ramp->slope * (int64_t)(ramp->end.tick - ramp->at);
    uint64_t quiet = ramp_quiet_until(ramp), fastest = ramp->next + (uint64_t)(ramp->step / w) * most;
    if (most != UINT32_MAX && fastest < quiet) /* an endless motion is quiet without end */
        quiet = fastest;
    return quiet > ramp->next ? quiet : ramp->next; /* as soon as no pulse is left in the leg, or in the motion */
}

/* ---- Pulses ------------------------------------------------------------------------------------------------------- */

/* Here, not in the loop of ramp_pulses.c that asks it: there it would take the registers. */
uint64_t ramp_exact_tick(const struct rkm04_ramp *ramp, uint64_t tick, size_t j)
{
    struct motion_state before = ramp_moved(ramp, (int64_t)(tick - 1 - ramp->at));
    return tick - (before.y.whole >= ramp->step * (int64_t)j);
}

size_t ramp_leg_ticks(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    if (ramp->next > limit)
        return 0;
    size_t n = ramp_leg_pulses(ramp, limit, tick, room);
    if (ramp->left == 0) {
        if (ramp->end.tick == RKM04_NEVER)
            ramp->left = UINT32_MAX;
        begin_pulses(ramp);
    }
    return n;
}

/* As motion_moved(), for a way of any length. */
struct leap {
    uint64_t ticks, steps; /* passed, the next one included */
    struct rkm04_fixed y;  /* after them */
    int64_t w;
};

static struct leap leap_of(const struct rkm04_ramp *ramp, uint64_t ticks)
{
    int64_t half = ramp->slope * (int64_t)ticks;
    struct wide part = wide_product(ramp->w.part, ticks);
    struct rkm04_fixed rest = fixed_sum(ramp->y, (struct rkm04_fixed){(int64_t)part.high, part.low});
    struct wide way = wide_sum(wide_product((uint64_t)(ramp->w.whole + half), ticks), (struct wide){0, (uint64_t)rest.whole});
    uint64_t y, steps = wide_divide(way, (uint64_t)ramp->step, &y);
    return (struct leap){ticks, steps + 1, {(int64_t)y - ramp->step, rest.part}, ramp->w.whole + 2 * half};
}

uint32_t ramp_skip(struct rkm04_ramp *ramp, uint64_t limit, uint32_t most)
{
    const uint64_t worth = 64, interval = (uint64_t)ramp->interval;
    if (ramp->block > 0) /* otherwise it changes nothing, and costs as much as a pulse */
        ramp_leave_block(ramp);
    uint64_t ticks = (ramp->end.tick < limit ? ramp->end.tick : limit) - ramp->at;
    if (ramp->left < worth || most < worth || ticks < worth * interval)
        return 0;
    struct leap leap = leap_of(ramp, ticks);
    const uint64_t due = leap.steps;
    for (ticks -= 4 * interval; leap.steps == due || leap.steps >= ramp->left || leap.steps > most; ticks /= 2)
        leap = leap_of(ramp, ticks);
    ramp->y = leap.y;
    ramp->w.whole = leap.w;
    ramp->at += leap.ticks;
    ramp->left -= (uint32_t)leap.steps;
    ramp_find_first(ramp);
    return (uint32_t)leap.steps;
}

/* ---- Along a profile ------------------------------------------------------------------------------------------------ */

/* w of a speed given as 2 * speed^2 * 2^34. ramp->exact becomes false if it is irrational. */
static struct rkm04_fixed w_of(struct rkm04_ramp *ramp, uint64_t speed2)
{
    uint64_t square = speed2 >> (RAMP_SPEED2_BITS + 1);
    uint32_t speed = wide_root_of((uint32_t)square);
    if (square << (RAMP_SPEED2_BITS + 1) == speed2 && (uint64_t)speed * speed == square)
        return (struct rkm04_fixed){ramp_speed_unit(ramp) * (int64_t)speed, 0};
    /* w = sqrt(step * speed2 / 2^34), with 64 places: sqrt(step * speed2 * 4^47). */
    bool inexact;
    struct wide root = wide_root(wide_product((uint64_t)ramp->step, speed2), 47, &inexact);
    ramp->exact = ramp->exact && !inexact;
    return (struct rkm04_fixed){(int64_t)root.high, root.low};
}

static bool is_leg_open(const struct rkm04_profile *profile)
{
    return profile->endless && profile->leg + 1 == profile->count;
}

/* No pulse is left after the present leg. */
static bool is_last_leg(const struct rkm04_profile *profile)
{
    return !profile->endless &&
           ramp_step_of(profile->point[profile->leg + 1].at) == ramp_step_of(profile->point[profile->count - 1].at);
}

/* The present leg of a profile. Its w_end is worked out where it has one. */
static struct ramp_leg leg_of(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, struct rkm04_fixed w)
{
    const struct rkm04_break *from = &profile->point[profile->leg];
    struct ramp_leg leg = {.from = from->at, .w = w, .w_end = w, .slope = from->slope, .open = is_leg_open(profile)};
    if (!leg.open) {
        leg.to = from[1].at;
        leg.w_end = w_of(ramp, from[1].speed2);
        leg.last = is_last_leg(profile);
    }
    return leg;
}

static void begin_leg(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, struct rkm04_instant start)
{
    const struct ramp_leg leg = leg_of(ramp, profile, w_of(ramp, profile->point[profile->leg].speed2));
    ramp_begin_leg(ramp, &leg, start);
}

static void next_leg(struct rkm04_ramp *ramp, struct rkm04_profile *profile)
{
    const struct rkm04_instant end = ramp->end;
    profile->leg++;
    begin_leg(ramp, profile, end);
}

void ramp_begin(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, uint64_t tick, uint32_t rate)
{
    ramp_set_rate(ramp, rate);
    begin_leg(ramp, profile, (struct rkm04_instant){tick, 0, 0});
}

void ramp_continue(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t tick)
{
    struct rkm04_fixed y, w;
    ramp_state_at(ramp, tick, &y, &w);
    ramp->y = y;
    ramp->w = w;
    ramp->at = tick;
    const struct ramp_leg leg = leg_of(ramp, profile, w);
    set_slope(ramp, leg.slope, w);
    set_end(ramp, &leg, (struct rkm04_instant){tick, 0, 0});
    begin_pulses(ramp);
    while (ramp_leg_is_over(ramp, tick)) /* a speed that changes at once counts in this slot already */
        next_leg(ramp, profile);
}

size_t ramp_pulses(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t limit, uint64_t *tick, size_t room)
{
    while (ramp->left == 0 && ramp->next <= limit)
        next_leg(ramp, profile);
    return ramp_leg_ticks(ramp, limit, tick, room);
}
