/* SPDX-License-Identifier: MIT */
/* Compound motions (R4, P7, C12): every pulse within a tick of the reference, the number of steps exact. RKM04_TEST_SEED and
 * RKM04_TEST_SCALE give other and more random motions. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "motion_rig.h"

static struct motion_rig rig;
static struct ref_track track;

/* The manual's example (7.36). */
static const struct ref_segment manual[] = {{2000, 500, 2000},  {2000, 2000, 2000}, {5000, 500, 2000},
                                            {5000, 3000, 1000}, {2000, 1500, 1000}, {2000, 500, 1000}};
#define MANUAL_SEGMENTS 6

/* What random compounds are made of. */
enum kind { MIXED, TINY, BELOW_S, EQUAL_SPEEDS, UNREACHABLE, EQUAL_SLOPES, KINDS };

static unsigned random_compound(struct ref_segment segment[REF_SEGMENTS], unsigned *start_speed, unsigned most)
{
    unsigned n = 2 + (unsigned)motion_random(REF_SEGMENTS - 1);
    enum kind kind = (enum kind)motion_random(KINDS);
    *start_speed = motion_pick(kind == BELOW_S ? 20 : 1, 2000);
    unsigned a = motion_pick(1, 60000), v = motion_pick(2, 16000);
    for (unsigned i = 0; i < n; i++) {
        enum kind now = kind == MIXED ? (enum kind)(1 + motion_random(KINDS - 1)) : kind;
        segment[i].steps = now == TINY ? 1 + motion_random(4) : motion_pick(1, most);
        segment[i].speed = motion_pick(2, 16000);
        if (now == BELOW_S)
            segment[i].speed = motion_pick(*start_speed / 4 + 2, *start_speed * 3 / 2 + 2);
        else if (now == EQUAL_SPEEDS)
            segment[i].speed = v;
        else if (now == UNREACHABLE)
            segment[i].speed = motion_pick(12000, 16000);
        segment[i].acceleration = now == EQUAL_SLOPES ? a : motion_pick(1, 60000);
    }
    return n;
}

/* Perform the motion from power-up, compare every pulse. */
static void try_compound(unsigned s, const struct ref_segment *segment, unsigned n)
{
    ref_plan(&track, s, segment, n);
    motion_start(&rig, 0);
    uint64_t begin = motion_compound(&rig, s, segment, n), last = begin + ref_tick(&track, track.steps);
    motion_to(&rig, last + 1000000);
    motion_check(rig.begin == begin && rig.begins == 1 && rig.ends == 1, "began at %" PRIu64 "; %s", rig.begin, motion_what());
    motion_expect(&rig, &track, begin, 0, 1, 1);
    motion_check(rig.position == (int32_t)track.steps, "position %d; %s", rig.position, motion_what());
    motion_check(motion_state(&rig) == RKM04_IDLE, "not idle; %s", motion_what());
}

static void setup(void)
{
    ref_init(&track);
}

/* R2 lets pulses be a tick off; after a border they hardly ever are. */
static void teardown(void)
{
    motion_expect_few_off();
    ref_clear(&track);
}

/* ---- The reference itself ----------------------------------------------------------------------------------------- */

START_TEST(R4_the_reference_is_the_fastest_motion_under_the_limits)
{
    for (unsigned i = 0; i < motion_count(1000); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        unsigned s;
        motion_randomize(i);
        unsigned n = random_compound(segment, &s, 2000);
        motion_trying("compound %u:", i);
        motion_trying_segments(s, segment, n);
        ref_plan(&track, s, segment, n);
        for (int j = 0; j < 60; j++) {
            double place = (double)track.steps * (double)motion_random(1u << 30) / (1u << 30);
            double square = ref_square_at(&track, place), limit = ref_limit_at(s, segment, n, place);
            motion_check(fabs(square - limit) <= 1e-6 * limit, "square of the speed %.9g at %.9g, limit %.9g; %s", square, place,
                         limit, motion_what());
        }
    }
}
END_TEST

START_TEST(R4_the_reference_gives_24_469167_s_and_13_points_for_7_36)
{
    char table[1024];
    ref_plan(&track, 100, manual, MANUAL_SEGMENTS);
    ck_assert_uint_eq(track.steps, 18000);
    ck_assert_uint_eq(ref_tick(&track, 18000), 24469167);
    ref_table(&track, table, sizeof table);
    ck_assert_str_eq(table, " 13;[(1;100),(61;500),(2001;500),(2938;2000),(3063;2000),(4001;500),(9001;500),(12001;2500),"
                            "(14001;1500),(15001;1500),(16001;500),(17881;500),(18000;0)]");
}
END_TEST

/* ---- The unit ----------------------------------------------------------------------------------------------------- */

START_TEST(R4_the_manual_s_compound_takes_24_469167_s_for_18000_steps)
{
    motion_trying("7.36");
    motion_start(&rig, 0);
    motion_send(&rig, "S100 A2000 V500 F2000 Y V2000 Y V500 F5000 Y V3000 A1000 Y V1500 F2000 Y V500 Y R");
    motion_to(&rig, 30000000);
    ref_plan(&track, 100, manual, MANUAL_SEGMENTS);
    motion_expect(&rig, &track, 19000, 0, 1, 1);
    ck_assert_uint_eq(rig.steps, 18000);
    ck_assert_uint_eq(rig.begin, 19000);
    ck_assert_uint_ge(rig.last - rig.begin, 24469166);
    ck_assert_uint_le(rig.last - rig.begin, 24469168);
}
END_TEST

START_TEST(P7_the_manual_s_compound_has_13_break_points_from_begin_to_end)
{
    motion_trying("7.36");
    motion_start(&rig, 0);
    uint64_t begin = motion_compound(&rig, 100, manual, MANUAL_SEGMENTS);
    for (uint64_t tick = begin + 1; tick < begin + 24469167; tick += 1234567) {
        motion_to(&rig, tick);
        ck_assert_str_eq(motion_table(&rig), " 13;[(1;100),(61;500),(2001;500),(2938;2000),(3063;2000),(4001;500),(9001;500),"
                                             "(12001;2500),(14001;1500),(15001;1500),(16001;500),(17881;500),(18000;0)]");
    }
    motion_to(&rig, begin + 24469167 + 2000);
    ck_assert_str_eq(motion_table(&rig), " 0;[]");
}
END_TEST

START_TEST(R4_random_compounds_are_within_a_tick_in_every_pulse)
{
    for (unsigned i = 0; i < motion_count(1200); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        unsigned s;
        motion_randomize(i);
        unsigned n = random_compound(segment, &s, i % 16 == 0 ? 3000 : 200);
        motion_trying("compound %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, segment, n);
        try_compound(s, segment, n);
    }
}
END_TEST

START_TEST(R4_a_compound_of_ten_segments_of_one_step_is_within_a_tick)
{
    for (unsigned i = 0; i < motion_count(200); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        motion_randomize(i);
        unsigned s = motion_pick(1, 2000);
        for (unsigned j = 0; j < REF_SEGMENTS; j++)
            segment[j] = (struct ref_segment){1, motion_pick(1, 16000), motion_pick(1, 60000)};
        motion_trying("ten steps %u:", i);
        motion_trying_segments(s, segment, REF_SEGMENTS);
        try_compound(s, segment, REF_SEGMENTS);
    }
}
END_TEST

START_TEST(R4_long_compounds_do_not_drift)
{
    static uint64_t wanted[6000];
    for (unsigned i = 0; i < motion_count(10); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        unsigned s;
        motion_randomize(7000 + i);
        unsigned n = random_compound(segment, &s, 400000);
        motion_trying("long compound %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, segment, n);
        ref_plan(&track, s, segment, n);
        size_t count = 0;
        for (uint64_t k = 1; k <= track.steps; k += 1 + motion_random(track.steps / 2500 + 1))
            wanted[count++] = k;
        motion_start(&rig, 0);
        motion_want(&rig, wanted, count);
        uint64_t begin = motion_compound(&rig, s, segment, n), last = begin + ref_tick(&track, track.steps);
        motion_to(&rig, last + 1000000);
        motion_check(rig.steps == track.steps && !rig.torn, "%" PRIu64 " steps; %s", rig.steps, motion_what());
        for (size_t j = 0; j < count; j++) {
            uint64_t due = begin + ref_tick(&track, wanted[j]);
            motion_check(rig.tick[j] + 1 >= due && rig.tick[j] <= due + 1,
                         "pulse %" PRIu64 " at %" PRIu64 ", expected %" PRIu64 "; %s", wanted[j], rig.tick[j] - begin,
                         due - begin, motion_what());
        }
        motion_check(rig.last + 1 >= last && rig.last <= last + 1, "last pulse at %" PRIu64 "; %s", rig.last, motion_what());
    }
}
END_TEST

START_TEST(R4_a_compound_of_one_segment_is_a_single_motion)
{
    for (unsigned i = 0; i < motion_count(150); i++) {
        motion_randomize(9000 + i);
        struct ref_segment one = {motion_pick(1, 500), motion_pick(1, 16000), motion_pick(1, 60000)};
        unsigned s = motion_pick(1, 2000);
        motion_trying("one segment %u:", i);
        motion_trying_segments(s, &one, 1);
        motion_start(&rig, 0);
        uint64_t begin = motion_compound(&rig, s, &one, 1);
        motion_to(&rig, begin + ref_single_tick(s, &one, one.steps) + 1000000);
        motion_check(rig.steps == one.steps, "%" PRIu64 " steps; %s", rig.steps, motion_what());
        for (uint64_t k = 1; k <= one.steps; k++) {
            uint64_t due = begin + ref_single_tick(s, &one, k);
            motion_check(rig.tick[k - 1] + 1 >= due && rig.tick[k - 1] <= due + 1, "pulse %" PRIu64 " at %" PRIu64 "; %s", k,
                         rig.tick[k - 1] - begin, motion_what());
        }
    }
}
END_TEST

START_TEST(P7_tables_of_random_compounds_name_every_corner)
{
    char table[1024];
    for (unsigned i = 0; i < motion_count(1500); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        unsigned s;
        motion_randomize(20000 + i);
        unsigned n = random_compound(segment, &s, 3000);
        motion_trying("compound %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, segment, n);
        ref_plan(&track, s, segment, n);
        ref_table(&track, table, sizeof table);
        motion_start(&rig, 0);
        uint64_t begin = motion_compound(&rig, s, segment, n), length = ref_tick(&track, track.steps);
        motion_to(&rig, begin + 1 + (i % 4 == 0 ? motion_random(length) : 0));
        const char *answer = motion_table(&rig);
        motion_check(strcmp(answer, table) == 0, "table %s, expected %s; %s", answer, table, motion_what());
    }
}
END_TEST

START_TEST(P7_tables_of_single_motions_name_every_corner)
{
    char table[1024];
    for (unsigned i = 0; i < motion_count(1500); i++) {
        motion_randomize(30000 + i);
        struct ref_segment one = {motion_pick(1, 16000000), motion_pick(1, 16000), motion_pick(1, 60000)};
        unsigned s = motion_pick(1, 2000);
        motion_trying("single %u:", i);
        motion_trying_segments(s, &one, 1);
        ref_plan(&track, s, &one, 1);
        ref_table(&track, table, sizeof table);
        motion_start(&rig, 0);
        motion_single(&rig, s, &one, false);
        motion_to(&rig, rig.begin + 1);
        const char *answer = motion_table(&rig);
        motion_check(strcmp(answer, table) == 0, "table %s, expected %s; %s", answer, table, motion_what());
    }
}
END_TEST

/* ---- C12 ---------------------------------------------------------------------------------------------------------- */

START_TEST(C12_the_output_is_set_at_the_last_pulse_before_the_last_segment)
{
    for (unsigned i = 0; i < motion_count(300); i++) {
        struct ref_segment segment[REF_SEGMENTS];
        unsigned s;
        motion_randomize(40000 + i);
        unsigned n = random_compound(segment, &s, 100);
        motion_trying("outputs %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, segment, n);
        ref_plan(&track, s, segment, n);
        motion_start(&rig, 0);
        motion_send(&rig, "T51 T53 T58");
        motion_to(&rig, 4000);
        uint64_t begin = motion_compound(&rig, s, segment, n), before = track.steps - segment[n - 1].steps;
        motion_to(&rig, begin + ref_tick(&track, track.steps) + 1000000);
        motion_check(rig.outputs == 0x85, "outputs %02x; %s", rig.outputs, motion_what());
        motion_check(rig.outputs_tick == rig.tick[before - 1], "set at %" PRIu64 ", pulse %" PRIu64 " was at %" PRIu64 "; %s",
                     rig.outputs_tick, before, rig.tick[before - 1], motion_what());
        motion_expect(&rig, &track, begin, 0, 1, 1);
    }
}
END_TEST

START_TEST(C12_with_one_segment_the_output_is_set_in_the_slot_of_R)
{
    motion_trying("one segment");
    motion_start(&rig, 0);
    motion_send(&rig, "T52 F100 Y R");
    motion_to(&rig, 1000000);
    ck_assert_uint_eq(rig.outputs, 2);
    ck_assert_uint_eq(rig.outputs_tick, 4000);
    ck_assert_uint_eq(rig.begin, 4000);
}
END_TEST

int main(void)
{
    ref_use_blocks();
    Suite *suite = suite_create("motion_compound");
    TCase *reference = tcase_create("reference");
    tcase_add_checked_fixture(reference, setup, teardown);
    tcase_set_timeout(reference, 120);
    tcase_add_test(reference, R4_the_reference_is_the_fastest_motion_under_the_limits);
    tcase_add_test(reference, R4_the_reference_gives_24_469167_s_and_13_points_for_7_36);
    suite_add_tcase(suite, reference);
    TCase *unit = tcase_create("unit");
    tcase_add_checked_fixture(unit, setup, teardown);
    tcase_set_timeout(unit, 200);
    tcase_add_test(unit, R4_the_manual_s_compound_takes_24_469167_s_for_18000_steps);
    tcase_add_test(unit, P7_the_manual_s_compound_has_13_break_points_from_begin_to_end);
    tcase_add_test(unit, R4_random_compounds_are_within_a_tick_in_every_pulse);
    tcase_add_test(unit, R4_a_compound_of_ten_segments_of_one_step_is_within_a_tick);
    tcase_add_test(unit, R4_long_compounds_do_not_drift);
    tcase_add_test(unit, R4_a_compound_of_one_segment_is_a_single_motion);
    tcase_add_test(unit, P7_tables_of_random_compounds_name_every_corner);
    tcase_add_test(unit, P7_tables_of_single_motions_name_every_corner);
    tcase_add_test(unit, C12_the_output_is_set_at_the_last_pulse_before_the_last_segment);
    tcase_add_test(unit, C12_with_one_segment_the_output_is_set_in_the_slot_of_R);
    suite_add_tcase(suite, unit);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
