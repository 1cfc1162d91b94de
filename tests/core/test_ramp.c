/* SPDX-License-Identifier: MIT */
/* The pulse generator by itself: at other rates of ticks than the unit's, and how right its blocks of pulses are. */
#include <math.h>
#include <stdlib.h>

#include "motion_rig.h"
#include "profile.h"
#include "ramp.h"
#include "ramp_pulses.h"

static const uint32_t rates[] = {1000000, 8000000, 16000000, 3686400};
#define RATES ((int)(sizeof rates / sizeof *rates))

/* ---- Every pulse at its tick, at any rate ------------------------------------------------------------------------- */

static struct rkm04_motion motion;

/* Begin a motion from rest at tick 0. */
static void begin(uint32_t rate, unsigned start_speed, const struct ref_segment *of)
{
    motion = (struct rkm04_motion){.kind = RKM04_MOTION_STEPS, .segments = 1, .start_speed = (uint16_t)start_speed};
    motion.segment[0] = (struct rkm04_segment){.steps = (uint32_t)of->steps,
                                               .speed = (uint16_t)of->speed,
                                               .acceleration = (uint16_t)of->acceleration,
                                               .deceleration = (uint16_t)of->acceleration};
    motion.total = (uint32_t)of->steps;
    profile_plan(&motion);
    ramp_begin(&motion.ramp, &motion.profile, 0, rate);
}

/* All pulses, asked for in spans of time and numbers of any size. */
static void expect_all(unsigned start_speed, const struct ref_segment *of)
{
    uint64_t tick[64], limit = 0, count = 0;
    while (motion.ramp.next != RKM04_NEVER) {
        limit += motion_random(4) == 0 ? motion_random(100000000) : motion_random(40000);
        while (motion.ramp.next <= limit) {
            size_t n = ramp_pulses(&motion.ramp, &motion.profile, limit, tick, 1 + motion_random(64));
            for (size_t i = 0; i < n; i++) {
                uint64_t due = ref_single_tick(start_speed, of, ++count);
                motion_check(tick[i] == due, "pulse %" PRIu64 " at %" PRIu64 ", expected %" PRIu64 "; %s", count, tick[i], due,
                             motion_what());
            }
        }
    }
    motion_check(count == of->steps, "%" PRIu64 " pulses; %s", count, motion_what());
}

static void try_motion(uint32_t rate, unsigned start_speed, const struct ref_segment *of)
{
    motion_trying("%u ticks a second:", rate);
    motion_trying_segments(start_speed, of, 1);
    begin(rate, start_speed, of);
    expect_all(start_speed, of);
}

START_TEST(R1_every_pulse_is_exact_at_any_rate)
{
    ref_use_rate(rates[_i]);
    for (unsigned i = 0; i < motion_count(600); i++) {
        motion_randomize(100000 * (unsigned)_i + i);
        unsigned start_speed = motion_pick(1, 2000);
        struct ref_segment of = {.steps = motion_pick(1, i % 8 == 0 ? 20000 : 800),
                                 .speed = motion_pick(1, 16000),
                                 .acceleration = motion_pick(1, 60000)};
        try_motion(rates[_i], start_speed, &of);
    }
}
END_TEST

START_TEST(R1_the_steepest_ramps_from_the_lowest_speeds_are_exact_at_any_rate)
{
    static const struct ref_segment steep[] = {
        {3000, 16000, 60000}, {9000, 15999, 59999}, {1, 16000, 60000}, {40000, 16000, 4000}};
    ref_use_rate(rates[_i]);
    motion_randomize(7);
    for (unsigned i = 0; i < sizeof steep / sizeof *steep; i++)
        try_motion(rates[_i], 1 + i % 2, &steep[i]);
}
END_TEST

/* A pulse on the falling leg is due so short after a tick that the slope of one tick decides. */
START_TEST(R1_pulses_just_after_a_tick_are_not_a_tick_early)
{
    static const struct {
        unsigned start_speed;
        struct ref_segment of;
    } close[] = {{1, {300, 2000, 32962}}, {18, {208, 2000, 38126}}, {1578, {800, 16000, 31278}}, {197, {421, 10940, 2961}}};
    ref_use_rate(1000000);
    motion_randomize(8);
    for (unsigned i = 0; i < sizeof close / sizeof *close; i++)
        try_motion(1000000, close[i].start_speed, &close[i].of);
}
END_TEST

/* A slope that no RKM04 has: y / w and its square pass 64 bits. */
START_TEST(R1_a_slope_of_a_million_steps_per_second_squared_is_exact_at_any_rate)
{
    const uint64_t slope = 1000000, top = 12000, way2 = top * top - 1; /* 2 * slope * steps */
    const struct wide places = wide_fraction(way2 % (2 * slope), 2 * slope, &(bool){false});
    struct rkm04_profile profile = {.count = 2, .endless = true};
    profile.point[0] = (struct rkm04_break){.speed2 = UINT64_C(2) << RAMP_SPEED2_BITS, .slope = (int32_t)slope};
    profile.point[1].speed2 = 2 * top * top << RAMP_SPEED2_BITS;
    profile.point[1].at =
        (struct rkm04_place){way2 / (2 * slope) << 32 | places.high >> 32, places.high << 32 | places.low >> 32};
    struct rkm04_ramp ramp = {.rate = 0};
    ramp_begin(&ramp, &profile, 0, rates[_i]);
    __extension__ typedef unsigned __int128 u128;
    const u128 rate = rates[_i];
    for (uint64_t k = 1, tick; k <= way2 / (2 * slope); k++) {
        ck_assert_uint_eq(ramp_pulses(&ramp, &profile, RKM04_NEVER - 1, &tick, 1), 1);
        /* slope * t^2 + 2 * rate * s * t >= 2 * rate^2 * k, s = 1 */
        const u128 t = tick, need = 2 * rate * rate * k;
        ck_assert_msg(t * (slope * t + 2 * rate) >= need && (t - 1) * (slope * (t - 1) + 2 * rate) < need,
                      "pulse %" PRIu64 " at %" PRIu64, k, tick);
    }
}
END_TEST

/* ---- Blocks --------------------------------------------------------------------------------------------------------- */

#define BOUND 0.0065 /* ticks; what lies within 2^-7 = 0.0078 of a whole tick is worked out again (docs/DESIGN.md) */

/* Begin a block at a random place, mostly at a speed that just allows one of its size. Returns false if there is none. */
static bool begin_block(struct rkm04_ramp *ramp, uint32_t rate)
{
    const uint32_t slope = motion_random(8) == 0 ? 0 : motion_pick(1, 60000);
    const uint64_t fast = ramp_fast_from(slope, rate), top = UINT64_C(2) * rate * RKM04_SPEED_MAX;
    uint64_t w = fast * (8 + motion_random(52)) / 16;
    if (motion_random(2) == 0 || slope == 0)
        w += motion_random(top);
    if (w > top || w < UINT64_C(2) * rate)
        return false;
    *ramp = (struct rkm04_ramp){.rate = rate, .step = 2 * (int64_t)rate * rate, .fast = fast};
    ramp->left = 9 + (uint32_t)motion_random(160);
    ramp->slope = motion_random(2) == 0 ? (int32_t)slope : -(int32_t)slope;
    ramp->w = (struct rkm04_fixed){(int64_t)w, motion_random(UINT64_MAX)};
    ramp->y = (struct rkm04_fixed){(int64_t)motion_random(w), motion_random(UINT64_MAX)};
    ramp->interval = (int32_t)((uint64_t)ramp->step / w + motion_random(2));
    return ramp_begin_block(ramp);
}

/* Ticks from ramp->at to pulse j after the one there. */
static long double time_of(const struct rkm04_ramp *ramp, unsigned j)
{
    const long double y = (long double)ramp->y.whole + (long double)ramp->y.part / 0x1p64L;
    const long double w = (long double)ramp->w.whole + (long double)ramp->w.part / 0x1p64L;
    const long double way = (long double)ramp->step * j - y;
    return 2 * way / (w + sqrtl(w * w + 4 * (long double)ramp->slope * way));
}

START_TEST(R1_blocks_of_pulses_are_right_to_less_than_what_is_checked_anew)
{
    unsigned blocks = 0, sizes = 0;
    motion_randomize(8 + (unsigned)_i);
    for (unsigned i = 0; i < motion_count(400000); i++) {
        struct rkm04_ramp ramp;
        if (!begin_block(&ramp, rates[_i]))
            continue;
        blocks++;
        sizes |= 1u << ramp.block / 8;
        uint64_t due = ramp.due, due1 = ramp.due1, due2 = ramp.due2;
        for (unsigned j = 1; j <= ramp.block; j++) {
            double error = (double)(((long double)due - RAMP_NEAR) / 0x1p32L - time_of(&ramp, j));
            motion_check(fabs(error) < BOUND, "rate %u, slope %d, w %" PRId64 ", pulse %u of %u: %g ticks wrong", ramp.rate,
                         ramp.slope, ramp.w.whole, j, ramp.block, error);
            due += due1;
            due1 += due2;
            due2 += ramp.due3;
        }
    }
    ck_assert_uint_gt(blocks, motion_count(80000));
    ck_assert_uint_eq(sizes, 1 << 16 | 1 << 12 | 1 << 8 | 1 << 6 | 1 << 4 | 1 << 3 | 1 << 2 | 1 << 1); /* 128, 96 … 12 and 8 */
}
END_TEST

/* The bound of docs/DESIGN.md is kept, and no more than what rounding takes is given away. */
START_TEST(R1_blocks_begin_at_the_speed_from_which_they_are_right)
{
    static const uint32_t slopes[] = {1, 2, 3, 5, 100, 1023, 1024, 9000, 20000, 60000, 1000000};
    for (uint32_t rate = 1000000; rate <= 16000000; rate *= 2) {
        for (unsigned i = 0; i < sizeof slopes / sizeof *slopes; i++) {
            const double bound = pow(1280 * pow(slopes[i], 3) * pow(8, 4) * pow(2.0 * rate * rate, 4), 1.0 / 7);
            const double from = (double)ramp_fast_from(slopes[i], rate) / bound;
            motion_check(from >= 1 && from < 1.18, "rate %u, slope %u: %g of the bound", rate, slopes[i], from);
        }
        ck_assert_uint_eq(ramp_fast_from(0, rate), ramp_fast_from(1, rate)); /* a speed that is no whole number */
        ck_assert_uint_eq(ramp_fast_from(9000, rate + 1), ramp_fast_from(9000, rate * 2)); /* of the next power of two */
        ck_assert_uint_eq(ramp_fast_from(9000, rate * 2 - 1), ramp_fast_from(9000, rate * 2));
    }
}
END_TEST

/* Pulses of a block that begins at this speed. */
static unsigned block_at(uint64_t w, uint32_t left)
{
    struct rkm04_ramp ramp = {.rate = 1000000, .step = INT64_C(2000000000000), .slope = 9000, .left = left};
    ramp.fast = ramp_fast_from(9000, 1000000);
    ramp.w.whole = (int64_t)w;
    ramp.interval = (int32_t)(ramp.step / ramp.w.whole);
    return ramp_begin_block(&ramp) ? ramp.block : 0;
}

/* The same bound for blocks of other sizes: they begin at the sixteenth of that speed that is the next to it, those above 64 up
 * to a fifteenth later. */
START_TEST(R1_blocks_are_as_large_as_the_speed_allows)
{
    static const unsigned sizes[] = {0, 8, 12, 16, 24, 32, 48, 64, 96, 128, 0};
    const uint64_t fast = ramp_fast_from(9000, 1000000);
    unsigned found = 0;
    for (uint64_t w = fast / 2; w < 4 * fast; w += fast / 256) {
        const unsigned pulses = block_at(w, 1000);
        ck_assert(pulses == sizes[found] || pulses == sizes[found + 1]);
        if (pulses == sizes[found])
            continue;
        const double sixteenths = 16 * (double)w / (double)fast, bound = 16 * pow(pulses / 16.0, 4.0 / 7);
        ck_assert_msg(sixteenths > bound - 0.62 && sixteenths < bound * (pulses > 64 ? 16.0 / 15 : 1) + 0.62,
                      "%u pulses from %g/16 on, not %g/16", pulses, sixteenths, bound);
        ck_assert_uint_eq(block_at(w, pulses + 1), pulses); /* none is the last of its leg */
        ck_assert_uint_eq(block_at(w, pulses), sizes[found]);
        found++;
    }
    ck_assert_uint_eq(found, 9);
}
END_TEST

/* At constant speed one call gives all that are due, up to 64, and none that is not. */
START_TEST(R1_blocks_at_constant_speed_are_full)
{
    motion_randomize(9 + (unsigned)_i);
    for (unsigned i = 0; i < motion_count(3000); i++) {
        const uint64_t rate = rates[_i], speed = i == 0 ? 15874 : motion_pick(1, 16000); /* 62.996 ticks */
        struct rkm04_profile profile = {.count = 1, .endless = true, .point[0].speed2 = 2 * speed * speed << RAMP_SPEED2_BITS};
        struct rkm04_ramp ramp = {.rate = 0};
        ramp_begin(&ramp, &profile, 0, rates[_i]);
        for (uint64_t tick[64], sent = 0, calls = 0; calls < 4; calls++) {
            const uint64_t more = 1 + motion_random(63), next = ((sent + more + 1) * rate + speed - 1) / speed;
            ck_assert_uint_eq(ramp_pulses(&ramp, &profile, next - 1, tick, 64), more);
            ck_assert_uint_eq(tick[0], ((sent + 1) * rate + speed - 1) / speed);
            ck_assert_uint_eq(ramp_pulses(&ramp, &profile, RKM04_NEVER - 1, tick, 64), 64);
            ck_assert_uint_eq(tick[0], next);
            sent += more + 64;
        }
    }
}
END_TEST

int main(void)
{
    ref_use_blocks();
    Suite *suite = suite_create("ramp");
    TCase *rate = tcase_create("rate");
    tcase_set_timeout(rate, 200);
    tcase_add_loop_test(rate, R1_every_pulse_is_exact_at_any_rate, 0, RATES);
    tcase_add_loop_test(rate, R1_the_steepest_ramps_from_the_lowest_speeds_are_exact_at_any_rate, 0, RATES);
    tcase_add_test(rate, R1_pulses_just_after_a_tick_are_not_a_tick_early);
    tcase_add_loop_test(rate, R1_a_slope_of_a_million_steps_per_second_squared_is_exact_at_any_rate, 0, RATES);
    suite_add_tcase(suite, rate);
    TCase *block = tcase_create("blocks");
    tcase_set_timeout(block, 200);
    tcase_add_loop_test(block, R1_blocks_at_constant_speed_are_full, 0, RATES);
    tcase_add_test(block, R1_blocks_are_as_large_as_the_speed_allows);
    tcase_add_test(block, R1_blocks_begin_at_the_speed_from_which_they_are_right);
    tcase_add_loop_test(block, R1_blocks_of_pulses_are_right_to_less_than_what_is_checked_anew, 0, RATES);
    suite_add_tcase(suite, block);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
