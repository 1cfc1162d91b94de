/* SPDX-License-Identifier: MIT */
/* Single motions from rest, every pulse to the tick (R1, R2, R3, R7, R8). RKM04_TEST_SEED and RKM04_TEST_SCALE give other
 * and more random motions; RKM04_TEST_LONG=1 adds those of minutes. */
#include <stdlib.h>

#include "motion_rig.h"

#define WANTED_MAX 1200
#define EVERY_PULSE 3000 /* motions of up to so many steps are checked pulse by pulse */

static struct motion_rig rig;

/* ---- The reference itself ----------------------------------------------------------------------------------------- */

/* R1 as it is written, in 1024 bits. */
static uint64_t tick_as_written(unsigned s, const struct ref_segment *m, uint64_t k)
{
    enum { A, V, S, DA, TA, PEAK, T, X, Y, NUMBERS };
    mpf_t n[NUMBERS];
    for (int i = 0; i < NUMBERS; i++)
        mpf_init2(n[i], 1024);
    mpf_set_ui(n[A], m->acceleration);
    mpf_set_ui(n[V], m->speed);
    mpf_set_ui(n[S], s);
    mpf_mul(n[PEAK], n[V], n[V]);
    mpf_set_ui(n[X], (unsigned long)s * s);
    mpf_mul_ui(n[Y], n[A], m->steps);
    mpf_add(n[Y], n[Y], n[X]);
    bool triangle = m->speed > s && mpf_cmp(n[Y], n[PEAK]) < 0;
    if (triangle)
        mpf_set(n[PEAK], n[Y]);
    mpf_sub(n[DA], n[PEAK], n[X]); /* d_a = (p^2 - s^2) / 2a */
    mpf_div(n[DA], n[DA], n[A]);
    mpf_div_ui(n[DA], n[DA], 2);
    mpf_sqrt(n[PEAK], n[PEAK]);
    mpf_sub(n[TA], n[PEAK], n[S]); /* t_a = (p - s) / a */
    mpf_div(n[TA], n[TA], n[A]);
    mpf_ui_sub(n[X], m->steps, n[DA]); /* N - d_a */
    if (m->speed <= s) {
        mpf_set_ui(n[T], k);
        mpf_div(n[T], n[T], n[V]);
    } else if (mpf_cmp_ui(n[DA], k) >= 0) {
        mpf_mul_ui(n[T], n[A], 2 * k);
        mpf_set_ui(n[Y], (unsigned long)s * s);
        mpf_add(n[T], n[T], n[Y]);
        mpf_sqrt(n[T], n[T]);
        mpf_sub(n[T], n[T], n[S]);
        mpf_div(n[T], n[T], n[A]);
    } else if (mpf_cmp_ui(n[X], k) >= 0) {
        mpf_ui_sub(n[T], k, n[DA]);
        mpf_div(n[T], n[T], n[V]);
        mpf_add(n[T], n[T], n[TA]);
    } else {
        mpf_sub(n[T], n[X], n[DA]); /* T_end = 2 t_a + (N - 2 d_a) / v */
        mpf_div(n[T], n[T], n[V]);
        mpf_add(n[T], n[T], n[TA]);
        mpf_add(n[T], n[T], n[TA]);
        mpf_mul_ui(n[X], n[A], 2 * (m->steps - k));
        mpf_set_ui(n[Y], (unsigned long)s * s);
        mpf_add(n[X], n[X], n[Y]);
        mpf_sqrt(n[X], n[X]);
        mpf_sub(n[X], n[X], n[S]);
        mpf_div(n[X], n[X], n[A]);
        mpf_sub(n[T], n[T], n[X]);
    }
    mpf_mul_ui(n[T], n[T], 1000000);
    mpf_set_ui(n[X], 1); /* whole ticks stay whole: 10^6 T is algebraic and small, nothing else comes so near */
    mpf_div_2exp(n[X], n[X], 800);
    mpf_sub(n[T], n[T], n[X]);
    mpf_ceil(n[T], n[T]);
    uint64_t tick = mpf_get_ui(n[T]);
    for (int i = 0; i < NUMBERS; i++)
        mpf_clear(n[i]);
    return tick;
}

static struct ref_segment random_motion(unsigned *start_speed, unsigned most_steps)
{
    struct ref_segment m;
    *start_speed = motion_pick(1, 2000);
    m.speed = motion_pick(1, 16000);
    if (motion_random(4) == 0) /* V around S */
        m.speed = *start_speed + (unsigned)motion_random(5) - (*start_speed > 2 ? 2 : 0);
    m.acceleration = motion_pick(1, 60000);
    m.steps = motion_pick(1, most_steps);
    uint64_t just = 0;
    if (m.speed > *start_speed)
        just = ((uint64_t)m.speed * m.speed - (uint64_t)*start_speed * *start_speed) / m.acceleration;
    if (motion_random(4) == 0 && just > 2 && just + 2 < most_steps)
        m.steps = just - 2 + motion_random(5); /* V is just reached, or just not */
    return m;
}

START_TEST(R1_the_reference_decides_as_the_formulas_written_out_in_1024_bits)
{
    struct ref_track track;
    ref_init(&track);
    motion_randomize(1);
    for (unsigned i = 0; i < motion_count(1500); i++) {
        unsigned s;
        struct ref_segment m = random_motion(&s, 16000000);
        motion_trying("motion %u:", i);
        motion_trying_segments(s, &m, 1);
        ref_plan(&track, s, &m, 1);
        uint64_t rising, constant;
        ref_single_phases(s, &m, &rising, &constant);
        const uint64_t middle = (m.steps + 1) / 2, any = 1 + motion_random(m.steps);
        const uint64_t wanted[] = {1, m.steps, middle, rising, rising + 1, constant, constant + 1, any};
        for (unsigned j = 0; j < sizeof wanted / sizeof *wanted; j++) {
            uint64_t k = wanted[j] == 0 ? 1 : wanted[j] < m.steps ? wanted[j] : m.steps, exact = ref_single_tick(s, &m, k);
            motion_check(exact == tick_as_written(s, &m, k), "pulse %" PRIu64 "; %s", k, motion_what());
            motion_check(exact == ref_tick(&track, k), "pulse %" PRIu64 " of the track; %s", k, motion_what());
        }
    }
    ref_clear(&track);
}
END_TEST

START_TEST(R1_the_reference_gives_the_times_of_the_manual)
{
    const struct ref_segment m = {.steps = 5000, .speed = 1000, .acceleration = 2000};
    ck_assert_uint_eq(ref_single_tick(100, &m, 5000), 5405000); /* 0.45 s + 4.505 s + 0.45 s */
    const struct ref_segment short_one = {.steps = 1000, .speed = 3000, .acceleration = 2000};
    ck_assert_uint_eq((ref_single_tick(100, &short_one, 1000) + 50) / 100, 13177); /* 1.3177 s, triangle (4.6) */
}
END_TEST

/* ---- The unit ----------------------------------------------------------------------------------------------------- */

static void expect_pulse(unsigned s, const struct ref_segment *m, uint64_t begin, uint64_t k, uint64_t tick)
{
    uint64_t due = begin + ref_single_tick(s, m, k);
    motion_check(tick == due, "pulse %" PRIu64 " at %" PRIu64 ", expected %" PRIu64 "; %s", k, tick - begin, due - begin,
                 motion_what());
}

/* Add first-3 … first+3, as far as they are pulses and not there yet. */
static size_t want_around(uint64_t *wanted, size_t n, uint64_t steps, uint64_t centre, uint64_t width)
{
    for (uint64_t k = centre > width ? centre - width : 1; k <= centre + width && k <= steps && n < WANTED_MAX; k++)
        wanted[n++] = k;
    return n;
}

static int by_number(const void *a, const void *b)
{
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* First and last ones, all phase borders, some in between; ascending, each once. */
static size_t choose(uint64_t wanted[WANTED_MAX], unsigned s, const struct ref_segment *m)
{
    uint64_t rising, constant;
    ref_single_phases(s, m, &rising, &constant);
    size_t n = want_around(wanted, 0, m->steps, 1, 50), unique = 0;
    n = want_around(wanted, n, m->steps, m->steps, 50);
    n = want_around(wanted, n, m->steps, rising, 10);
    n = want_around(wanted, n, m->steps, constant, 10);
    for (int i = 0; i < 200; i++)
        wanted[n++] = 1 + motion_random(m->steps);
    qsort(wanted, n, sizeof *wanted, by_number);
    for (size_t i = 0; i < n; i++)
        if (unique == 0 || wanted[i] != wanted[unique - 1])
            wanted[unique++] = wanted[i];
    return unique;
}

/* Perform one motion from power-up and compare it with the reference. */
static void try_motion(unsigned s, const struct ref_segment *m, bool back)
{
    static uint64_t wanted[WANTED_MAX];
    motion_start(&rig, 0);
    bool all = m->steps <= EVERY_PULSE;
    size_t count = all ? (size_t)m->steps : choose(wanted, s, m);
    if (!all)
        motion_want(&rig, wanted, count);
    motion_single(&rig, s, m, back);
    uint64_t begin = rig.begin, last = begin + ref_single_tick(s, m, m->steps);
    motion_to(&rig, last + 5000000);
    motion_check(rig.steps == m->steps, "%" PRIu64 " steps; %s", rig.steps, motion_what());
    motion_check(!rig.torn && rig.position == (back ? -(int32_t)m->steps : (int32_t)m->steps), "position %d; %s", rig.position,
                 motion_what());
    motion_check(rig.begin == begin && rig.begins == 1 && rig.ends == 1, "began at %" PRIu64 "; %s", rig.begin, motion_what());
    for (size_t i = 0; i < count; i++)
        expect_pulse(s, m, begin, all ? i + 1 : wanted[i], rig.tick[i]);
    motion_check(rig.last == last, "last pulse at %" PRIu64 "; %s", rig.last, motion_what());
    motion_check(m->steps == 1 || rig.spacing >= 1000000 / m->speed, "pulses %" PRIu64 " ticks apart; %s", rig.spacing,
                 motion_what());
    if (!back)
        motion_check(rig.turns == 1 && rig.turned + 20 <= begin + ref_single_tick(s, m, 1), "turned at %" PRIu64 "; %s",
                     rig.turned, motion_what());
    motion_check(motion_state(&rig) == RKM04_IDLE, "not idle; %s", motion_what());
}

START_TEST(R1_every_pulse_of_short_motions_at_the_corners_of_the_ranges_is_exact)
{
    static const unsigned starts[] = {1, 2, 99, 100, 1999, 2000}, accelerations[] = {1, 2, 7, 1999, 2000, 59999, 60000},
                          steps[] = {1, 2, 3, 4, 5, 16, 99, 100, 101, 255};
    motion_randomize(2);
    for (unsigned i = 0; i < 6; i++) {
        unsigned s = starts[i];
        const unsigned speeds[] = {1, 2, 3, s > 1 ? s - 1 : 1, s, s + 1, s + 2, 100, 1000, 2001, 15999, 16000};
        for (unsigned j = 0; j < 12 * 7 * 10; j++) {
            struct ref_segment m = {.speed = speeds[j / 70], .acceleration = accelerations[j / 10 % 7], .steps = steps[j % 10]};
            motion_trying("corner");
            motion_trying_segments(s, &m, 1);
            try_motion(s, &m, j % 2 == 1);
        }
    }
}
END_TEST

START_TEST(R1_motions_that_just_reach_their_speed_are_exact)
{
    static const unsigned starts[] = {1, 100, 1999, 2000};
    motion_randomize(3);
    for (unsigned i = 0; i < 4; i++)
        for (unsigned speed = 16000; speed > starts[i]; speed = speed > 15998 ? speed - 1 : speed * 2 / 3) {
            uint64_t squares = (uint64_t)speed * speed - (uint64_t)starts[i] * starts[i];
            for (unsigned a = 60000; a > 0; a = a > 59990 ? a - 1 : a / 7)
                for (unsigned more = 0; more < 5 && squares / a + more < 20000; more++) {
                    struct ref_segment m = {squares / a + more - (squares / a > 2 ? 2 : 0), speed, a};
                    if (m.steps == 0)
                        continue;
                    motion_trying("just reached:");
                    motion_trying_segments(starts[i], &m, 1);
                    try_motion(starts[i], &m, false);
                }
        }
}
END_TEST

START_TEST(R2_random_short_motions_are_exact_in_every_pulse)
{
    for (unsigned i = 0; i < motion_count(2000); i++) {
        unsigned s;
        motion_randomize(1000 + i);
        struct ref_segment m = random_motion(&s, motion_random(8) ? 600 : EVERY_PULSE);
        motion_trying("random motion %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, &m, 1);
        try_motion(s, &m, motion_random(2));
    }
}
END_TEST

START_TEST(R2_random_long_motions_are_exact_at_their_ends_and_phase_borders)
{
    for (unsigned i = 0; i < motion_count(200); i++) {
        unsigned s;
        motion_randomize(1000000 + i);
        struct ref_segment m = random_motion(&s, i % 10 == 0 ? 1000000 : 100000);
        motion_trying("long random motion %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, &m, 1);
        try_motion(s, &m, motion_random(2));
    }
}
END_TEST

START_TEST(R2_nothing_grows_over_16000000_steps)
{
    static const struct {
        unsigned s, v, a;
    } longest[] = {{1, 16000, 1},    {2000, 16000, 60000}, {1, 1, 1},   {1999, 15999, 59999}, {100, 15013, 7},
                   {2000, 16000, 1}, {1, 16000, 60000},    {3, 7, 999}, {7, 15991, 17},       {1, 2, 60000}};
    unsigned count = motion_count(4) < 10 ? motion_count(4) : 10;
    motion_randomize(4);
    for (unsigned i = 0; i < count; i++) {
        struct ref_segment m = {.speed = longest[i].v, .acceleration = longest[i].a, .steps = 16000000 - i % 3};
        motion_trying("longest %u:", i);
        motion_trying_segments(longest[i].s, &m, 1);
        try_motion(longest[i].s, &m, i % 2 == 0);
    }
}
END_TEST

/* The way to the ends of the counter takes 147 483 648 steps; the counter is put there instead. */
static void put_counter(int32_t position)
{
    rig.unit.motor[0].position = position;
    rig.position = position;
}

/* From -2147483648 to 2000000000. Most of the way has no listener, unless RKM04_TEST_LONG is set. */
START_TEST(U3_an_absolute_motion_over_4147483648_steps_is_exact)
{
    static uint64_t wanted[WANTED_MAX];
    const struct ref_segment m = {.speed = 16000, .acceleration = 60000, .steps = UINT64_C(4147483648)};
    motion_randomize(5);
    motion_trying("G");
    motion_start(&rig, 0);
    motion_want(&rig, wanted, choose(wanted, 2000, &m));
    motion_send(&rig, "S2000 A60000 V16000");
    motion_to(&rig, 10000);
    put_counter(INT32_MIN);
    motion_send(&rig, "G2000000000");
    uint64_t begin = 10000, last = begin + ref_single_tick(2000, &m, m.steps);
    if (!getenv("RKM04_TEST_LONG")) {
        motion_to(&rig, begin + 10000000);
        motion_listen(&rig, false);
        motion_to(&rig, last - 10000000);
        motion_listen(&rig, true);
    }
    motion_to(&rig, last + 1000000);
    ck_assert_uint_eq(rig.wanted_next, rig.wanted_count);
    for (size_t i = 0; i < rig.wanted_next; i++)
        if (rig.tick[i] != 0)
            expect_pulse(2000, &m, begin, wanted[i], rig.tick[i]);
    ck_assert(!rig.torn);
    ck_assert_uint_eq(rig.steps, m.steps);
    ck_assert_int_eq(rig.position, 2000000000);
    ck_assert_uint_eq(rig.last, last);
}
END_TEST

START_TEST(R2_pulses_are_exact_after_a_time_in_which_nobody_listened)
{
    for (unsigned i = 0; i < motion_count(600); i++) {
        unsigned s;
        motion_randomize(2000000 + i);
        struct ref_segment m = random_motion(&s, i % 2 ? 16000000 : 5000);
        motion_trying("deaf motion %u of seed %" PRIu64 ":", i, motion_seed());
        motion_trying_segments(s, &m, 1);
        motion_start(&rig, 0);
        motion_single(&rig, s, &m, false);
        uint64_t begin = rig.begin, rising, constant;
        uint64_t from = m.steps > 400 ? m.steps - 400 + motion_random(300) : motion_random(m.steps);
        ref_single_phases(s, &m, &rising, &constant);
        if (motion_random(3) == 0 && rising > 0)
            from = rising - 1;
        motion_to(&rig, begin - 1000);
        motion_listen(&rig, false);
        uint64_t listen = begin + (from ? ref_single_tick(s, &m, from) : 0) + 1;
        while (motion_random(4) != 0) /* in several leaps */
            motion_to(&rig, rkm04_now(&rig.unit) + motion_random(listen - rkm04_now(&rig.unit)));
        motion_to(&rig, listen);
        motion_listen(&rig, true);
        uint64_t first = rig.steps + 1, until = first + 300 < m.steps ? first + 300 : m.steps, wanted[301];
        for (uint64_t k = first; k <= until; k++)
            wanted[k - first] = k;
        motion_want(&rig, wanted, until + 1 - first);
        motion_to(&rig, begin + ref_single_tick(s, &m, until) + 1);
        for (uint64_t k = first; k <= until; k++)
            expect_pulse(s, &m, begin, k, rig.tick[k - first]);
        motion_check(rig.steps == until, "%" PRIu64 " steps, expected %" PRIu64 "; %s", rig.steps, until, motion_what());
    }
}
END_TEST

/* ---- R7 ----------------------------------------------------------------------------------------------------------- */

START_TEST(R7_the_direction_is_set_20_us_before_the_first_pulse_and_10_us_after_the_last)
{
    motion_trying("direction");
    motion_start(&rig, 0);
    motion_send(&rig, "S2000 V16000 A60000 L100 F1 R B1 R F7 R D R E");
    uint64_t last = 0, steps = 0;
    unsigned turns = 0;
    for (uint64_t tick = 1; tick < 2000000; tick++) {
        motion_to(&rig, tick);
        if (rig.turns != turns)
            motion_check(last == 0 || rig.turned >= last + 10, "turned %" PRIu64 " ticks after a pulse", rig.turned - last);
        if (rig.steps != steps)
            motion_check(rig.turned + 20 <= rig.last, "pulse %" PRIu64 " ticks after the turn", rig.last - rig.turned);
        turns = rig.turns;
        steps = rig.steps;
        last = rig.last;
    }
    ck_assert_uint_eq(rig.steps, 1600);
    ck_assert_uint_ge(rig.turns, 399);
    ck_assert(!rig.torn);
}
END_TEST

START_TEST(R8_the_counter_wraps_as_two_s_complement)
{
    motion_trying("wrap");
    motion_start(&rig, 0);
    put_counter(INT32_MAX - 2);
    motion_send(&rig, "F5 R B5 R");
    motion_to(&rig, 45000); /* five steps take 41.4 ms */
    ck_assert_uint_eq(rig.steps, 5);
    ck_assert_int_eq(rig.position, INT32_MIN + 2);
    motion_to(&rig, 300000);
    ck_assert_uint_eq(rig.steps, 10);
    ck_assert(!rig.torn);
    ck_assert_int_eq(rig.position, INT32_MAX - 2);
}
END_TEST

int main(void)
{
    ref_use_blocks();
    Suite *suite = suite_create("motion_single");
    TCase *reference = tcase_create("reference");
    tcase_set_timeout(reference, 120);
    tcase_add_test(reference, R1_the_reference_decides_as_the_formulas_written_out_in_1024_bits);
    tcase_add_test(reference, R1_the_reference_gives_the_times_of_the_manual);
    suite_add_tcase(suite, reference);
    TCase *unit = tcase_create("unit");
    tcase_set_timeout(unit, getenv("RKM04_TEST_LONG") ? 3600 : 200);
    tcase_add_test(unit, R1_every_pulse_of_short_motions_at_the_corners_of_the_ranges_is_exact);
    tcase_add_test(unit, R1_motions_that_just_reach_their_speed_are_exact);
    tcase_add_test(unit, R2_random_short_motions_are_exact_in_every_pulse);
    tcase_add_test(unit, R2_random_long_motions_are_exact_at_their_ends_and_phase_borders);
    tcase_add_test(unit, R2_nothing_grows_over_16000000_steps);
    tcase_add_test(unit, U3_an_absolute_motion_over_4147483648_steps_is_exact);
    tcase_add_test(unit, R2_pulses_are_exact_after_a_time_in_which_nobody_listened);
    tcase_add_test(unit, R7_the_direction_is_set_20_us_before_the_first_pulse_and_10_us_after_the_last);
    tcase_add_test(unit, R8_the_counter_wraps_as_two_s_complement);
    suite_add_tcase(suite, unit);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
