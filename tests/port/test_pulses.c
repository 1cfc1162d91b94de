/* SPDX-License-Identifier: MIT */
/* The queue between a unit that runs ahead and the interrupt that plays it (src/port/common/pulses.c). */
#include <check.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rkm04/unit.h>

#include "../src/port/common/pulses.h"

static struct pulses pulses;
static uint32_t now;
static char seen[8192];

static void tell(const char *what, unsigned number, unsigned value)
{
    size_t at = strlen(seen);
    snprintf(seen + at, sizeof seen - at, "%u:%s%u=%u ", (unsigned)now, what, number, value);
}

static void step(unsigned motor, bool on)
{
    tell("s", motor, on);
}

static void direction(unsigned motor, bool forward)
{
    tell("d", motor, forward);
}

static void outputs(uint8_t mask)
{
    tell("o", 0, mask);
}

static const struct pulse_pins pins = {.step = step, .direction = direction, .outputs = outputs};

/* Empty, at this tick. */
static void clear(uint32_t tick)
{
    pulses_start(&pulses, tick);
    seen[0] = '\0';
}

/* As a one-shot timer does it: play at `from`, then at each tick asked for, for a second. */
static void play_from(uint32_t from)
{
    uint32_t end = from + 1000000, next = from;
    pulses_refresh(&pulses);
    while (next != end) {
        now = next;
        next = pulses_play(&pulses, &pins, now, end);
    }
}

START_TEST(R7_a_pulse_is_ten_ticks_wide_and_comes_at_its_tick)
{
    clear(0);
    pulses_put(&pulses, 2, 100, PULSE_STEP);
    pulses_put(&pulses, 2, 200, PULSE_STEP);
    play_from(50);
    ck_assert_str_eq(seen, "100:s2=1 110:s2=0 200:s2=1 210:s2=0 ");
    ck_assert_uint_eq(pulses.latest, 0);
}
END_TEST

START_TEST(K2_motors_and_outputs_are_merged_in_order_of_time)
{
    clear(0);
    pulses_put(&pulses, 1, 300, PULSE_STEP);
    pulses_put(&pulses, 4, 105, PULSE_STEP);
    pulses_put(&pulses, 0, 200, 0x81);
    pulses_put(&pulses, 3, 300, PULSE_STEP);
    play_from(0);
    ck_assert_str_eq(seen, "105:s4=1 115:s4=0 200:o0=129 300:s1=1 300:s3=1 310:s1=0 310:s3=0 ");
}
END_TEST

START_TEST(R7_late_pulses_are_made_up_for_one_by_one_with_pauses)
{
    clear(0);
    for (uint32_t i = 0; i < 3; i++)
        pulses_put(&pulses, 1, 100 + i, PULSE_STEP);
    play_from(5000);
    ck_assert_str_eq(seen, "5000:s1=1 5010:s1=0 5020:s1=1 5030:s1=0 5040:s1=1 5050:s1=0 ");
    ck_assert_uint_ge(pulses.latest, 4900);
}
END_TEST

START_TEST(R7_the_direction_settles_before_the_pulse_and_is_kept_after_it_also_when_late)
{
    clear(0);
    pulses_put(&pulses, 1, 100, PULSE_STEP);
    pulses_put(&pulses, 1, 120, PULSE_FORWARD);
    pulses_put(&pulses, 1, 400, PULSE_STEP);
    play_from(900);
    ck_assert_str_eq(seen, "900:s1=1 910:s1=0 920:d1=1 940:s1=1 950:s1=0 ");
}
END_TEST

START_TEST(the_clock_of_32_bits_may_wrap_between_two_pulses)
{
    clear(UINT32_MAX - 1000);
    pulses_put(&pulses, 1, UINT32_MAX - 4, PULSE_STEP);
    pulses_put(&pulses, 1, 95, PULSE_STEP);
    play_from(UINT32_MAX - 100);
    ck_assert_str_eq(seen, "4294967291:s1=1 5:s1=0 95:s1=1 105:s1=0 ");
}
END_TEST

START_TEST(a_lane_that_was_idle_for_an_hour_goes_on)
{
    clear(0);
    pulses_put(&pulses, 1, 100, PULSE_STEP);
    play_from(0);
    for (uint32_t tick = 1000000; tick < 3600000000; tick += 500000000)
        (void)pulses_play(&pulses, &pins, tick, tick + 10);
    seen[0] = '\0';
    pulses_put(&pulses, 1, 3600000100, PULSE_STEP);
    play_from(3600000000);
    ck_assert_str_eq(seen, "3600000100:s1=1 3600000110:s1=0 ");
}
END_TEST

START_TEST(a_full_lane_says_so)
{
    clear(0);
    for (uint32_t i = 0; i < PULSES_ROOM; i++) {
        ck_assert(pulses_room(&pulses, 1));
        pulses_put(&pulses, 1, 100 * i, PULSE_STEP);
    }
    ck_assert(!pulses_room(&pulses, 1));
    ck_assert(pulses_room(&pulses, 2));
    now = 0;
    pulses_refresh(&pulses);
    (void)pulses_play(&pulses, &pins, now, 10);
    ck_assert(pulses_room(&pulses, 1));
}
END_TEST

/* ---- A unit that runs ahead ------------------------------------------------------------------------------------------- */

static void on_step(void *context, uint64_t tick, unsigned motor, int32_t position)
{
    (void)context, (void)position;
    ck_assert(pulses_room(&pulses, motor));
    pulses_put(&pulses, motor, (uint32_t)tick, PULSE_STEP);
}

START_TEST(U3_seven_milliseconds_of_four_motors_at_full_speed_fit_the_queue)
{
    static struct rkm04_unit unit;
    const struct rkm04_config config = {.node = 1};
    const struct rkm04_port port = {.step = on_step};
    const char text[] = "S2000 V16000 A60000 F16000 R";
    clear(0);
    rkm04_init(&unit, &config, &port, NULL);
    ck_assert_int_eq(rkm04_set_command(&unit, '0', text, sizeof text - 1, NULL), 0);
    for (now = 0; now < 900000; now += 10) {
        if (rkm04_now(&unit) < now + 6000)
            rkm04_advance(&unit, now + 7000 - rkm04_now(&unit));
        seen[0] = '\0';
        pulses_refresh(&pulses);
        (void)pulses_play(&pulses, &pins, now, now + 10);
        ck_assert_uint_lt(pulses.latest, 10);
    }
    struct rkm04_motor_state state;
    ck_assert(rkm04_motor_state(&unit, 4, &state));
    ck_assert_uint_eq(state.speed, 16000);
}
END_TEST

static Suite *pulses_suite(void)
{
    Suite *suite = suite_create("pulses");
    TCase *tcase = tcase_create("pulses");
    tcase_add_test(tcase, R7_a_pulse_is_ten_ticks_wide_and_comes_at_its_tick);
    tcase_add_test(tcase, K2_motors_and_outputs_are_merged_in_order_of_time);
    tcase_add_test(tcase, R7_late_pulses_are_made_up_for_one_by_one_with_pauses);
    tcase_add_test(tcase, R7_the_direction_settles_before_the_pulse_and_is_kept_after_it_also_when_late);
    tcase_add_test(tcase, the_clock_of_32_bits_may_wrap_between_two_pulses);
    tcase_add_test(tcase, a_lane_that_was_idle_for_an_hour_goes_on);
    tcase_add_test(tcase, a_full_lane_says_so);
    tcase_add_test(tcase, U3_seven_milliseconds_of_four_motors_at_full_speed_fit_the_queue);
    suite_add_tcase(suite, tcase);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(pulses_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
