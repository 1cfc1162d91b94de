/* SPDX-License-Identifier: MIT */
/* Stops by K, M, N, X at every slot (R5, C3, C5, C6, P7): the number of steps exact, the pulses within a tick. A whole number of
 * steps is a knife edge; the searches below find stops on both sides of it, at distances down to 10^-8 of a step and less. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion_rig.h"

#define SLOT RKM04_SLOT_TICKS

static struct motion_rig rig, save;
static struct ref_track whole, stopped, rest;
static unsigned edges[4]; /* stops met, by enum ref_edge */

static void setup(void)
{
    ref_init(&whole);
    ref_init(&stopped);
    ref_init(&rest);
}

static void teardown(void)
{
    ref_clear(&whole);
    ref_clear(&stopped);
    ref_clear(&rest);
}

/* ---- One stop ----------------------------------------------------------------------------------------------------- */

/* What stops. */
enum stopper { BY_K, BY_M, BY_N, BY_X, STOPPERS };

static const char *const stopper_name[] = {"K", "M", "N", "X"};
static const char *const arming[] = {"", "M02 ", "N02 ", "X02 "};

/* Deliver the stop before slot `tick`, some ticks early. */
static void deliver(enum stopper by, uint64_t tick)
{
    uint64_t early = motion_random(3) == 0 ? motion_random(SLOT) : 0, now = rkm04_now(&rig.unit);
    motion_to(&rig, tick - early > now ? tick - early : now);
    if (by == BY_K)
        motion_send(&rig, "K");
    else
        rkm04_set_inputs(&rig.unit, by == BY_N ? 0 : 2);
    motion_to(&rig, tick + 1);
}

/* The motion of `whole`, begun at `begin`, is under way up to before slot begin + at. Stop it there and look at the rest. */
static void expect_stop(enum stopper by, uint64_t begin, uint64_t at)
{
    static char table[1024];
    ref_copy(&stopped, &whole);
    ref_stop(&stopped, at);
    edges[stopped.edge]++;
    uint64_t before = ref_steps_at(&whole, at), end = at;
    deliver(by, begin + at);
    if (stopped.steps > before) {
        end = ref_tick(&stopped, stopped.steps);
        if (by == BY_K && whole.legs < RKM04_BREAKS_MAX - 3) {
            ref_table(&stopped, table, sizeof table);
            const char *answer = motion_table(&rig);
            motion_check(strcmp(answer, table) == 0, "table %s, expected %s; %s", answer, table, motion_what());
        }
    }
    motion_to(&rig, begin + end + 100 * SLOT);
    motion_expect(&rig, &stopped, begin, 0, before > 3 ? before - 3 : 1, 1);
    static const enum rkm04_state after[] = {RKM04_HELD, RKM04_IDLE, RKM04_IDLE, RKM04_ENDED};
    motion_check(motion_state(&rig) == after[by], "state %s; %s", rkm04_state_name(motion_state(&rig)), motion_what());
    motion_check(rig.ends == rig.begins, "%u begins, %u ends; %s", rig.begins, rig.ends, motion_what());
    motion_check(rig.position == (int32_t)stopped.steps, "position %d; %s", rig.position, motion_what());
}

/* After expect_stop by K: C75 makes the rest, from standstill. */
static void expect_resume(void)
{
    uint64_t tick = rkm04_now(&rig.unit) + motion_random(2 * SLOT), slot = (tick + SLOT - 1) / SLOT * SLOT;
    uint64_t done = rig.steps;
    motion_to(&rig, tick);
    motion_send(&rig, "C75");
    motion_to(&rig, slot + 1);
    if (!ref_plan_rest(&rest, &stopped)) {
        motion_to(&rig, slot + 100 * SLOT);
        motion_check(rig.steps == done && motion_state(&rig) == RKM04_IDLE, "%" PRIu64 " steps after C75; %s", rig.steps,
                     motion_what());
        return;
    }
    motion_check(rig.begin == slot, "goes on at %" PRIu64 " instead of %" PRIu64 "; %s", rig.begin, slot, motion_what());
    if (rest.steps >= REF_ENDLESS) {
        rest.steps = ref_steps_at(&rest, 199999);
        motion_to(&rig, slot + 200000);
    } else {
        motion_to(&rig, slot + ref_tick(&rest, rest.steps) + 100 * SLOT);
        motion_check(motion_state(&rig) == RKM04_IDLE, "not idle; %s", motion_what());
    }
    motion_expect(&rig, &rest, slot, done, 1, 1);
}

/* Begin a motion of one or more segments, or an endless one, with the stopper armed. Returns the slot in which it begins. */
static uint64_t begin_motion(enum stopper by, unsigned s, const struct ref_segment *segment, unsigned n)
{
    char text[700];
    motion_start(&rig, 0);
    rkm04_set_inputs(&rig.unit, by == BY_N ? 2 : 0);
    int length = snprintf(text, sizeof text, "%sS%u", arming[by], s);
    unsigned commands = (by == BY_K ? 0 : 1) + 1;
    for (unsigned i = 0; i < n; i++) {
        length += snprintf(text + length, sizeof text - (size_t)length, " A%u V%u", segment[i].acceleration, segment[i].speed);
        commands += 2;
        if (segment[i].steps != REF_ENDLESS) {
            const char *const format = n > 1 ? " F%u Y" : " F%u";
            length += snprintf(text + length, sizeof text - (size_t)length, format, (unsigned)segment[i].steps);
            commands += n > 1 ? 2 : 1;
        }
    }
    snprintf(text + length, sizeof text - (size_t)length, segment[0].steps == REF_ENDLESS ? " G+" : " R");
    motion_send(&rig, text);
    ref_plan(&whole, s, segment, n);
    return (commands + 1) * SLOT;
}

/* Stop one motion at every slot up to `most`; each time the unit is put back to where it was. */
static void stop_everywhere(unsigned s, const struct ref_segment *segment, unsigned n, unsigned most, bool resume)
{
    for (enum stopper by = BY_K; by < STOPPERS; by++) {
        uint64_t begin = begin_motion(by, s, segment, n);
        for (unsigned slot = 1; slot <= most; slot++) {
            if (whole.steps < REF_ENDLESS && slot * SLOT >= ref_tick(&whole, whole.steps))
                break;
            motion_trying("%s in slot %u of", stopper_name[by], slot);
            motion_trying_segments(s, segment, n);
            motion_to(&rig, begin + (slot - 1) * SLOT + 1);
            save = rig;
            expect_stop(by, begin, slot * SLOT);
            if (by == BY_K && resume)
                expect_resume();
            rig = save;
        }
    }
}

START_TEST(R5_a_trapezoid_stops_exactly_in_every_slot)
{
    const struct ref_segment m = {900, 1000, 2000};
    stop_everywhere(100, &m, 1, 2000, true);
    ck_assert_uint_ge(edges[REF_EDGE_WHOLE], 400 * 4); /* every slot at constant speed */
}
END_TEST

START_TEST(R5_trapezoids_with_fractional_phases_stop_exactly_in_every_slot)
{
    const struct ref_segment m[] = {{700, 997, 2003}, {400, 1501, 7001}, {300, 331, 60000}, {1300, 15999, 59999}};
    stop_everywhere(97, &m[0], 1, 2000, true);
    stop_everywhere(1, &m[1], 1, 2000, false);
    stop_everywhere(330, &m[2], 1, 2000, false);
    stop_everywhere(1999, &m[3], 1, 2000, true);
}
END_TEST

START_TEST(R5_triangles_stop_exactly_in_every_slot)
{
    const struct ref_segment m[] = {{400, 16000, 2000}, {301, 16000, 7919}, {2, 16000, 1}, {1, 16000, 100}};
    stop_everywhere(100, &m[0], 1, 2000, true);
    stop_everywhere(3, &m[1], 1, 2000, false);
    stop_everywhere(5, &m[2], 1, 2000, true);
    stop_everywhere(1, &m[3], 1, 2000, false);
}
END_TEST

START_TEST(R5_motions_not_faster_than_S_stop_at_the_next_whole_step)
{
    const struct ref_segment m[] = {{40, 70, 2000}, {60, 100, 2000}, {3, 1, 1}, {50, 125, 60000}};
    for (unsigned i = 0; i < 4; i++)
        stop_everywhere(125, &m[i], 1, 700, true);
}
END_TEST

START_TEST(R5_compounds_stop_exactly_in_every_slot)
{
    const struct ref_segment ups[] = {{100, 500, 2000}, {200, 2000, 6000}, {150, 300, 4000}, {100, 1000, 3001}};
    const struct ref_segment slow[] = {{30, 60, 2000}, {100, 900, 1500}, {40, 50, 3000}, {20, 80, 500}};
    const struct ref_segment unreachable[] = {{20, 16000, 3000}, {50, 15000, 3000}, {130, 700, 3000}, {100, 16000, 999}};
    const struct ref_segment steps[] = {{1, 500, 1000}, {1, 700, 60000}, {1, 300, 7}, {50, 900, 2999}, {1, 2000, 5000}};
    stop_everywhere(100, ups, 4, 2000, true);
    stop_everywhere(100, slow, 4, 2000, true);
    stop_everywhere(50, unreachable, 4, 2000, false);
    stop_everywhere(10, steps, 5, 2000, false);
}
END_TEST

START_TEST(R5_random_compounds_stop_exactly_in_every_slot)
{
    for (unsigned i = 0; i < motion_count(40); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        motion_randomize(i);
        unsigned n = 1 + (unsigned)motion_random(REF_SEGMENTS), s = motion_pick(1, 2000);
        for (unsigned j = 0; j < n; j++)
            segment[j] = (struct ref_segment){motion_pick(1, 300), motion_pick(2, 16000), motion_pick(10, 60000)};
        stop_everywhere(s, segment, n, 60, i % 4 == 0);
    }
}
END_TEST

START_TEST(R5_endless_motions_stop_exactly_in_every_slot)
{
    const struct ref_segment m[] = {{REF_ENDLESS, 1000, 2000}, {REF_ENDLESS, 7919, 29989}, {REF_ENDLESS, 90, 2000}};
    for (unsigned i = 0; i < 3; i++)
        stop_everywhere(100, &m[i], 1, 700, i == 0);
}
END_TEST

START_TEST(R5_a_limit_move_stops_at_the_next_whole_step_or_at_its_input)
{
    static const char *const text[] = {"S333 )01", "M02 S333 )01", "N02 S333 )01", "X02 S333 )01"};
    const struct ref_segment m = {REF_ENDLESS, 333, 2000};
    for (unsigned by = 0; by <= STOPPERS; by++)
        for (unsigned slot = 1; slot < 300; slot += 1 + slot / 100) {
            motion_trying("limit move, %s in slot %u", by < STOPPERS ? stopper_name[by] : "its input", slot);
            motion_start(&rig, 0);
            rkm04_set_inputs(&rig.unit, by == BY_N ? 2 : 0);
            motion_send(&rig, by < STOPPERS ? text[by] : text[0]);
            uint64_t begin = (by == BY_K || by == STOPPERS ? 2 : 3) * SLOT;
            ref_plan(&whole, 333, &m, 1);
            motion_to(&rig, begin + 1);
            ck_assert_str_eq(motion_table(&rig), " 1;[(1;333)]");
            if (by < STOPPERS) {
                save = rig;
                ref_copy(&stopped, &whole);
                ref_stop(&stopped, slot * SLOT);
                deliver((enum stopper)by, begin + slot * SLOT);
            } else {
                ref_copy(&stopped, &whole);
                stopped.steps = ref_steps_at(&whole, slot * SLOT);
                motion_to(&rig, begin + slot * SLOT - motion_random(SLOT));
                rkm04_set_inputs(&rig.unit, 1);
            }
            motion_to(&rig, begin + (slot + 100) * SLOT);
            motion_expect(&rig, &stopped, begin, 0, 1, 1);
        }
}
END_TEST

/* ---- Knife edges --------------------------------------------------------------------------------------------------- */

/* A motion at constant speed V since long is stopped at slot n: x' = S(V - S)/A + Vn/1000. Finds the slot at which it lies
 * r/1000A above a whole number. Returns 0 if there is none. */
static unsigned slot_of_remainder(unsigned s, unsigned v, unsigned a, uint64_t r, unsigned first)
{
    uint64_t unit = UINT64_C(1000) * a, offset = UINT64_C(1000) * s * (v - s) % unit;
    for (unsigned n = first; n < first + 1000; n++)
        if ((offset + (uint64_t)v * a % unit * n) % unit == r)
            return n;
    return 0;
}

/* Stop a motion at constant speed in one slot, by K. */
static void stop_once(unsigned s, const struct ref_segment *segment, unsigned n, unsigned slot, enum ref_edge expected)
{
    motion_trying("knife edge %d, K in slot %u of", (int)expected, slot);
    motion_trying_segments(s, segment, n);
    uint64_t begin = begin_motion(BY_K, s, segment, n);
    unsigned before = edges[expected];
    expect_stop(BY_K, begin, slot * SLOT);
    motion_check(edges[expected] == before + 1, "not the edge that was looked for, but %d; %s", (int)stopped.edge, motion_what());
}

START_TEST(R5_a_place_just_above_a_whole_number_adds_a_step_and_a_whole_one_does_not)
{
    unsigned above = 0, exactly = 0;
    motion_randomize(0);
    while (above < motion_count(400) || exactly < motion_count(400)) {
        unsigned s = motion_pick(1, 2000), v = s + 1 + (unsigned)motion_random(14000), a = motion_pick(100, 60000);
        unsigned first = (unsigned)(1000.0 * (v - s) / a) + 2;
        uint64_t r = UINT64_C(1000) * s * (v - s) % a; /* the least remainder that occurs */
        if (first > 3000 || r * 1000 >= a)
            continue;
        unsigned slot = slot_of_remainder(s, v, a, r, first);
        unsigned *met = r == 0 ? &exactly : &above;
        if (slot == 0 || *met >= motion_count(400))
            continue;
        ++*met;
        const struct ref_segment endless = {REF_ENDLESS, v, a};
        uint64_t accelerated = ((uint64_t)v * v - (uint64_t)s * s) / (2 * a), steps = accelerated * 2 + v * (slot / 1000 + 2u);
        const struct ref_segment two[] = {{1 + motion_random(accelerated + 20), v, a}, {steps, v, a}};
        stop_once(s, &endless, 1, slot, r == 0 ? REF_EDGE_WHOLE : REF_EDGE_RATIONAL);
        stop_once(s, &two[1], 1, slot, r == 0 ? REF_EDGE_WHOLE : REF_EDGE_RATIONAL);
        stop_once(s, two, 2, slot, r == 0 ? REF_EDGE_WHOLE : REF_EDGE_RATIONAL);
    }
}
END_TEST

/* x' of a stop at second t, at constant speed in the second of two segments, less V2 t. */
static long double offset_in_second(unsigned s, const struct ref_segment two[2], long double border, long double border_time)
{
    long double v = two[1].speed, a = two[1].acceleration;
    long double steady_place = (long double)two[0].steps + (v * v - border * border) / (2 * a);
    return steady_place - v * (border_time + (v - border) / a) + (v * v - (long double)s * s) / (2 * a);
}

/* The first slot after `first` at which offset + v n/1000 lies less than `near` above a whole number, or 0. v and 1000 have no
 * common divisor, so the fractions of n = 0…999 are all multiples of 1/1000. */
static unsigned slot_just_above(long double offset, unsigned v, unsigned first, long double near)
{
    long double thousandths = offset * 1000, above = thousandths - floorl(thousandths);
    if (above >= near * 1000)
        return 0;
    uint64_t residue = (uint64_t)((int64_t)floorl(thousandths) % 1000 + 1000) % 1000;
    for (unsigned n = first; n < first + 1000; n++)
        if ((residue + (uint64_t)v * n) % 1000 == 0)
            return n;
    return 0;
}

START_TEST(R5_an_irrational_place_just_above_a_whole_number_counts_as_that_number)
{
    unsigned met = 0;
    motion_randomize(1);
    while (met < motion_count(300)) {
        unsigned s = motion_pick(1, 2000);
        struct ref_segment two[] = {{1 + motion_random(60), 16000, motion_pick(10, 60000)}, {0, 0, motion_pick(10, 60000)}};
        long double border = sqrtl((long double)s * s + 2.0L * two[0].acceleration * (long double)two[0].steps);
        two[1].speed = (unsigned)border + 1 + (unsigned)motion_random(2000);
        if (two[1].speed > 16000 || two[1].speed % 2 == 0 || two[1].speed % 5 == 0 || floorl(border) == border)
            continue;
        long double time = (border - s) / two[0].acceleration, steady = time + (two[1].speed - border) / two[1].acceleration;
        if (steady > 3)
            continue;
        long double offset = offset_in_second(s, two, border, time);
        unsigned slot = slot_just_above(offset, two[1].speed, (unsigned)(steady * 1000) + 2, 0.9e-6L);
        if (slot == 0 || two[0].acceleration == two[1].acceleration)
            continue;
        two[1].steps = two[1].speed * (slot / 1000 + 3) + two[1].speed * two[1].speed / two[1].acceleration;
        stop_once(s, two, 2, slot, REF_EDGE_IRRATIONAL);
        met++;
    }
}
END_TEST

/* At a speed up to S the place itself is what counts: x' = x. */
START_TEST(R5_at_a_speed_up_to_S_an_irrational_place_just_above_a_whole_number_counts_as_that_number)
{
    unsigned met = 0;
    motion_randomize(4);
    while (met < motion_count(200)) {
        unsigned s = motion_pick(20, 2000);
        struct ref_segment two[] = {{1 + motion_random(60), 16000, motion_pick(10, 60000)},
                                    {0, 1 + (unsigned)motion_random(s), motion_pick(10, 60000)}};
        long double v = two[1].speed, a = two[0].acceleration;
        long double peak = sqrtl(((long double)s * s + v * v) / 2 + a * (long double)two[0].steps), time = (2 * peak - s - v) / a;
        if (two[1].speed % 2 == 0 || two[1].speed % 5 == 0 || peak > 16000 || floorl(2 * peak) == 2 * peak || time > 3)
            continue;
        if ((s * s - v * v) / (2 * a) > (long double)two[0].steps) /* V2 cannot be reached from S */
            continue;
        long double offset = (long double)two[0].steps - v * time;
        unsigned slot = slot_just_above(offset, two[1].speed, (unsigned)(time * 1000) + 2, 0.9e-6L);
        if (slot == 0)
            continue;
        two[1].steps = two[1].speed * (slot / 1000 + 3);
        stop_once(s, two, 2, slot, REF_EDGE_IRRATIONAL);
        met++;
    }
}
END_TEST

/* Stops in the second segment, at constant speed, where x' lies less than `near` above a whole number; returns how many
 * really do. The lower the second acceleration, the nearer to a whole number may a fraction come. */
static unsigned stop_at_fractions(unsigned tries, long double near, unsigned most_acceleration)
{
    unsigned met = edges[REF_EDGE_RATIONAL];
    while (tries > 0) {
        unsigned s = motion_pick(1, 2000);
        struct ref_segment two[] = {{0, s + 1 + (unsigned)motion_random(2000), motion_pick(100, 60000)},
                                    {0, 0, motion_pick(1, most_acceleration)}};
        two[1].speed = two[0].speed + 1 + (unsigned)motion_random(two[1].acceleration < 1000 ? 2 * two[1].acceleration : 2000);
        long double v = two[0].speed, a = two[0].acceleration, rise = (v * v - (long double)s * s) / (2 * a);
        two[0].steps = (uint64_t)rise + 1 + motion_random(500);
        long double time = (v - s) / a + ((long double)two[0].steps - rise) / v;
        long double steady = time + (two[1].speed - v) / two[1].acceleration;
        if (two[1].speed % 2 == 0 || two[1].speed % 5 == 0 || steady > 3)
            continue;
        unsigned slot = slot_just_above(offset_in_second(s, two, v, time), two[1].speed, (unsigned)(steady * 1000) + 2, near);
        if (slot == 0)
            continue;
        two[1].steps = two[1].speed * (slot / 1000 + 3) + two[1].speed * two[1].speed / two[1].acceleration;
        motion_trying("knife edge in a compound, K in slot %u of", slot);
        motion_trying_segments(s, two, 2);
        uint64_t begin = begin_motion(BY_K, s, two, 2);
        motion_want(&rig, &whole.steps, 1); /* the pulses on the way are too many to keep */
        ref_copy(&stopped, &whole);
        ref_stop(&stopped, slot * SLOT);
        edges[stopped.edge]++;
        motion_to(&rig, begin + slot * SLOT);
        motion_send(&rig, "K");
        uint64_t last = begin + ref_tick(&stopped, stopped.steps);
        motion_to(&rig, last + 100 * SLOT);
        motion_check(rig.steps == stopped.steps && rig.last + 1 >= last && rig.last <= last + 1,
                     "%" PRIu64 " steps, the last at %" PRIu64 ", expected %" PRIu64 " at %" PRIu64 "; %s", rig.steps, rig.last,
                     stopped.steps, last, motion_what());
        tries--;
    }
    return edges[REF_EDGE_RATIONAL] - met;
}

START_TEST(R5_a_rational_place_just_above_a_whole_number_adds_a_step_in_a_compound)
{
    motion_randomize(2);
    ck_assert_uint_ge(stop_at_fractions(motion_count(300), 0.9e-6L, 60000), motion_count(200));
}
END_TEST

START_TEST(R5_a_rational_place_less_than_10_to_the_minus_8_above_a_whole_number_adds_a_step)
{
    motion_randomize(3);
    ck_assert_uint_ge(stop_at_fractions(motion_count(150), 1e-8L, 12), 1);
}
END_TEST

/* ---- Other ways to come to a stop ----------------------------------------------------------------------------------- */

START_TEST(C3_C75_during_the_ramp_goes_on_after_it_and_a_later_K_cancels_that)
{
    const struct ref_segment m = {2000, 1000, 2000};
    for (unsigned cancelled = 0; cancelled < 2; cancelled++)
        for (unsigned slot = 100; slot < 1500; slot += 97) {
            motion_trying("C75 on the ramp%s, K in slot %u of", cancelled ? ", K again" : "", slot);
            motion_trying_segments(100, &m, 1);
            uint64_t begin = begin_motion(BY_K, 100, &m, 1);
            ref_copy(&stopped, &whole);
            ref_stop(&stopped, slot * SLOT);
            motion_to(&rig, begin + slot * SLOT);
            motion_send(&rig, "K");
            motion_to(&rig, begin + (slot + 1) * SLOT + 17);
            motion_send(&rig, "C75");
            motion_to(&rig, begin + (slot + 3) * SLOT + 17);
            if (cancelled)
                motion_send(&rig, "K");
            uint64_t last = begin + ref_tick(&stopped, stopped.steps);
            motion_to(&rig, last + 5 * SLOT);
            if (cancelled) {
                motion_expect(&rig, &stopped, begin, 0, 1, 1);
                ck_assert_int_eq(motion_state(&rig), RKM04_HELD);
                continue;
            }
            uint64_t again = rig.begin;
            motion_check(again % SLOT == 0 && again >= last && again <= last + SLOT + 11,
                         "goes on at %" PRIu64 ", last pulse at %" PRIu64 "; %s", again, last, motion_what());
            ck_assert(ref_plan_rest(&rest, &stopped));
            motion_to(&rig, again + ref_tick(&rest, rest.steps) + 5 * SLOT);
            motion_expect(&rig, &rest, again, stopped.steps, 1, 1);
            ck_assert_int_eq(motion_state(&rig), RKM04_IDLE);
        }
}
END_TEST

START_TEST(C3_a_motion_held_and_resumed_many_times_makes_all_its_steps)
{
    const struct ref_segment three[] = {{300, 700, 3000}, {500, 1500, 2500}, {200, 400, 9001}};
    for (unsigned i = 0; i < motion_count(100); i++) {
        motion_randomize(i);
        uint64_t begin = begin_motion(BY_K, 100, three, 3), done = 0;
        for (unsigned holds = 0; holds < 6; holds++) {
            motion_trying("hold %u of run %u", holds, i);
            uint64_t at = (1 + motion_random(400)) * SLOT;
            if (at >= ref_tick(&whole, whole.steps))
                at = ref_tick(&whole, whole.steps) / SLOT * SLOT;
            ref_copy(&stopped, &whole);
            ref_stop(&stopped, at);
            motion_to(&rig, begin + at);
            motion_send(&rig, "K");
            motion_to(&rig, begin + ref_tick(&stopped, stopped.steps) + 50 * SLOT);
            motion_expect(&rig, &stopped, begin, done, 1, 1);
            motion_check(motion_state(&rig) == RKM04_HELD, "not held; %s", motion_what());
            done += stopped.steps;
            begin = (rkm04_now(&rig.unit) + SLOT - 1) / SLOT * SLOT;
            motion_send(&rig, "C75");
            if (!ref_plan_rest(&whole, &stopped))
                break;
        }
        motion_to(&rig, begin + 5000000);
        motion_check(rig.steps == 1000 && rig.position == 1000, "%" PRIu64 " steps; %s", rig.steps, motion_what());
        motion_check(motion_state(&rig) == RKM04_IDLE, "not idle; %s", motion_what());
    }
}
END_TEST

START_TEST(P7_a_held_motion_keeps_its_table)
{
    const struct ref_segment m = {5000, 1000, 2000};
    motion_trying("held");
    uint64_t begin = begin_motion(BY_K, 100, &m, 1);
    motion_to(&rig, begin + 2000000);
    motion_send(&rig, "K");
    motion_to(&rig, begin + 4000000);
    ck_assert_int_eq(motion_state(&rig), RKM04_HELD);
    /* x(2 s) = 247.5 + 1550, and 247.5 steps to stop */
    ck_assert_str_eq(motion_table(&rig), " 4;[(1;100),(248;1000),(1798;1000),(2045;0)]");
    ck_assert_uint_eq(rig.steps, 2045);
}
END_TEST

int main(void)
{
    ref_use_blocks();
    Suite *suite = suite_create("motion_stop");
    TCase *slots = tcase_create("every_slot");
    tcase_add_checked_fixture(slots, setup, teardown);
    tcase_set_timeout(slots, 200);
    tcase_add_test(slots, R5_a_trapezoid_stops_exactly_in_every_slot);
    tcase_add_test(slots, R5_trapezoids_with_fractional_phases_stop_exactly_in_every_slot);
    tcase_add_test(slots, R5_triangles_stop_exactly_in_every_slot);
    tcase_add_test(slots, R5_motions_not_faster_than_S_stop_at_the_next_whole_step);
    tcase_add_test(slots, R5_compounds_stop_exactly_in_every_slot);
    tcase_add_test(slots, R5_random_compounds_stop_exactly_in_every_slot);
    tcase_add_test(slots, R5_endless_motions_stop_exactly_in_every_slot);
    tcase_add_test(slots, R5_a_limit_move_stops_at_the_next_whole_step_or_at_its_input);
    suite_add_tcase(suite, slots);
    TCase *edge = tcase_create("knife_edge");
    tcase_add_checked_fixture(edge, setup, teardown);
    tcase_set_timeout(edge, 200);
    tcase_add_test(edge, R5_a_place_just_above_a_whole_number_adds_a_step_and_a_whole_one_does_not);
    tcase_add_test(edge, R5_an_irrational_place_just_above_a_whole_number_counts_as_that_number);
    tcase_add_test(edge, R5_at_a_speed_up_to_S_an_irrational_place_just_above_a_whole_number_counts_as_that_number);
    tcase_add_test(edge, R5_a_rational_place_just_above_a_whole_number_adds_a_step_in_a_compound);
    tcase_add_test(edge, R5_a_rational_place_less_than_10_to_the_minus_8_above_a_whole_number_adds_a_step);
    suite_add_tcase(suite, edge);
    TCase *hold = tcase_create("hold");
    tcase_add_checked_fixture(hold, setup, teardown);
    tcase_set_timeout(hold, 200);
    tcase_add_test(hold, C3_C75_during_the_ramp_goes_on_after_it_and_a_later_K_cancels_that);
    tcase_add_test(hold, C3_a_motion_held_and_resumed_many_times_makes_all_its_steps);
    tcase_add_test(hold, P7_a_held_motion_keeps_its_table);
    suite_add_tcase(suite, hold);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
