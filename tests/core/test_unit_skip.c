/* SPDX-License-Identifier: MIT */
/* Pulses that no watcher sees one by one are passed over (K3: the same positions at the same ticks, motions that end at the same
 * tick), at a cost that does not depend on their number. */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

static struct rkm04_unit seen, unseen;
static uint64_t pulses;

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)tick, (void)motor, (void)position;
    pulses++;
}

static const struct rkm04_port with_sink = {.step = on_step}, without_sink = {.step = NULL};

static uint32_t seed;

static uint32_t any(uint32_t low, uint32_t high)
{
    seed = seed * 1664525u + 1013904223u;
    return low + (uint32_t)((uint64_t)(seed >> 8) * (high - low + 1) >> 24);
}

static void power_up(void)
{
    const struct rkm04_config config = {.node = 1};
    rkm04_init(&seen, &config, &with_sink, NULL);
    rkm04_init(&unseen, &config, &without_sink, NULL);
    pulses = 0;
}

static void both_set(const char *text)
{
    ck_assert_int_eq(rkm04_set_command(&seen, '1', text, strlen(text), NULL), 0);
    ck_assert_int_eq(rkm04_set_command(&unseen, '1', text, strlen(text), NULL), 0);
}

static void both_are_equal(void)
{
    struct rkm04_motor_state a, b;
    rkm04_motor_state(&seen, 1, &a);
    rkm04_motor_state(&unseen, 1, &b);
    ck_assert_int_eq(a.position, b.position);
    ck_assert_uint_eq(a.steps, b.steps);
    ck_assert_uint_eq(a.speed, b.speed);
    ck_assert_int_eq(a.state, b.state);
    ck_assert_uint_eq(a.index, b.index);
    ck_assert_uint_eq(rkm04_next_event(&seen), rkm04_next_event(&unseen));
    ck_assert_uint_eq(rkm04_outputs(&seen), rkm04_outputs(&unseen));
}

static void both_advance(uint64_t ticks)
{
    rkm04_advance(&seen, ticks);
    rkm04_advance(&unseen, ticks);
    both_are_equal();
}

/* A program of one motion: single, compound with an output at its last segment, or endless. */
static void set_random_motion(void)
{
    char text[600];
    int length = sprintf(text, "\\ T53 S%u ", any(1, 2000));
    unsigned kind = any(0, 3), segments = kind == 1 ? any(2, 10) : 1;
    for (unsigned i = 0; i < segments; i++)
        length += sprintf(text + length, "V%u A%u F%u %s", any(1, 16000), any(1, any(0, 1) ? 60000 : 200), any(1, 60000),
                          kind == 1 ? "Y " : "");
    strcpy(text + length, kind == 2 ? "G-" : "R");
    both_set(text);
}

START_TEST(K3_pulses_nobody_sees_lead_to_the_same_positions_at_the_same_ticks)
{
    seed = (uint32_t)_i + 1;
    power_up();
    for (unsigned n = 0; n < 10; n++) {
        set_random_motion();
        for (unsigned i = 0; i < 12; i++) {
            both_advance(any(0, 1) ? any(1, 3000) : any(1, 4000000));
            if (any(0, 5) == 0)
                both_set(any(0, 1) ? "K" : "C75");
            char speed[16];
            sprintf(speed, "V%u", any(1, 16000));
            if (any(0, 5) == 0)
                both_set(speed);
        }
    }
    ck_assert_uint_gt(pulses, 0);
}
END_TEST

START_TEST(R7_the_last_pulse_counts_although_nobody_saw_it)
{
    /* 66.2 us from pulse to pulse: in some of these slots the last one is less than 10 us ago. */
    for (uint64_t slot = 400000; slot < 440000; slot += RKM04_SLOT_TICKS) {
        power_up();
        both_set("\\ S2000 V15100 A60000 G+");
        both_advance(slot);
        both_set("\\ T01");
        both_advance(1);
        both_advance(RKM04_SLOT_TICKS);
        ck_assert_uint_eq(rkm04_outputs(&unseen), 1);
    }
}
END_TEST

START_TEST(U3_the_longest_motion_ends_at_the_tick_of_its_closed_form_without_a_sink)
{
    /* 4 000 000 000 steps of one second each: 126 years. G is the fourth command: it begins at tick 4000. */
    const uint64_t steps = UINT64_C(4000000000);
    struct rkm04_motor_state state;
    power_up();
    rkm04_set_command(&unseen, '1', "S1 V1 =-2000000000 G2000000000", 30, NULL);
    rkm04_advance(&unseen, 4001 + steps * 1000000 - 1);
    rkm04_motor_state(&unseen, 1, &state);
    ck_assert_int_eq(state.position, 1999999999); /* the last pulse is due at the tick that comes now */
    ck_assert_int_eq(state.state, RKM04_MOVING);
    rkm04_advance(&unseen, 1);
    rkm04_motor_state(&unseen, 1, &state);
    ck_assert_int_eq(state.position, 2000000000);
    ck_assert_int_ne(state.state, RKM04_MOVING);
}
END_TEST

START_TEST(P9_an_endless_motion_goes_on_past_2_to_the_32_steps)
{
    /* 2000 steps/s at once, for 25 days. G+ is the third command: it begins at tick 3000. */
    const uint64_t minute = 60 * UINT64_C(1000000), steps_a_minute = 60 * 2000;
    const uint64_t minutes = (UINT64_C(1) << 32) / steps_a_minute + 2;
    struct rkm04_motor_state state;
    power_up();
    rkm04_set_command(&unseen, '1', "S2000 V2000 G+", 14, NULL);
    rkm04_advance(&unseen, 3001);
    for (uint64_t i = 1; i <= minutes; i++) {
        rkm04_advance(&unseen, minute);
        rkm04_motor_state(&unseen, 1, &state);
        ck_assert_int_eq(state.state, RKM04_MOVING);
        ck_assert_uint_eq(state.steps, (uint32_t)(i * steps_a_minute));
        ck_assert_uint_eq((uint32_t)state.position, (uint32_t)(i * steps_a_minute));
    }
    ck_assert_uint_eq(state.speed, 2000);
}
END_TEST

/* A motion of constant speed through two segments, the first of `first` steps: its last pulse sets DO 1 (C12). */
static void two_segments(unsigned first, uint64_t due)
{
    char text[100];
    power_up();
    sprintf(text, "T51 S1000 V1000 F%u Y F90000 Y R", first);
    both_set(text);
    both_advance(due);
    ck_assert_uint_eq(rkm04_outputs(&unseen), 0);
    both_advance(1);
    ck_assert_uint_eq(rkm04_outputs(&unseen), 1);
    power_up();
    both_set(text);
    both_advance(100 * UINT64_C(1000000)); /* in one leap */
    ck_assert_uint_eq(rkm04_outputs(&unseen), 1);
}

START_TEST(C12_an_output_comes_on_at_its_pulse_however_many_are_passed_over)
{
    two_segments(30, 8000 + 30 * 1000); /* R is the eighth command: it begins at tick 8000 */
    two_segments(3000, 8000 + 3000 * 1000);
    two_segments(64, 8000 + 64 * 1000);
    two_segments(65, 8000 + 65 * 1000);
    two_segments(66, 8000 + 66 * 1000);
}
END_TEST

/* ---- From report to report ------------------------------------------------------------------------------------------ */

struct reports {
    uint64_t count, digest, last;
};

static void on_report(void *context, uint64_t tick, unsigned motor, enum rkm04_event what, uint32_t value)
{
    struct reports *reports = context;
    reports->count++;
    reports->last = tick;
    reports->digest = (reports->digest ^ tick ^ (uint64_t)motor << 60 ^ (uint64_t)what << 50 ^ (uint64_t)value << 20) *
                      UINT64_C(0x100000001b3);
}

static void on_outputs(void *context, uint64_t tick, uint8_t mask)
{
    on_report(context, tick, 5, 0, mask);
}

static const struct rkm04_port reporting = {.event = on_report, .outputs = on_outputs};

/* One unit to `end` in one call, another one from report to report: nothing is reported before it is due, and the same in all.
 * Returns the number of calls. */
static unsigned from_report_to_report(const char *text, uint64_t end)
{
    const struct rkm04_config config = {.node = 1};
    struct reports whole = {0}, pieces = {0};
    unsigned calls = 0;
    rkm04_init(&seen, &config, &reporting, &whole);
    rkm04_init(&unseen, &config, &reporting, &pieces);
    both_set(text);
    rkm04_advance(&seen, end);
    for (uint64_t now; (now = rkm04_now(&unseen)) < end; calls++) {
        uint64_t report = rkm04_next_report(&unseen), count = pieces.count;
        ck_assert_uint_ge(report, rkm04_next_event(&unseen));
        report = report < end ? report : end;
        rkm04_advance(&unseen, report - now);
        ck_assert_msg(pieces.count == count, "%s: reported at %lu, before %lu", text, pieces.last, report);
        rkm04_advance(&unseen, report < end);
    }
    ck_assert_msg(whole.digest == pieces.digest && whole.count == pieces.count, "%s: not the same reports", text);
    ck_assert_int_eq(seen.motor[0].position, unseen.motor[0].position);
    return calls;
}

START_TEST(K3_nothing_is_reported_before_the_next_report)
{
    char text[400];
    seed = (uint32_t)_i + 77;
    int length = sprintf(text, "\\ T53 S%u ", any(1, 2000));
    for (uint32_t segments = any(1, 6); segments > 0; segments--)
        length += sprintf(text + length, "V%u A%u F%u Y ", any(1, 16000), any(1, any(0, 1) ? 60000 : 50), any(1, 30000));
    sprintf(text + length, "R W7 C53 B%u R )3", any(1, 3000));
    from_report_to_report(text, 100 * UINT64_C(1000000));
}
END_TEST

/* Where a segment ends amid a leg, of constant speed or not, its last pulse is no end of a leg. */
START_TEST(K3_C12_an_output_amid_a_leg_is_a_report_of_its_own)
{
    static const char *const texts[] = {
        "\\ T51 S1000 V1000 F3000 Y F90000 Y R", "\\ T51 S100 V16000 A100 F3000 Y F9000 Y R",
        "\\ T51 S100 V9000 A500 F30000 Y F2000 Y R", "\\ T51 S1 V16000 A1 F300 Y F4000 Y R"};
    from_report_to_report(texts[_i], 150 * UINT64_C(1000000));
    ck_assert_uint_eq(rkm04_outputs(&unseen), 1);
}
END_TEST

START_TEST(K3_a_long_motion_that_nobody_sees_is_done_in_few_reports)
{
    const uint64_t second = 1000000;
    ck_assert_uint_lt(from_report_to_report("\\ S1 V16000 A1 G+", 100000 * second), 10);
    ck_assert_uint_lt(from_report_to_report("\\ S100 V16000 A20000 F16000000 YYYYYYYYYY R", 11000 * second), 27);
    ck_assert_uint_lt(from_report_to_report("\\ T55 S100 V16000 A20000 F16000000 YYYY V100 Y R", 170000 * second), 35);
}
END_TEST

START_TEST(P9_K3_an_endless_motion_at_its_speed_has_nothing_more_to_report)
{
    const struct rkm04_config config = {.node = 1};
    struct reports none = {0};
    rkm04_init(&unseen, &config, &reporting, &none);
    rkm04_init(&seen, &config, &reporting, &none);
    both_set("\\ S1 V16000 A60000 G+");
    rkm04_advance(&unseen, 1000000);
    ck_assert_uint_gt(rkm04_next_report(&unseen), RKM04_NEVER / 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("unit_skip");
    TCase *one = tcase_create("pulses that nobody sees");
    tcase_set_timeout(one, 200);
    tcase_add_loop_test(one, K3_pulses_nobody_sees_lead_to_the_same_positions_at_the_same_ticks, 0, 40);
    tcase_add_test(one, R7_the_last_pulse_counts_although_nobody_saw_it);
    tcase_add_test(one, U3_the_longest_motion_ends_at_the_tick_of_its_closed_form_without_a_sink);
    tcase_add_test(one, P9_an_endless_motion_goes_on_past_2_to_the_32_steps);
    tcase_add_test(one, C12_an_output_comes_on_at_its_pulse_however_many_are_passed_over);
    tcase_add_loop_test(one, K3_nothing_is_reported_before_the_next_report, 0, 300);
    tcase_add_loop_test(one, K3_C12_an_output_amid_a_leg_is_a_report_of_its_own, 0, 4);
    tcase_add_test(one, P9_K3_an_endless_motion_at_its_speed_has_nothing_more_to_report);
    tcase_add_test(one, K3_a_long_motion_that_nobody_sees_is_done_in_few_reports);
    suite_add_tcase(suite, one);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
