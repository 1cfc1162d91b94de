/* SPDX-License-Identifier: MIT */
/* Changes of speed on the run at every slot (C4, R6, R4): every pulse within a tick, the number of steps exact. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion_rig.h"

#define SLOT RKM04_SLOT_TICKS

static struct motion_rig rig, save;
static struct ref_track whole, changed, rest;

static void setup(void)
{
    ref_init(&whole);
    ref_init(&changed);
    ref_init(&rest);
}

static void teardown(void)
{
    ref_clear(&whole);
    ref_clear(&changed);
    ref_clear(&rest);
}

/* Begin a motion of one or more segments, or an endless one; plan it in `whole`. Returns the slot in which it begins. */
static uint64_t begin_motion(unsigned s, const struct ref_segment *segment, unsigned n, uint16_t latency)
{
    char text[80];
    ref_plan(&whole, s, segment, n);
    motion_start(&rig, latency);
    if (n > 1)
        return motion_compound(&rig, s, segment, n);
    if (segment->steps < REF_ENDLESS) {
        motion_single(&rig, s, segment, false);
        return rig.begin;
    }
    snprintf(text, sizeof text, "S%u V%u A%u G+", s, segment->speed, segment->acceleration);
    motion_send(&rig, text);
    return 4 * SLOT;
}

/* Send `V…` some ticks before this slot, or just in it, and be in front of the slot's other ticks. */
static void send_speed(unsigned speed, uint64_t slot)
{
    char text[16];
    uint64_t early = motion_random(3) == 0 ? motion_random(SLOT) : 0, now = rkm04_now(&rig.unit);
    motion_to(&rig, slot - early > now ? slot - early : now);
    snprintf(text, sizeof text, "V%u", speed);
    motion_send(&rig, text);
}

/* The unit is to follow `changed` to its end, or for 0.3 s; look from pulse `from` on. */
static void expect_changed(uint64_t begin, uint64_t at, uint64_t from)
{
    if (changed.steps >= REF_ENDLESS) {
        changed.steps = ref_steps_at(&changed, at + 300 * SLOT);
        uint64_t last = changed.steps ? ref_tick(&changed, changed.steps) : 0;
        motion_to(&rig, begin + (last > at ? last : at) + 3);
    } else {
        motion_to(&rig, begin + ref_tick(&changed, changed.steps) + 100 * SLOT);
        motion_check(motion_state(&rig) == RKM04_IDLE && rig.ends == 1, "not idle; %s", motion_what());
    }
    motion_expect(&rig, &changed, begin, 0, from > 3 ? from - 3 : 1, 1);
}

/* Change to each of the speeds at every `step`-th slot of a motion. */
static void change_everywhere(unsigned s, const struct ref_segment *segment, unsigned n, const unsigned *speeds, unsigned step)
{
    static char table[1024];
    uint64_t begin = begin_motion(s, segment, n, 0);
    for (unsigned slot = 1; slot < 2500; slot += step) {
        uint64_t at = slot * SLOT;
        if (whole.steps < REF_ENDLESS ? at >= ref_tick(&whole, whole.steps) : slot > 700)
            break;
        motion_to(&rig, begin + at - SLOT + 1);
        save = rig;
        for (const unsigned *speed = speeds; *speed; speed++) {
            motion_trying("V%u in slot %u of", *speed, slot);
            motion_trying_segments(s, segment, n);
            ref_copy(&changed, &whole);
            ref_change(&changed, at, *speed);
            send_speed(*speed, begin + at);
            motion_to(&rig, begin + at + 1);
            if (!ref_on_final_ramp(&whole, at)) {
                ref_table(&changed, table, sizeof table);
                const char *answer = motion_table(&rig);
                motion_check(strcmp(answer, table) == 0, "table %s, expected %s; %s", answer, table, motion_what());
            }
            expect_changed(begin, at, ref_steps_at(&whole, at));
            rig = save;
        }
    }
}

START_TEST(C4_a_trapezoid_takes_a_new_speed_in_every_slot)
{
    const struct ref_segment m = {900, 1000, 2000};
    change_everywhere(100, &m, 1, (const unsigned[]){1, 50, 99, 100, 101, 500, 999, 1000, 1001, 1500, 16000, 0}, 5);
}
END_TEST

START_TEST(C4_a_triangle_takes_a_new_speed_in_every_slot)
{
    const struct ref_segment m[] = {{400, 16000, 2000}, {301, 3000, 7919}};
    change_everywhere(100, &m[0], 1, (const unsigned[]){3, 100, 333, 700, 901, 0}, 2);
    change_everywhere(7, &m[1], 1, (const unsigned[]){7, 8, 333, 700, 1501, 0}, 1);
}
END_TEST

START_TEST(C4_a_motion_not_faster_than_S_takes_a_new_speed_in_every_slot)
{
    const struct ref_segment m[] = {{30, 70, 2000}, {60, 100, 3001}};
    change_everywhere(100, &m[0], 1, (const unsigned[]){1, 69, 71, 100, 101, 700, 16000, 0}, 1);
    change_everywhere(100, &m[1], 1, (const unsigned[]){1, 69, 71, 100, 101, 700, 16000, 0}, 1);
}
END_TEST

START_TEST(C4_an_endless_motion_takes_a_new_speed_in_every_slot)
{
    const struct ref_segment m[] = {{REF_ENDLESS, 1000, 2000}, {REF_ENDLESS, 70, 999}};
    change_everywhere(100, &m[0], 1, (const unsigned[]){1, 100, 101, 999, 3000, 0}, 7);
    change_everywhere(100, &m[1], 1, (const unsigned[]){1, 71, 100, 101, 3000, 0}, 7);
}
END_TEST

START_TEST(C4_a_compound_is_planned_anew_in_every_slot)
{
    const struct ref_segment ups[] = {{100, 500, 2000}, {200, 2000, 6000}, {150, 300, 4000}, {100, 1000, 3001}};
    const struct ref_segment steps[] = {{20, 500, 1000}, {1, 700, 60000}, {1, 300, 70}, {50, 900, 2999}, {1, 2000, 5000}};
    change_everywhere(100, ups, 4, (const unsigned[]){100, 150, 400, 800, 2500, 16000, 0}, 3);
    change_everywhere(10, steps, 5, (const unsigned[]){100, 400, 800, 16000, 0}, 1);
}
END_TEST

START_TEST(C4_a_compound_around_S_is_planned_anew_in_every_slot)
{
    const struct ref_segment slow[] = {{30, 60, 2000}, {100, 900, 1500}, {40, 50, 3000}, {20, 80, 500}};
    change_everywhere(100, slow, 4, (const unsigned[]){1, 55, 99, 101, 300, 2500, 0}, 3);
}
END_TEST

START_TEST(C4_random_compounds_are_planned_anew)
{
    for (unsigned i = 0; i < motion_count(30); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        motion_randomize(i);
        unsigned n = 2 + (unsigned)motion_random(REF_SEGMENTS - 1), s = motion_pick(1, 2000);
        for (unsigned j = 0; j < n; j++)
            segment[j] = (struct ref_segment){motion_pick(1, 300), motion_pick(2, 16000), motion_pick(10, 60000)};
        const unsigned speeds[] = {motion_pick(1, 16000), motion_pick(1, 16000), motion_pick(1, 2000), 0};
        change_everywhere(s, segment, n, speeds, 1 + (unsigned)motion_random(20));
    }
}
END_TEST

/* ---- Many changes, stops, resumes ----------------------------------------------------------------------------------- */

/* Changes at random slots to multiples of a speed; returns the tick, since the begin, of the last one. */
static uint64_t change_often(uint64_t begin, unsigned times, unsigned multiple)
{
    uint64_t at = 0, next;
    while (times-- > 0) {
        next = at + (1 + motion_random(motion_random(2) ? 3 : 150)) * SLOT;
        if (changed.steps < REF_ENDLESS && next >= ref_tick(&changed, changed.steps))
            break;
        unsigned speed = motion_pick(1, 6000 / multiple) * multiple;
        motion_to(&rig, begin + at + 1);
        send_speed(speed, begin + next);
        motion_to(&rig, begin + next + 1);
        ref_change(&changed, next, speed);
        at = next;
    }
    return at;
}

START_TEST(C4_many_changes_in_one_motion_leave_its_steps_exact)
{
    for (unsigned i = 0; i < motion_count(400); i++) {
        motion_randomize(i);
        struct ref_segment m = {motion_pick(200, 3000), motion_pick(1, 3000), motion_pick(10, 60000)};
        unsigned s = motion_pick(1, 2000);
        if (i % 5 == 0)
            m.steps = REF_ENDLESS;
        motion_trying("many changes %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, &m, 1);
        uint64_t begin = begin_motion(s, &m, 1, 0);
        ref_copy(&changed, &whole);
        uint64_t at = change_often(begin, 12, 1);
        expect_changed(begin, at, 1);
    }
}
END_TEST

START_TEST(R5_a_motion_whose_speed_was_changed_stops_exactly_and_resumes_with_that_speed)
{
    unsigned near = 0;
    for (unsigned i = 0; i < motion_count(1500); i++) {
        motion_randomize(i);
        struct ref_segment m = {motion_pick(200, 3000), motion_pick(1, 3000), motion_pick(10, 60000)};
        unsigned s = motion_pick(1, 2000);
        if (i % 2 == 0) { /* round numbers make whole places */
            m = (struct ref_segment){m.steps, 250 * (m.speed / 250 + 1), 500 * (m.acceleration / 501 + 1)};
            s = 50 * (s / 200 + 1);
        }
        if (i % 3 == 0)
            m.steps = REF_ENDLESS;
        motion_trying("changes and a stop %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, &m, 1);
        uint64_t begin = begin_motion(s, &m, 1, 0);
        ref_copy(&changed, &whole);
        uint64_t at = change_often(begin, 1 + (unsigned)motion_random(3), i % 2 ? 1 : 50) + (1 + motion_random(100)) * SLOT;
        if (changed.steps < REF_ENDLESS && at >= ref_tick(&changed, changed.steps))
            continue;
        motion_to(&rig, begin + at);
        motion_send(&rig, "K");
        ref_stop(&changed, at);
        near += changed.edge != REF_EDGE_NONE;
        motion_to(&rig, begin + (changed.steps ? ref_tick(&changed, changed.steps) : 0) + at + 100 * SLOT);
        motion_expect(&rig, &changed, begin, 0, 1, 1);
        motion_check(motion_state(&rig) == RKM04_HELD, "not held; %s", motion_what());
        uint64_t slot = (rkm04_now(&rig.unit) + SLOT - 1) / SLOT * SLOT;
        motion_send(&rig, "C75");
        if (!ref_plan_rest(&rest, &changed))
            continue;
        if (rest.steps >= REF_ENDLESS)
            rest.steps = ref_steps_at(&rest, 300 * SLOT);
        motion_to(&rig, slot + (m.steps < REF_ENDLESS ? ref_tick(&rest, rest.steps) + 50 * SLOT : 300 * SLOT + 1));
        motion_expect(&rig, &rest, slot, changed.steps, 1, 1);
    }
    ck_assert_uint_ge(near, motion_count(1500) / 300); /* whole numbers of steps do occur */
}
END_TEST

/* An endless motion changes its speed in slot `from`, and is stopped by K in every slot after it. Returns how many of the
 * stops were at a whole number of steps. */
static unsigned stop_everywhere_after(unsigned s, const struct ref_segment *m, unsigned from, unsigned speed, unsigned slots)
{
    unsigned at_whole = 0;
    uint64_t begin = begin_motion(s, m, 1, 0);
    send_speed(speed, begin + from * SLOT);
    motion_to(&rig, begin + from * SLOT + 1);
    ref_change(&whole, from * SLOT, speed);
    for (unsigned slot = from + 1; slot < from + slots; slot++) {
        motion_trying("V%u in slot %u, K in slot %u of", speed, from, slot);
        motion_trying_segments(s, m, 1);
        motion_to(&rig, begin + slot * SLOT);
        save = rig;
        motion_send(&rig, "K");
        ref_copy(&changed, &whole);
        ref_stop(&changed, slot * SLOT);
        at_whole += changed.edge == REF_EDGE_WHOLE;
        uint64_t before = ref_steps_at(&whole, slot * SLOT), last = changed.steps ? ref_tick(&changed, changed.steps) : 0;
        motion_to(&rig, begin + slot * SLOT + last + 2 * SLOT);
        motion_expect(&rig, &changed, begin, 0, before > 3 ? before - 3 : 1, 1);
        motion_check(motion_state(&rig) == RKM04_HELD, "not held; %s", motion_what());
        rig = save;
    }
    return at_whole;
}

START_TEST(R5_after_a_change_a_motion_stops_exactly_in_every_slot)
{
    unsigned at_whole = 0;
    const struct ref_segment even = {REF_ENDLESS, 1000, 2000}, thirds = {REF_ENDLESS, 3250, 60000};
    const struct ref_segment odd = {REF_ENDLESS, 1501, 7919};
    motion_randomize(5);
    at_whole += stop_everywhere_after(100, &even, 500, 100, 700); /* to S, below it, above it */
    at_whole += stop_everywhere_after(100, &even, 500, 50, 700);
    at_whole += stop_everywhere_after(100, &even, 310, 400, 500);
    at_whole += stop_everywhere_after(50, &thirds, 60, 50, 300);
    at_whole += stop_everywhere_after(50, &thirds, 23, 25, 300);
    at_whole += stop_everywhere_after(70, &odd, 90, 70, 400);
    at_whole += stop_everywhere_after(70, &odd, 300, 2501, 400);
    ck_assert_uint_ge(at_whole, 100);
}
END_TEST

/* At constant speed V2, after a change from V1 at slot n1, x' is a multiple of 1/1000A again: find those just above a whole
 * number. */
START_TEST(R5_after_a_change_a_place_just_above_a_whole_number_adds_a_step)
{
    unsigned met[4] = {0};
    motion_randomize(3);
    while (met[REF_EDGE_RATIONAL] < motion_count(150) || met[REF_EDGE_WHOLE] < motion_count(50)) {
        int64_t s = motion_pick(1, 2000), v1 = s + 1 + (int64_t)motion_random(2000), v2 = s + 1 + (int64_t)motion_random(4000);
        int64_t a = motion_pick(300, 60000), n1 = (v1 - s) * 1000 / a + 2 + (int64_t)motion_random(50);
        int64_t apart = v2 > v1 ? v2 - v1 : v1 - v2, sign = v2 > v1 ? 1 : -1, n = n1 + apart * 1000 / a + 2, unit = 2000 * a;
        if (n > 3000 || v2 == v1)
            continue;
        /* 2000 A x' = … at slot n: rise to v1, constant, ramp to v2, constant, fall to s */
        int64_t sum = 1000 * (v1 * v1 - s * s) + 2 * v1 * (a * n1 - 1000 * (v1 - s)) + 1000 * sign * (v2 * v2 - v1 * v1) +
                      2 * v2 * (a * (n - n1) - 1000 * apart) + 1000 * (v2 * v2 - s * s);
        if (sum % (2 * a) * 500 >= a) /* what further slots add is a multiple of 2A */
            continue;
        int64_t slot = n;
        while (slot < n + 1000 && sum % unit * 1000000 / unit != 0) {
            sum += 2 * v2 * a;
            slot++;
        }
        if (slot == n + 1000 || met[sum % unit ? REF_EDGE_RATIONAL : REF_EDGE_WHOLE] > motion_count(150))
            continue;
        const struct ref_segment m = {REF_ENDLESS, (unsigned)v1, (unsigned)a};
        motion_trying("V%d in slot %d, K in slot %d of", (int)v2, (int)n1, (int)slot);
        motion_trying_segments((unsigned)s, &m, 1);
        uint64_t begin = begin_motion((unsigned)s, &m, 1, 0);
        send_speed((unsigned)v2, begin + (uint64_t)n1 * SLOT);
        motion_to(&rig, begin + (uint64_t)slot * SLOT);
        motion_send(&rig, "K");
        ref_copy(&changed, &whole);
        ref_change(&changed, (uint64_t)n1 * SLOT, (unsigned)v2);
        ref_stop(&changed, (uint64_t)slot * SLOT);
        met[changed.edge]++;
        enum ref_edge expected = sum % unit ? REF_EDGE_RATIONAL : REF_EDGE_WHOLE;
        motion_check(changed.edge == expected, "edge %d; %s", (int)changed.edge, motion_what());
        motion_to(&rig, begin + ref_tick(&changed, changed.steps) + 10 * SLOT);
        motion_expect(&rig, &changed, begin, 0, changed.steps > 20 ? changed.steps - 20 : 1, 1);
    }
}
END_TEST

/* ---- When it acts --------------------------------------------------------------------------------------------------- */

START_TEST(C4_with_a_latency_the_first_deadline_counts_and_the_last_value_wins)
{
    const struct ref_segment m = {1500, 1000, 2000};
    for (unsigned latency = 0; latency <= 2000; latency += 1 + latency / 2) {
        motion_trying("latency %u ms", latency);
        uint64_t begin = begin_motion(100, &m, 1, (uint16_t)latency), sent = begin + 123456, at;
        motion_to(&rig, sent);
        motion_send(&rig, "V300");
        at = (sent + latency * 1000 + SLOT - 1) / SLOT * SLOT - begin;
        ref_copy(&changed, &whole);
        if (latency >= 2) {
            motion_to(&rig, sent + latency * 500);
            motion_send(&rig, " {again} V700");
            ref_change(&changed, at, 700);
        } else {
            ref_change(&changed, at, 300);
        }
        expect_changed(begin, at, 1);
    }
}
END_TEST

START_TEST(C4_K_drops_a_pending_change)
{
    const struct ref_segment m = {1500, 1000, 2000};
    motion_trying("V, then K before it acts");
    uint64_t begin = begin_motion(100, &m, 1, 500);
    motion_to(&rig, begin + 600000);
    motion_send(&rig, "V300");
    motion_to(&rig, begin + 800000);
    motion_send(&rig, "K");
    ref_copy(&changed, &whole);
    ref_stop(&changed, 800000);
    motion_to(&rig, begin + 2000000);
    motion_expect(&rig, &changed, begin, 0, 1, 1);
    motion_send(&rig, "C75");
    ck_assert(ref_plan_rest(&rest, &changed));
    motion_to(&rig, begin + 5000000);
    motion_expect(&rig, &rest, begin + 2000000, changed.steps, 1, 1);
}
END_TEST

START_TEST(C4_the_parameter_V_stays_as_it_was)
{
    const struct ref_segment m = {1500, 1000, 2000};
    motion_trying("V, then a second R");
    uint64_t begin = begin_motion(100, &m, 1, 0);
    motion_to(&rig, begin + 600000);
    motion_send(&rig, "V300");
    motion_to(&rig, begin + 10000000);
    ck_assert_uint_eq(rig.steps, 1500);
    motion_send(&rig, "R");
    motion_to(&rig, begin + 20000000);
    motion_expect(&rig, &whole, begin + 10000000, 1500, 1, 0);
}
END_TEST

START_TEST(C12_a_change_does_not_move_the_output_away_from_its_pulse)
{
    const struct ref_segment three[] = {{300, 700, 3000}, {500, 1500, 2500}, {200, 400, 9001}};
    for (unsigned slot = 5; slot < 700; slot += 13) {
        motion_trying("output, V900 in slot %u", slot);
        motion_start(&rig, 0);
        ref_plan(&whole, 100, three, 3);
        motion_send(&rig, "T55");
        motion_to(&rig, 2000);
        uint64_t begin = motion_compound(&rig, 100, three, 3);
        ref_copy(&changed, &whole);
        ref_change(&changed, slot * SLOT, 900);
        send_speed(900, begin + slot * SLOT);
        expect_changed(begin, slot * SLOT, 1);
        motion_check(rig.outputs == 0x10 && rig.outputs_tick == rig.tick[799], "outputs %02x at %" PRIu64 "; %s", rig.outputs,
                     rig.outputs_tick, motion_what());
    }
}
END_TEST

int main(void)
{
    ref_use_blocks();
    Suite *suite = suite_create("motion_change");
    TCase *slots = tcase_create("every_slot");
    tcase_add_checked_fixture(slots, setup, teardown);
    tcase_set_timeout(slots, 200);
    tcase_add_test(slots, C4_a_trapezoid_takes_a_new_speed_in_every_slot);
    tcase_add_test(slots, C4_a_triangle_takes_a_new_speed_in_every_slot);
    tcase_add_test(slots, C4_a_motion_not_faster_than_S_takes_a_new_speed_in_every_slot);
    tcase_add_test(slots, C4_an_endless_motion_takes_a_new_speed_in_every_slot);
    tcase_add_test(slots, C4_a_compound_is_planned_anew_in_every_slot);
    tcase_add_test(slots, C4_a_compound_around_S_is_planned_anew_in_every_slot);
    tcase_add_test(slots, C4_random_compounds_are_planned_anew);
    suite_add_tcase(suite, slots);
    TCase *many = tcase_create("many");
    tcase_add_checked_fixture(many, setup, teardown);
    tcase_set_timeout(many, 200);
    tcase_add_test(many, C4_many_changes_in_one_motion_leave_its_steps_exact);
    tcase_add_test(many, R5_a_motion_whose_speed_was_changed_stops_exactly_and_resumes_with_that_speed);
    tcase_add_test(many, R5_after_a_change_a_motion_stops_exactly_in_every_slot);
    tcase_add_test(many, R5_after_a_change_a_place_just_above_a_whole_number_adds_a_step);
    suite_add_tcase(suite, many);
    TCase *when = tcase_create("when");
    tcase_add_checked_fixture(when, setup, teardown);
    tcase_set_timeout(when, 200);
    tcase_add_test(when, C4_with_a_latency_the_first_deadline_counts_and_the_last_value_wins);
    tcase_add_test(when, C4_K_drops_a_pending_change);
    tcase_add_test(when, C4_the_parameter_V_stays_as_it_was);
    tcase_add_test(when, C12_a_change_does_not_move_the_output_away_from_its_pulse);
    suite_add_tcase(suite, when);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
