/* SPDX-License-Identifier: MIT */
#include "ramp_pulses.h"

#include "fixed.h"
#include "ramp.h"

/* ---- One pulse ---------------------------------------------------------------------------------------------------- */

/* Ticks from which Newton's rule comes down to the root on a rising leg: y / w at most, and not so many that slope * d * d
 * passes 64 bits. */
static int64_t start_of_guess(int64_t y, int64_t w, int64_t slope)
{
    int64_t d = -y / w, most = 1;
    while (most < d && slope * most < -y / most)
        most *= 2;
    return most < d ? most : d;
}

/* Roughly how many ticks until y >= 0, by Newton's rule on whole numbers: from above on a rising leg, from below on a
 * falling one. It goes one way only and so comes to an end, without passing the vertex. */
static int64_t guess_ticks(int64_t y, int64_t w, int64_t slope)
{
    int64_t d = slope > 0 ? start_of_guess(y, w, slope) : -y / w, change = 1;
    for (int64_t speed; change != 0 && (speed = w + 2 * slope * d) > 0; d -= change)
        change = (y + d * (w + slope * d)) / speed;
    return d;
}

/* Settle on the first tick with y >= 0. Returns how many ticks on. */
static int64_t advance_to_pulse(struct motion_state *state, int64_t slope)
{
    int64_t d = 0;
    while (state->y.whole < 0 && state->w.whole + slope > 0) {
        state->y = fixed_sum(state->y, (struct rkm04_fixed){state->w.whole + slope, state->w.part});
        state->w.whole += 2 * slope;
        d++;
    }
    for (;;) {
        struct rkm04_fixed way = {state->w.whole - slope, state->w.part};
        if (fixed_less(state->y, way))
            return d;
        state->y = fixed_difference(state->y, way);
        state->w.whole -= 2 * slope;
        d--;
    }
}

static int32_t interval_at(const struct rkm04_ramp *ramp)
{
    const int64_t least = 2 * (int64_t)ramp->rate; /* w of 1 step/s */
    return (int32_t)(ramp->step / (ramp->w.whole > least ? ramp->w.whole : least));
}

void ramp_find_first(struct rkm04_ramp *ramp)
{
    if (ramp->y.whole < 0) {
        int64_t d = guess_ticks(ramp->y.whole, ramp->w.whole, ramp->slope);
        struct motion_state first = ramp_moved(ramp, d);
        d += advance_to_pulse(&first, ramp->slope);
        ramp->y = first.y;
        ramp->w = first.w;
        ramp->at += (uint64_t)d;
    }
    ramp->next = ramp->at;
    ramp->change = 0;
    ramp->interval = interval_at(ramp);
    ramp->phase = (uint32_t)((uint64_t)ramp->y.whole / (2 * (uint64_t)ramp->rate));
}

/* ---- Constant speed ----------------------------------------------------------------------------------------------- */

#define BLOCK 64u

/* The first 32 binary places of rest / v, and 2^-32 more at the most; rest < v. */
static uint32_t places_of(uint32_t rest, uint32_t v)
{
    if (v >> 16)
        return (uint32_t)(((uint64_t)rest << 32) / v) + 1;
    uint32_t high = (rest << 16) / v; /* two digits of 16 bits */
    return (high << 16) + (((rest << 16) - high * v) << 16) / v + 1;
}

/* Speed v in whole steps/s. With y = 2 * rate * phase, and a rest that stays, pulse i of a block is due
 * ceil((rate * i - phase) / v) ticks on. That is a multiple of 1/v: 32 binary places, less than 1/v too much in all, give it
 * exactly. All divisions are of 32 bits below 2^16 steps/s. */
static size_t level_block(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    const uint32_t v = ramp->level, rate = ramp->rate, period = rate / v, reach = BLOCK * (period + 1);
    const uint64_t at = ramp->at, pace = ((uint64_t)period << 32) + places_of(rate - period * v, v);
    uint64_t due = places_of(v - 1 - ramp->phase, v);
    uint32_t n = ((limit - at < reach ? (uint32_t)(limit - at) : reach) * v + ramp->phase) / rate + 1;
    n = n < room ? n : (uint32_t)room;
    n = n < BLOCK ? n : BLOCK;
    n = n < ramp->left ? n : ramp->left;
    for (size_t i = 0; i < n; i++, due += pace)
        tick[i] = at + (due >> 32);
    ramp->left -= n;
    const uint32_t on = (uint32_t)(due >> 32), change = on * v - n * rate;
    ramp->at = at + on;
    ramp->phase += change;
    ramp->y.whole += (int64_t)(int32_t)change * 2 * rate;
    ramp->next = ramp->at;
    return n;
}

/* ---- Slopes, pulse by pulse --------------------------------------------------------------------------------------- */

/* `next`, *d ticks after `now`, is not where the next pulse is due: find it. */
static struct motion_state find_pulse_near(struct motion_state now, struct motion_state next, int64_t slope, int64_t *d)
{
    if (next.y.whole > 8 * next.w.whole || next.y.whole < -8 * next.w.whole) {
        *d = guess_ticks(now.y.whole, now.w.whole, slope);
        next = motion_moved(now.y, now.w, slope, *d);
    }
    *d += advance_to_pulse(&next, slope);
    return next;
}

/* The interval before and the change it had are a guess, which is corrected to the tick. */
static size_t single_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    const int64_t slope = ramp->slope;
    struct motion_state now = {ramp->y, ramp->w};
    int64_t interval = ramp->interval, change = ramp->change;
    uint64_t at = ramp->at;
    size_t n = 0;
    do {
        tick[n++] = at;
        now.y.whole -= ramp->step;
        if (n == ramp->left)
            break;
        int64_t ticks = interval + change;
        struct motion_state next = motion_moved(now.y, now.w, slope, ticks);
        if (next.y.whole < 0 && next.y.whole + next.w.whole + slope >= 0) { /* most often due at the next tick */
            next.y = fixed_sum(next.y, (struct rkm04_fixed){next.w.whole + slope, next.w.part});
            next.w.whole += 2 * slope;
            ticks++;
        } else if (next.y.whole < 0 || next.y.whole >= next.w.whole - slope) {
            next = find_pulse_near(now, next, slope, &ticks);
        }
        change = ticks - interval;
        interval = ticks;
        now = next;
        at += (uint64_t)ticks;
    } while (at <= limit && n < room);
    ramp->y = now.y;
    ramp->w = now.w;
    ramp->at = at;
    ramp->next = at;
    ramp->interval = (int32_t)interval;
    ramp->change = (int32_t)change;
    ramp->left -= (uint32_t)n;
    return n;
}

/* ---- Slopes in blocks ---------------------------------------------------------------------------------------------
 *
 * With z = (2 * rate^2 * j - y) / w and x = slope * z / w, pulse j is due z * (1 - x + 2x^2 - 5x^3 + ...) ticks on. Reckoned from
 * the middle of a block, the fourth term is below 2^-8 of a tick where the speed is high enough; the first three are a cubic in
 * j, which three additions a pulse follow. What comes to lie within RAMP_NEAR of a whole tick is asked of y itself
 * (docs/DESIGN.md). */

uint64_t ramp_fast_from(uint32_t slope, uint32_t rate)
{
    uint64_t w = 98000000;
    uint32_t top = 1, megahertz = 1000000;
    if (slope == 0) /* a speed that is no whole number: the places of w after the point must not matter */
        slope = 1;
    for (; megahertz < rate; megahertz *= 2)
        w = w * 9 / 4; /* 2^(8/7) = 2.208, and a little for the places of 1 / w */
    for (; slope >> 1 >= top; top <<= 1)
        w = w * 345 / 256; /* 2^(3/7) */
    return w + w * 3 / 7 * (slope - top) / top;
}

/* How many pulses make a block, and from which w on, in sixteenths of ramp->fast: the error grows with pulses^4 / w^7, and the
 * largest blocks leave room for what 1 / w lacks. Fewer than are left in the leg, so that the next pulse after a block always is
 * of the same leg. */
static uint8_t block_of(const struct rkm04_ramp *ramp)
{
    static const struct {
        uint8_t pulses, fast;
    } sizes[] = {{128, 56}, {96, 47}, {64, 35}, {48, 30}, {32, 24}, {24, 20}, {16, 16}, {12, 13}, {8, 11}};
    const uint32_t w = (uint32_t)((uint64_t)ramp->w.whole >> 14), fast = (uint32_t)(ramp->fast >> 18) + 1; /* 32 bits do */
    for (unsigned i = 0; i < sizeof sizes / sizeof *sizes; i++)
        if (w > fast * sizes[i].fast && ramp->left > sizes[i].pulses)
            return sizes[i].pulses;
    return 0;
}

/* a / 2^places for a signed number, rounded down. */
static inline int64_t scaled_down(int64_t a, unsigned places)
{
    return a >> places; /* arithmetic on every compiler that the core is built with */
}

/* a * b / 2^40, b signed. */
static inline int64_t scaled_product(uint64_t a, int64_t b)
{
    const int64_t size = (int64_t)wide_scaled(a, size_of(b));
    return b < 0 ? -size : size;
}

/* a / w with 32 places; inverse = 2^63 / w. */
static inline uint64_t quotient(uint64_t a, uint64_t inverse)
{
    struct wide product = wide_product(a, inverse);
    return product.high << 33 | product.low >> 31;
}

/* The pulses after the present one, which y and w are of, computed from `middle` ticks on: the cubic's value at the first,
 * RAMP_NEAR too late, and its differences. */
static void set_cubic(struct rkm04_ramp *ramp, int64_t middle)
{
    const bool down = ramp->slope < 0;
    const uint32_t steep = down ? 0 - (uint32_t)ramp->slope : (uint32_t)ramp->slope;
    const struct motion_state there = ramp_moved(ramp, middle);
    const uint64_t speed = (uint64_t)there.w.whole, inverse = ((UINT64_C(1) << 63) + speed / 2) / speed;
    const uint64_t c = quotient((uint64_t)ramp->step, inverse); /* ticks from pulse to pulse there */
    const uint64_t back = quotient((uint64_t)there.y.whole, inverse) - c; /* -z of the first: some intervals before the middle */
    const uint64_t curve = steep * inverse << 9; /* slope / w with 72 places: below 2^-8 at the speeds of blocks */
    const int64_t bend_z = (int64_t)wide_high(back, curve), bend_c = (int64_t)wide_high(c, curve); /* 40 places */
    const int64_t x = down ? bend_z : -bend_z, u = down ? -bend_c : bend_c;
    /* |x| < 2^-4 where blocks are right, and |u| is less: the squares have 68 places */
    const int64_t x34 = scaled_down(x, 6), u34 = scaled_down(u, 6), x2 = x34 * x34, xu = x34 * u34, u2 = u34 * u34;
    const int64_t bent = scaled_product(back, scaled_down(x2, 27) - x);
    ramp->due = ((uint64_t)middle << 32) - back - (uint64_t)bent + RAMP_NEAR;
    ramp->due1 = c + (uint64_t)scaled_product(c, scaled_down(3 * (x2 + xu) + u2, 27) - 2 * x - u);
    ramp->due2 = (uint64_t)scaled_product(c, scaled_down(12 * (xu + u2), 28) - 2 * u);
    ramp->due3 = wide_scaled(c, (uint64_t)(12 * u2) >> 18) >> 10; /* adds up to pulses^3 / 6: ten places more */
}

bool ramp_begin_block(struct rkm04_ramp *ramp)
{
    ramp->block = block_of(ramp);
    if (ramp->block == 0)
        return false;
    set_cubic(ramp, ramp->block / 2 * (int64_t)ramp->interval);
    return true;
}

void ramp_leave_block(struct rkm04_ramp *ramp)
{
    struct motion_state then = ramp_moved(ramp, (int64_t)(ramp->next - ramp->at));
    ramp->y = then.y;
    ramp->y.whole -= ramp->step * ramp->sent;
    ramp->w = then.w;
    ramp->at = ramp->next;
    ramp->sent = ramp->block = 0;
}

/* The next pulses of the block under way. */
static size_t block_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    const uint64_t from = ramp->at + 1, span = limit - ramp->next, due3 = ramp->due3;
    uint64_t due = ramp->due, due1 = ramp->due1, due2 = ramp->due2, next = ramp->next;
    size_t n = ramp->block - ramp->sent, fit = (span < UINT32_MAX ? (uint32_t)span : UINT32_MAX) / (uint32_t)ramp->interval + 1;
    n = n < room ? n : room;
    n = n < fit ? n : fit;
    size_t i = 0;
    do {
        tick[i++] = next;
        next = from + (due >> 32);
        if ((uint32_t)due < 2 * RAMP_NEAR)
            next = ramp_exact_tick(ramp, next, ramp->sent + i);
        due += due1;
        due1 += due2;
        due2 += due3;
    } while (i < n);
    for (; tick[n - 1] > limit; n--) { /* the first one is due */
        next = tick[n - 1];
        due2 -= due3;
        due1 -= due2;
        due -= due1;
    }
    ramp->due = due;
    ramp->due1 = due1;
    ramp->due2 = due2;
    ramp->interval = (int32_t)(next - tick[n - 1]);
    ramp->next = next;
    ramp->left -= (uint32_t)n;
    ramp->sent = (uint8_t)(ramp->sent + n);
    if (ramp->sent == ramp->block)
        ramp_leave_block(ramp);
    return n;
}

size_t ramp_leg_pulses(struct rkm04_ramp *ramp, uint64_t limit, uint64_t *tick, size_t room)
{
    if (ramp->level > 0)
        return level_block(ramp, limit, tick, room);
    if (ramp->block == 0 && !ramp_begin_block(ramp))
        return single_pulses(ramp, limit, tick, room);
    return block_pulses(ramp, limit, tick, room);
}
