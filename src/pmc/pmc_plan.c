/* SPDX-License-Identifier: MIT */
#include "pmc_plan.h"

#include "ramp.h"
#include "wide.h"

/* Speeds are whole numbers k of m / 8 pulses/s: one that is set is 8 of them, a slot on a slope changes it by a whole number, and
 * motions change in slots only. With Q = 16 000 * acceleration * deceleration a way at the acceleration from k0 to k1 is
 * m * deceleration * (k1^2 - k0^2) / Q pulses, one at the deceleration m * acceleration * (k1^2 - k0^2) / Q. So places are whole
 * numbers z of 1 / Q pulse, in motions planned again, too: the only place and the only speed that are none are those of the peak
 * between a rise and the final fall, where nothing is planned again. */
#define K_OF_SPEED 8u
#define W_OF_K 2000000u /* w of k is this * m * k */

struct plan {
    struct pmc_motion *motion;
    uint64_t m, acceleration, deceleration; /* as they are set */
    uint64_t q;       /* Q */
    uint64_t start;   /* k of the start speed */
    uint64_t k;       /* present speed */
    struct wide z;    /* present place */
};

static struct wide wide_of(uint64_t number)
{
    return (struct wide){0, number};
}

static struct plan plan_of(struct pmc_motion *motion, const struct pmc_parameters *parameters)
{
    struct plan plan = {.motion = motion,
                        .m = (uint64_t)parameters->value[PMC_MULTIPLIER],
                        .acceleration = (uint64_t)parameters->value[PMC_ACCELERATION],
                        .deceleration = (uint64_t)pmc_parameter(parameters, PMC_DECELERATION),
                        .start = K_OF_SPEED * (uint64_t)parameters->value[PMC_START_SPEED]};
    plan.q = 16000 * plan.acceleration * plan.deceleration;
    return plan;
}

static uint64_t lower(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

/* ---- Points -------------------------------------------------------------------------------------------------------- */

/* number / divisor as a place, cut off behind 96 places; up: rounded up, so that what begins there is not a tick late. */
static struct rkm04_place place_of(struct wide number, uint64_t divisor, bool up)
{
    bool inexact;
    uint64_t rest, whole = wide_divide(number, divisor, &rest);
    const struct wide places = wide_fraction(rest, divisor, &inexact);
    struct wide place = {whole << 32 | places.high >> 32, places.high << 32 | places.low >> 32};
    if (up && inexact)
        place = wide_sum(place, wide_of(1));
    return (struct rkm04_place){place.high, place.low};
}

static struct rkm04_fixed w_of(const struct plan *plan, uint64_t k)
{
    return (struct rkm04_fixed){(int64_t)(W_OF_K * plan->m * k), 0};
}

/* `rate` of acceleration or deceleration as a slope in pulses/s^2. */
static int32_t slope_of(const struct plan *plan, uint64_t rate)
{
    return (int32_t)(125 * plan->m * rate);
}

static void add_point(const struct plan *plan, struct rkm04_place at, struct rkm04_fixed w, int32_t slope)
{
    struct pmc_motion *motion = plan->motion;
    motion->point[motion->count++] = (struct pmc_break){.at = at, .w = w, .slope = slope};
}

/* A point at the present place and speed. */
static void add_present(const struct plan *plan, int32_t slope)
{
    add_point(plan, place_of(plan->z, plan->q, true), w_of(plan, plan->k), slope);
}

static void add_end(const struct plan *plan, uint32_t total, uint64_t k)
{
    add_point(plan, (struct rkm04_place){(uint64_t)total << 32, 0}, w_of(plan, k), 0);
    plan->motion->total = total;
    plan->motion->endless = false;
}

/* Way from k0 up to k1, or down from there, in 1 / Q. */
static uint64_t rise_of(const struct plan *plan, uint64_t k0, uint64_t k1)
{
    return plan->m * plan->deceleration * (k1 * k1 - k0 * k0);
}

static uint64_t fall_of(const struct plan *plan, uint64_t k0, uint64_t k1)
{
    return plan->m * plan->acceleration * (k1 * k1 - k0 * k0);
}

/* ---- Legs ---------------------------------------------------------------------------------------------------------- */

static void begin_leg(struct pmc_motion *motion, struct rkm04_instant start)
{
    const struct pmc_break *from = &motion->point[motion->leg];
    struct ramp_leg leg = {.from = from->at, .w = from->w, .slope = from->slope};
    leg.open = motion->endless && motion->leg + 1u == motion->count;
    if (!leg.open) {
        leg.to = from[1].at;
        leg.w_end = from[1].w;
        leg.last = !motion->endless && ramp_step_of(leg.to) == motion->total;
    }
    ramp_begin_leg(&motion->ramp, &leg, start);
}

static void begin_points(struct pmc_motion *motion, uint64_t tick)
{
    motion->leg = 0;
    motion->done = 0;
    ramp_set_rate(&motion->ramp, PMC_TICKS_PER_SECOND);
    begin_leg(motion, (struct rkm04_instant){tick, 0, 0});
}

size_t pmc_plan_pulses(struct pmc_motion *motion, uint64_t limit, uint64_t *tick, size_t room)
{
    while (ramp_leg_is_over(&motion->ramp, limit)) {
        motion->leg++;
        begin_leg(motion, motion->ramp.end);
    }
    return ramp_leg_ticks(&motion->ramp, limit, tick, room);
}

/* ---- From a place and speed to a goal ------------------------------------------------------------------------------ */

/* Bring the present speed down to k, or where it may jump, to k. At or below the start speed it changes at once (AM7). */
static void reach_speed(struct plan *plan, uint64_t k)
{
    if (plan->k > k) {
        const uint64_t floor = plan->k > plan->start ? (k > plan->start ? k : plan->start) : plan->k;
        if (floor < plan->k) {
            add_present(plan, -slope_of(plan, plan->deceleration));
            plan->z = wide_sum(plan->z, wide_of(fall_of(plan, floor, plan->k)));
            plan->k = floor;
            if (floor > k)
                add_present(plan, 0); /* a leg without length: its end has another speed than the next one's begin */
        }
        plan->k = k;
    } else if (plan->k < plan->start) {
        plan->k = lower(plan->start, k);
    }
}

/* w of the speed whose square is square / (m * sum): w^2 = W_OF_K^2 * m * square / sum, below 2^107. */
static struct rkm04_fixed peak_of(const struct plan *plan, uint64_t square, uint64_t sum)
{
    /* Three digits of 64 bits, the last one behind the point; so many of its places as there is room for. */
    const struct wide product = wide_product((uint64_t)W_OF_K * W_OF_K * plan->m, square);
    uint64_t left, unused, high = wide_divide(wide_of(product.high), sum, &left);
    struct wide number = {high, wide_divide((struct wide){left, product.low}, sum, &left)};
    const uint64_t places = wide_divide((struct wide){left, 0}, sum, &unused);
    unsigned shift = 0;
    for (; shift < 62 && !(number.high >> 60); shift += 2)
        number = wide_shifted(number, 2);
    number.low |= places >> (64 - shift);
    bool inexact;
    const struct wide root = wide_root(number, 64 - shift / 2, &inexact);
    return (struct rkm04_fixed){(int64_t)root.high, root.low};
}

/* From the present speed up to a peak below the speed of the motion, and down to `k_end` at `total`; `rest` is the way there in
 * 1 / Q. With two accelerations the square of the peak is square / (m * (acceleration + deceleration)). */
static void add_peak(const struct plan *plan, uint64_t rest, uint32_t total, uint64_t k_end)
{
    const uint64_t a = plan->acceleration, d = plan->deceleration, sum = a + d;
    const uint64_t square = rest + plan->m * (d * plan->k * plan->k + a * k_end * k_end);
    const uint64_t gain = square - plan->m * sum * plan->k * plan->k;
    const struct wide way = wide_sum(wide_product(plan->z.low, sum), wide_product(gain, d));
    add_present(plan, slope_of(plan, a));
    add_point(plan, place_of(way, plan->q * sum, false), peak_of(plan, square, sum), -slope_of(plan, d));
    add_end(plan, total, k_end);
}

/* To `total` pulses at speed k, as fast as it gets. */
static void add_way(struct plan *plan, uint32_t total, uint64_t k)
{
    const uint64_t k_end = lower(plan->start, k), rise = rise_of(plan, plan->k, k), fall = fall_of(plan, k_end, k);
    const struct wide end = wide_product(plan->q, total), rest = wide_difference(end, plan->z);
    if (wide_less(rest, wide_of(rise + fall))) {
        add_peak(plan, rest.low, total, k_end);
        return;
    }
    if (rise > 0) {
        add_present(plan, slope_of(plan, plan->acceleration));
        plan->z = wide_sum(plan->z, wide_of(rise));
        plan->k = k;
    }
    const struct wide top = wide_difference(end, wide_of(fall));
    if (wide_less(plan->z, top))
        add_present(plan, 0);
    if (fall > 0)
        add_point(plan, place_of(top, plan->q, false), w_of(plan, k), -slope_of(plan, plan->deceleration));
    add_end(plan, total, k_end);
}

static void add_endless(struct plan *plan, uint64_t k)
{
    if (plan->k < k) {
        add_present(plan, slope_of(plan, plan->acceleration));
        plan->z = wide_sum(plan->z, wide_of(rise_of(plan, plan->k, k)));
        plan->k = k;
    }
    add_present(plan, 0);
}

static void plan_on(struct plan *plan, uint64_t tick, uint64_t k)
{
    struct pmc_motion *motion = plan->motion;
    motion->count = 0;
    reach_speed(plan, k);
    if (motion->endless)
        add_endless(plan, k);
    else
        add_way(plan, motion->total, k);
    begin_points(motion, tick);
}

void pmc_plan_begin(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick, uint16_t speed,
                    uint16_t start_speed)
{
    struct plan plan = plan_of(motion, parameters);
    plan.start = (uint64_t)K_OF_SPEED * start_speed; /* which it has at once, or its speed where that is lower */
    plan_on(&plan, tick, (uint64_t)K_OF_SPEED * speed);
}

/* ---- In motion ----------------------------------------------------------------------------------------------------- */

/* Does the speed only fall from here to the end? */
static bool on_final_ramp(const struct pmc_motion *motion)
{
    bool falls = !motion->endless;
    for (unsigned i = motion->leg; falls && i + 1u < motion->count; i++)
        falls = motion->point[i].slope < 0;
    return falls;
}

/* Plan from the present place and speed; places count from the pulse sent last. */
static struct plan present_plan(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick)
{
    struct plan plan = plan_of(motion, parameters);
    struct rkm04_fixed y, w;
    uint64_t rest;
    ramp_state_at(&motion->ramp, tick, &y, &w);
    /* z = Q * y / step = acceleration * deceleration * y / (8 * 10^9), a whole number but for what y has been rounded. */
    const uint64_t behind = (uint64_t)(y.whole + motion->ramp.step), unit = UINT64_C(8000000000);
    const struct wide number = wide_sum(wide_product(behind, plan.acceleration * plan.deceleration), wide_of(unit / 2));
    plan.z = wide_of(wide_divide(number, unit, &rest));
    plan.k = ((uint64_t)w.whole + W_OF_K * plan.m / 2) / (W_OF_K * plan.m);
    motion->total -= motion->done;
    return plan;
}

bool pmc_plan_speed(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick, uint16_t speed)
{
    if (on_final_ramp(motion))
        return false;
    struct plan plan = present_plan(motion, parameters, tick);
    plan_on(&plan, tick, (uint64_t)K_OF_SPEED * speed);
    return true;
}

bool pmc_plan_stop(struct pmc_motion *motion, const struct pmc_parameters *parameters, uint64_t tick)
{
    if (on_final_ramp(motion))
        return true;
    struct plan plan = present_plan(motion, parameters, tick);
    motion->count = 0;
    if (plan.k > plan.start) {
        add_present(&plan, -slope_of(&plan, plan.deceleration));
        plan.z = wide_sum(plan.z, wide_of(fall_of(&plan, plan.start, plan.k)));
        plan.k = plan.start;
    }
    uint64_t rest;
    uint32_t total = (uint32_t)wide_divide(plan.z, plan.q, &rest);
    if (rest > 0) {
        add_present(&plan, 0);
        total++;
    }
    if (total == 0)
        return false;
    add_end(&plan, total, plan.k);
    begin_points(motion, tick);
    return true;
}
