/* SPDX-License-Identifier: MIT */
#include "ramp.h"

/* ---- 64.64 numbers ------------------------------------------------------------------------------------------------ */

static inline struct rkm04_fixed sum(struct rkm04_fixed a, struct rkm04_fixed b)
{
    uint64_t part = a.part + b.part;
    return (struct rkm04_fixed){(int64_t)((uint64_t)a.whole + (uint64_t)b.whole + (part < a.part)), part};
}

static inline struct rkm04_fixed difference(struct rkm04_fixed a, struct rkm04_fixed b)
{
    return (struct rkm04_fixed){(int64_t)((uint64_t)a.whole - (uint64_t)b.whole - (a.part < b.part)), a.part - b.part};
}

/* factor * places / 2^128 for a whole factor, cut off behind 64 places. */
static struct rkm04_fixed scaled(uint64_t factor, struct wide places)
{
    struct wide product = wide_sum(wide_product(factor, places.high), (struct wide){0, wide_high(factor, places.low)});
    return (struct rkm04_fixed){(int64_t)product.high, product.low};
}

/* a * places / 2^128 for a >= 0, cut off; at most 3 units of the last place too small. */
static struct rkm04_fixed times(struct rkm04_fixed a, struct wide places)
{
    return sum(scaled((uint64_t)a.whole, places), (struct rkm04_fixed){0, wide_high(a.part, places.high)});
}

static inline bool below(struct rkm04_fixed a, struct rkm04_fixed b)
{
    return a.whole < b.whole || (a.whole == b.whole && a.part < b.part);
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
static struct rkm04_instant after_way(struct rkm04_instant start, struct rkm04_place from, struct rkm04_place to, uint32_t speed)
{
    struct wide way = wide_difference((struct wide){to.high, to.low}, (struct wide){from.high, from.low});
    uint64_t rest = way.high % speed;
    struct wide share = {way.high / speed, wide_divide((struct wide){rest, way.low}, speed, &rest)};
    /* share * 1e6 has 96 places and up to 148 bits: take it apart at bit 96 of 192. */
    struct wide low = wide_product(share.low, RKM04_TICKS_PER_SECOND);
    struct wide high = wide_sum(wide_product(share.high, RKM04_TICKS_PER_SECOND), (struct wide){0, low.high});
    uint64_t ticks = high.high << 32 | high.low >> 32;
    return later(start, ticks, (struct wide){high.low << 32 | low.low >> 32, low.low << 32});
}

/* ---- Legs --------------------------------------------------------------------------------------------------------- */

struct rkm04_fixed ramp_w(uint64_t speed2, bool *exact)
{
    uint64_t square = speed2 >> (RAMP_SPEED2_BITS + 1);
    uint32_t speed = wide_root_of((uint32_t)square);
    if (square << (RAMP_SPEED2_BITS + 1) == speed2 && (uint64_t)speed * speed == square)
        return (struct rkm04_fixed){RAMP_SPEED * (int64_t)speed, 0};
    /* w = sqrt(2e12 * speed2 / 2^34), with 64 places: sqrt(2e12 * speed2 * 4^47). */
    bool inexact;
    struct wide root = wide_root(wide_product((uint64_t)RAMP_STEP, speed2), 47, &inexact);
    *exact = *exact && !inexact;
    return (struct rkm04_fixed){(int64_t)root.high, root.low};
}

/* y of the part of a step in a place. */
static struct rkm04_fixed y_of_part(struct rkm04_place place)
{
    struct wide places = {place.high << 32 | place.low >> 32, place.low << 32};
    return sum(scaled((uint64_t)RAMP_STEP, places), ROUND_UP);
}

static bool leg_is_open(const struct rkm04_profile *profile)
{
    return profile->endless && profile->leg + 1 == profile->count;
}

/* No pulse is left behind the present leg. */
static bool nothing_behind(const struct rkm04_profile *profile)
{
    return !profile->endless &&
           ramp_step_of(profile->point[profile->leg + 1].at) == ramp_step_of(profile->point[profile->count - 1].at);
}

/* y and w at ramp->at for a leg that began at `start` at `place` with speed w. */
static void reckon_from_start(struct rkm04_ramp *ramp, struct rkm04_instant start, struct rkm04_place place, struct rkm04_fixed w)
{
    struct rkm04_fixed y = y_of_part(place);
    y.whole -= RAMP_STEP;
    if (start.high | start.low) {
        struct wide gone = wide_difference((struct wide){0, 0}, (struct wide){start.high, start.low});
        uint64_t rise = (uint32_t)ramp->slope;
        y = sum(sum(y, times(sum(w, scaled(rise, gone)), gone)), ROUND_UP);
        if (rise > 0)
            w = sum(sum(w, scaled(2 * rise, gone)), LAST_PLACE);
        else
            y = sum(y, LEVEL_ROUND_UP);
    }
    ramp->y = y;
    ramp->w = w;
}

/* The same for a falling leg that ends at ramp->end at `place` with speed w. The products may pass 2^64; their difference
 * does not. */
static void reckon_from_end(struct rkm04_ramp *ramp, struct rkm04_place place, struct rkm04_fixed w)
{
    uint64_t fall = (uint32_t)-ramp->slope;
    uint64_t ticks = ramp->end.tick - ramp->at;
    struct wide places = {ramp->end.high, ramp->end.low};
    if (ramp->end.tick < ramp->at) { /* shorter than a tick */
        ticks = 0;
        places = (struct wide){0, 0};
    }
    struct rkm04_fixed w_whole = {(int64_t)((uint64_t)w.whole + 2 * fall * ticks), w.part};
    struct wide part = wide_product(w.part, ticks);
    struct rkm04_fixed way = {(int64_t)((uint64_t)w.whole * ticks + fall * ticks * ticks + part.high), part.low};
    way = sum(way, times(sum(w_whole, scaled(fall, places)), places));
    struct rkm04_fixed y = y_of_part(place);
    y.whole = (int64_t)((uint64_t)y.whole + (uint64_t)RAMP_STEP * (ramp->left - UINT64_C(1)));
    ramp->y = difference(y, way);
    ramp->w = sum(sum(w_whole, scaled(2 * fall, places)), LAST_PLACE);
}

struct motion_state {
    struct rkm04_fixed y, w;
};

/* d ticks on along a slope, or back if d < 0. */
static inline struct motion_state moved(struct rkm04_fixed y, struct rkm04_fixed w, int64_t slope, int64_t d)
{
    int64_t half = slope * d;
    struct wide part = wide_product(w.part, (uint64_t)d);
    uint64_t whole = d < 0 ? part.high - w.part : part.high; /* (uint64_t)d is 2^64 more than d */
    struct rkm04_fixed way = {d * (w.whole + half) + (int64_t)whole, part.low};
    return (struct motion_state){sum(y, way), {w.whole + 2 * half, w.part}};
}

/* Roughly how many ticks until y >= 0, by Newton's rule on whole numbers: from above on a rising leg, from below on a
 * falling one. It goes one way only and so comes to an end, without passing the vertex. */
static int64_t guess_ticks(int64_t y, int64_t w, int64_t slope)
{
    int64_t d = -y / w, change = 1;
    for (int64_t speed; change != 0 && (speed = w + 2 * slope * d) > 0; d -= change)
        change = (y + d * (w + slope * d)) / speed;
    return d;
}

/* Settle on the first tick with y >= 0. Returns how many ticks on. */
static int64_t settle(struct motion_state *state, int64_t slope)
{
    int64_t d = 0;
    while (state->y.whole < 0 && state->w.whole + slope > 0) {
        state->y = sum(state->y, (struct rkm04_fixed){state->w.whole + slope, state->w.part});
        state->w.whole += 2 * slope;
        d++;
    }
    for (;;) {
        struct rkm04_fixed way = {state->w.whole - slope, state->w.part};
        if (below(state->y, way))
            return d;
        state->y = difference(state->y, way);
        state->w.whole -= 2 * slope;
        d--;
    }
}

/* `next`, *d ticks after the pulse at `now`, is not where the next one is due: find it. */
static struct motion_state settled(struct motion_state now, struct motion_state next, int64_t slope, int64_t *d)
{
    now.y.whole -= RAMP_STEP;
    if (next.y.whole > 8 * next.w.whole || next.y.whole < -8 * next.w.whole) {
        *d = guess_ticks(now.y.whole, now.w.whole, slope);
        next = moved(now.y, now.w, slope, *d);
    }
    *d += settle(&next, slope);
    return next;
}

/* The leg's first pulse: from ramp->at to the tick at which it is due, which may be ramp->at itself. */
static void find_first(struct rkm04_ramp *ramp)
{
    if (ramp->y.whole < 0) {
        int64_t d = guess_ticks(ramp->y.whole, ramp->w.whole, ramp->slope);
        struct motion_state first = moved(ramp->y, ramp->w, ramp->slope, d);
        d += settle(&first, ramp->slope);
        ramp->y = first.y;
        ramp->w = first.w;
        ramp->at += (uint64_t)d;
    }
    ramp->next = ramp->at;
    ramp->change = 0;
    ramp->interval = (int32_t)(RAMP_STEP / (ramp->w.whole > RAMP_SPEED ? ramp->w.whole : RAMP_SPEED));
}

static void begin_pulses(struct rkm04_ramp *ramp, const struct rkm04_profile *profile)
{
    if (ramp->left > 0)
        find_first(ramp);
    else
        ramp->next = nothing_behind(profile) ? RKM04_NEVER : tick_from(ramp->end);
}

/* How long the leg takes from `start`, where it has speed w. */
static void set_end(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, struct rkm04_instant start,
                    struct rkm04_fixed w)
{
    const struct rkm04_break *from = &profile->point[profile->leg], *to = from + 1;
    if (leg_is_open(profile)) {
        ramp->end.tick = RKM04_NEVER;
        ramp->left = UINT32_MAX;
        return;
    }
    ramp->left = ramp_step_of(to->at) - ramp_step_of(from->at);
    struct rkm04_fixed w_end = ramp_w(to->speed2, &ramp->exact);
    if (from->slope > 0)
        ramp->end = after_slope(start, difference(w_end, w), (uint32_t)from->slope);
    else if (from->slope < 0)
        ramp->end = after_slope(start, difference(w, w_end), (uint32_t)-from->slope);
    else /* a speed that is no whole number is taken as higher: the end must not come before ramp->end */
        ramp->end = after_way(start, from->at, to->at, (uint32_t)((w.whole - 1) / RAMP_SPEED) + 1);
}

static void begin_leg(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, struct rkm04_instant start)
{
    const struct rkm04_break *from = &profile->point[profile->leg];
    struct rkm04_fixed w = ramp_w(from->speed2, &ramp->exact);
    ramp->slope = from->slope;
    ramp->at = tick_from(start);
    set_end(ramp, profile, start, w);
    if (from->slope < 0)
        reckon_from_end(ramp, from[1].at, ramp_w(from[1].speed2, &ramp->exact));
    else
        reckon_from_start(ramp, start, from->at, w);
    begin_pulses(ramp, profile);
}

void ramp_begin(struct rkm04_ramp *ramp, const struct rkm04_profile *profile, uint64_t tick)
{
    ramp->exact = true;
    begin_leg(ramp, profile, (struct rkm04_instant){tick, 0, 0});
}

void ramp_look(const struct rkm04_ramp *ramp, uint64_t tick, struct rkm04_fixed *y, struct rkm04_fixed *w)
{
    struct motion_state then = moved(ramp->y, ramp->w, ramp->slope, (int64_t)(tick - ramp->at));
    *y = then.y;
    *w = then.w;
}

void ramp_go_on(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t tick)
{
    ramp_look(ramp, tick, &ramp->y, &ramp->w);
    ramp->at = tick;
    ramp->slope = profile->point[profile->leg].slope;
    set_end(ramp, profile, (struct rkm04_instant){tick, 0, 0}, ramp->w);
    begin_pulses(ramp, profile);
    while (ramp->left == 0 && ramp->next <= tick) { /* a speed that changes at once counts in this slot already */
        struct rkm04_instant end = ramp->end;
        profile->leg++;
        begin_leg(ramp, profile, end);
    }
}

uint64_t ramp_quiet_until(const struct rkm04_ramp *ramp)
{
    const uint64_t margin = 4; /* more than any rounding of a leg's end */
    return ramp->end.tick - margin;
}

/* ---- Pulses ------------------------------------------------------------------------------------------------------- */

/* Constant speed in whole steps/s: one addition a pulse. */
static size_t level_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    const int64_t w = ramp->w.whole, period = RAMP_STEP / w, shortfall = RAMP_STEP - period * w;
    uint64_t at = ramp->at;
    int64_t y = ramp->y.whole;
    uint32_t left = ramp->left;
    size_t n = 0;
    do {
        tick[n++] = at;
        if (--left == 0) {
            y -= RAMP_STEP;
            break;
        }
        y -= shortfall;
        at += (uint64_t)period;
        if (y < 0) {
            y += w;
            at++;
        }
    } while (at <= limit && n < room);
    ramp->y.whole = y;
    ramp->at = at;
    ramp->left = left;
    return n;
}

/* A guess of the next interval, with all that depends on it alone. */
struct stride {
    int64_t ticks, half; /* half: slope * ticks */
    struct rkm04_fixed part; /* what the places of w behind the point add to y, less the step done */
    bool changes;            /* from pulse to pulse */
};

static inline struct stride stride_of(const struct rkm04_ramp *ramp)
{
    struct stride stride = {.ticks = ramp->interval + ramp->change, .changes = ramp->change != 0};
    struct wide part = wide_product(ramp->w.part, (uint64_t)stride.ticks);
    stride.half = ramp->slope * stride.ticks;
    stride.part = (struct rkm04_fixed){(int64_t)part.high - RAMP_STEP, part.low};
    return stride;
}

/* The interval turned out to be `ticks`. At low speed, where it still changes much, the guess is what the last change leads
 * to. */
static void learn(struct rkm04_ramp *ramp, int64_t ticks)
{
    const int64_t noise = 2;
    int64_t change = ticks - ramp->interval;
    ramp->interval = (int32_t)ticks;
    ramp->change = change <= noise && change >= -noise ? 0 : (int32_t)change;
}

/* Rising or falling speed: a guess, corrected to the tick. */
static size_t sloped_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    struct motion_state now = {ramp->y, ramp->w};
    const int64_t slope = ramp->slope;
    struct stride stride = stride_of(ramp);
    const size_t left = ramp->left;
    uint64_t at = ramp->at;
    size_t n = 0;
    do {
        tick[n++] = at;
        if (n == left) {
            now.y.whole -= RAMP_STEP;
            break;
        }
        struct motion_state next = {sum(now.y, stride.part), {now.w.whole + 2 * stride.half, now.w.part}};
        next.y.whole += stride.ticks * (now.w.whole + stride.half);
        int64_t ticks = stride.ticks;
        if (next.y.whole < 0) { /* most often due at the next tick */
            next.y = sum(next.y, (struct rkm04_fixed){next.w.whole + slope, next.w.part});
            next.w.whole += 2 * slope;
            ticks++;
        }
        if ((uint64_t)next.y.whole >= (uint64_t)(next.w.whole - slope) || stride.changes) {
            next = settled(now, next, slope, &ticks);
            learn(ramp, ticks);
            stride = stride_of(ramp);
        }
        now = next;
        at += (uint64_t)ticks;
    } while (at <= limit && n < room);
    ramp->y = now.y;
    ramp->w = now.w;
    ramp->at = at;
    ramp->left -= (uint32_t)n;
    return n;
}

size_t ramp_pulses(struct rkm04_ramp *ramp, struct rkm04_profile *profile, uint64_t limit, uint64_t *tick, size_t room)
{
    size_t n = 0;
    while (n < room && ramp->next <= limit) {
        if (ramp->left == 0) {
            struct rkm04_instant end = ramp->end;
            profile->leg++;
            begin_leg(ramp, profile, end);
            continue;
        }
        if (ramp->slope == 0 && ramp->w.part == 0)
            n += level_pulses(ramp, limit, tick + n, room - n);
        else
            n += sloped_pulses(ramp, limit, tick + n, room - n);
        ramp->next = ramp->at;
        if (ramp->left == 0) {
            if (leg_is_open(profile))
                ramp->left = UINT32_MAX;
            begin_pulses(ramp, profile);
        }
    }
    return n;
}

/* As moved(), for a way of any length. */
struct leap {
    uint64_t ticks, steps; /* passed, the next one included */
    struct rkm04_fixed y;  /* behind them */
    int64_t w;
};

static struct leap leap_of(const struct rkm04_ramp *ramp, uint64_t ticks)
{
    int64_t half = ramp->slope * (int64_t)ticks;
    struct wide part = wide_product(ramp->w.part, ticks);
    struct rkm04_fixed rest = sum(ramp->y, (struct rkm04_fixed){(int64_t)part.high, part.low});
    struct wide way = wide_sum(wide_product((uint64_t)(ramp->w.whole + half), ticks), (struct wide){0, (uint64_t)rest.whole});
    uint64_t y, steps = wide_divide(way, RAMP_STEP, &y);
    return (struct leap){ticks, steps + 1, {(int64_t)y - RAMP_STEP, rest.part}, ramp->w.whole + 2 * half};
}

uint32_t ramp_skip(struct rkm04_ramp *ramp, uint64_t limit, uint32_t most)
{
    const uint64_t worth = 64, interval = (uint64_t)ramp->interval;
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
    find_first(ramp);
    return (uint32_t)leap.steps;
}
