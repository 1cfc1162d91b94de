/* SPDX-License-Identifier: MIT */
/* test_unit_time.c: time may be cut into any pieces: K3 of the specification.
 *
 * Random programs with random inputs, texts and frames run tick by tick, millisecond by millisecond, in random leaps and from
 * one rkm04_next_event() to the next. Every pulse, output, event and answer and the final state must be the same. A failure
 * names its seed. */
#include <check.h>
#include <string.h>

#include "rig.h"
#include "story.h"


static struct story story;
static struct run first, second;
static unsigned long long happenings; /* so that a test can show that its stories had some */

static void setup(void)
{
    happenings = 0;
}

static void teardown(void)
{
    recorder_free(&first.record);
    recorder_free(&second.record);
}

/* Run stories once at the first pace, and compare with the others. */
static void run_stories(unsigned seed, unsigned number, uint64_t end, bool slow, const enum pace *pace, unsigned paces)
{
    static const char *const name[] = {"by ticks", "by milliseconds", "in leaps", "from event to event", "in whole spans"};
    for (unsigned last = seed + number; seed < last; seed++) {
        story_tell(&story, seed, end, slow);
        run_begin(&first, &story);
        run_until(&first, &story, end, pace[0]);
        for (unsigned i = 1; i < paces; i++) {
            run_begin(&second, &story);
            run_until(&second, &story, end, pace[i]);
            run_compare(&first, &second, seed, name[pace[i]]);
        }
        happenings += first.record.count;
    }
}

#define RUN_STORIES(seed, number, end, slow, ...)                                                          \
    run_stories(seed, number, end, slow, (const enum pace[]){__VA_ARGS__},                                 \
                sizeof((const enum pace[]){__VA_ARGS__}) / sizeof(enum pace))


START_TEST(K3_a_tick_a_millisecond_a_leap_or_an_event_at_a_time_is_the_same)
{
    RUN_STORIES(0, 300, 40 * MS, false, PACE_TICK, PACE_MS, PACE_LEAPS, PACE_EVENTS, PACE_WHOLE);
    ck_assert_uint_gt(happenings, 300 * 100);
}
END_TEST

START_TEST(K3_the_same_over_long_times)
{
    RUN_STORIES(1000, 100, 3 * SECOND, true, PACE_MS, PACE_LEAPS, PACE_EVENTS, PACE_WHOLE);
    ck_assert_uint_gt(happenings, 100 * 500);
}
END_TEST

/* Two compound motions on two motors, whose outputs come on within one slot, the one of the first motor later. */
START_TEST(K3_outputs_of_two_motors_between_slots_come_on_in_order_of_time)
{
    static struct rig rig;
    for (unsigned whole = 0; whole < 2; whole++) {
        rig_power_up(&rig, NULL);
        rig_accept(&rig, '1', "T51 S1050 V1050 F1 Y V1100 F9 Y R");
        rig_accept(&rig, '2', "T52 S1200 V1200 F1 Y V1100 F9 Y R");
        if (whole)
            rig_to(&rig, 1 * SECOND);
        for (uint64_t tick = 1; !whole && tick <= 50 * MS; tick++)
            rig_to(&rig, tick);
        ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), recorder_step(&rig.record, 2, 1));
        ck_assert_uint_eq(rig_outputs_became(&rig, 3, 1), recorder_step(&rig.record, 1, 1));
        ck_assert_uint_lt(rig_outputs_became(&rig, 2, 1), rig_outputs_became(&rig, 3, 1));
    }
    rig_free(&rig);
}
END_TEST


/* From every event of a story, look where the next one is said to be: until then there is nothing to see. */
START_TEST(K3_nothing_happens_before_the_next_event)
{
    unsigned long long jumps = 0, longest = 0;
    for (unsigned seed = 6000; seed < 6050; seed++) {
        story_tell(&story, seed, 300 * MS, seed % 2);
        run_begin(&first, &story);
        while (rkm04_now(&first.unit) < story.end) {
            uint64_t stop = first.next < story.count ? story.action[first.next].tick : story.end;
            uint64_t now = rkm04_now(&first.unit), event = rkm04_next_event(&first.unit);
            ck_assert_uint_ge(event, now);
            uint64_t quiet = (event < stop ? event : stop) - now;
            int32_t position[RKM04_MOTORS];
            for (unsigned i = 0; i < RKM04_MOTORS; i++)
                position[i] = first.unit.motor[i].position;
            recorder_clear(&first.record);
            rkm04_advance(&first.unit, quiet);
            ck_assert_msg(first.record.count == 0, "seed %u: something at %llu, the next event was to be at %llu", seed,
                          (unsigned long long)first.record.list[0].tick, (unsigned long long)event);
            for (unsigned i = 0; i < RKM04_MOTORS; i++)
                ck_assert_int_eq(first.unit.motor[i].position, position[i]);
            jumps++;
            longest = quiet > longest ? quiet : longest;
            if (now + quiet == stop) {
                if (first.next < story.count)
                    run_act(&first, &story.action[first.next++]);
            } else {
                rkm04_advance(&first.unit, 1);
            }
        }
    }
    ck_assert_uint_gt(longest, 2 * MS); /* it does skip idle slots */
    ck_assert_uint_gt(jumps, 10000);
}
END_TEST

START_TEST(K3_a_unit_that_waits_for_ever_has_no_next_event)
{
    static const char *const text[] = {"", "U", "O01", "Z80 O81", "[ T01", "J5", "X01 T01"};
    for (size_t i = 0; i < sizeof text / sizeof *text; i++) {
        static struct rig rig;
        rig_power_up(&rig, NULL);
        rig_set(&rig, '0', text[i]);
        rig_to(&rig, 100 * MS);
        ck_assert_msg(rkm04_next_event(&rig.unit) == RKM04_NEVER, "\"%s\": an event at %llu", text[i],
                      (unsigned long long)rkm04_next_event(&rig.unit));
        rig_free(&rig);
    }
}
END_TEST

START_TEST(K3_an_idle_year_passes_at_once)
{
    static struct rig rig;
    rig_power_up(&rig, NULL);
    rig_accept(&rig, '1', "O01 T01");
    rkm04_advance(&rig.unit, 366 * 86400 * SECOND);
    rig_input_at(&rig, 366 * 86400 * SECOND, 1, true);
    rig_to(&rig, 366 * 86400 * SECOND + 5 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 366 * 86400 * SECOND + 1 * MS);
    rig_free(&rig);
}
END_TEST

START_TEST(K3_time_ends_at_the_last_tick_and_never_wraps)
{
    static struct rig rig;
    rig_power_up(&rig, NULL);
    rkm04_advance(&rig.unit, UINT64_MAX - 10);
    ck_assert_uint_eq(rkm04_now(&rig.unit), UINT64_MAX - 10);
    rkm04_advance(&rig.unit, 100);
    ck_assert_uint_eq(rkm04_now(&rig.unit), UINT64_MAX);
    rkm04_advance(&rig.unit, UINT64_MAX);
    ck_assert_uint_eq(rkm04_now(&rig.unit), UINT64_MAX);
    rig_free(&rig);
}
END_TEST

START_TEST(K3_advancing_by_nothing_changes_nothing)
{
    story_tell(&story, 42, 100 * MS, false);
    run_begin(&first, &story);
    run_until(&first, &story, 50 * MS, PACE_WHOLE);
    size_t count = first.record.count;
    for (int i = 0; i < 10; i++)
        rkm04_advance(&first.unit, 0);
    ck_assert_uint_eq(first.record.count, count);
    ck_assert_uint_eq(rkm04_now(&first.unit), 50 * MS);
    run_until(&first, &story, 100 * MS, PACE_WHOLE);
    run_begin(&second, &story);
    run_until(&second, &story, 100 * MS, PACE_WHOLE);
    run_compare(&first, &second, 42, "with and without empty advances");
}
END_TEST


START_TEST(K3_a_copy_put_back_goes_on_identically)
{
    static struct run snapshot;
    for (unsigned seed = 7000; seed < 7100; seed++) {
        bool slow = seed % 2;
        uint64_t end = slow ? 3 * SECOND : 80 * MS;
        story_tell(&story, seed, end, slow);
        uint64_t middle = 1 + story_draw(end - 1);
        run_begin(&first, &story);
        run_until(&first, &story, middle, PACE_LEAPS);
        snapshot = first;
        recorder_clear(&first.record);
        run_until(&first, &story, end, PACE_MS);
        second.record.count = 0; /* take the record of the first end over */
        struct recorder kept = first.record;
        first.record = second.record;
        second = first;
        second.record = kept;
        struct recorder spare = first.record;
        first = snapshot; /* put back into the very struct it came from */
        first.record = spare;
        run_until(&first, &story, end, PACE_EVENTS);
        run_compare(&second, &first, seed, "before and after the copy was put back");
    }
}
END_TEST

START_TEST(K3_a_copy_goes_on_identically_in_another_place)
{
    for (unsigned seed = 8000; seed < 8100; seed++) {
        bool slow = seed % 2;
        uint64_t end = slow ? 3 * SECOND : 80 * MS;
        story_tell(&story, seed, end, slow);
        uint64_t middle = 1 + story_draw(end - 1);
        run_begin(&first, &story);
        run_until(&first, &story, middle, PACE_MS);
        struct recorder spare = second.record;
        second = first;
        second.record = spare;
        second.unit.context = &second.record;
        recorder_clear(&first.record);
        recorder_clear(&second.record);
        for (uint64_t tick = middle; tick < end; tick += 10 * MS) { /* both live on side by side */
            uint64_t until = tick + 10 * MS < end ? tick + 10 * MS : end;
            run_until(&first, &story, until, PACE_MS);
            run_until(&second, &story, until, PACE_LEAPS);
        }
        run_compare(&first, &second, seed, "original and copy");
    }
}
END_TEST

START_TEST(K3_two_units_in_one_process_know_nothing_of_each_other)
{
    static struct story other;
    static struct run alone;
    for (unsigned seed = 9000; seed < 9030; seed++) {
        story_tell(&other, seed + 500, 2 * SECOND, true);
        story_tell(&story, seed, 2 * SECOND, true);
        run_begin(&alone, &story);
        run_until(&alone, &story, story.end, PACE_MS);
        run_begin(&first, &story);
        run_begin(&second, &other);
        for (uint64_t tick = 0; tick < story.end; tick += 7777) {
            uint64_t until = tick + 7777 < story.end ? tick + 7777 : story.end;
            run_until(&first, &story, until, PACE_LEAPS);
            run_until(&second, &other, until, PACE_EVENTS);
        }
        run_compare(&alone, &first, seed, "alone and beside another");
    }
    recorder_free(&alone.record);
}
END_TEST

START_TEST(P9_what_has_no_name_is_called_unknown)
{
    ck_assert_str_eq(rkm04_state_name((enum rkm04_state)99), "unknown");
    ck_assert_str_eq(rkm04_fault_name((enum rkm04_fault)99), "unknown");
    ck_assert_str_eq(rkm04_led_name((enum rkm04_led)99), "unknown");
}
END_TEST

static Suite *unit_time_suite(void)
{
    Suite *suite = suite_create("unit_time");

    TCase *paces = tcase_create("paces");
    tcase_add_checked_fixture(paces, setup, teardown);
    tcase_set_timeout(paces, 120);
    tcase_add_test(paces, K3_a_tick_a_millisecond_a_leap_or_an_event_at_a_time_is_the_same);
    tcase_add_test(paces, K3_the_same_over_long_times);
    tcase_add_test(paces, K3_outputs_of_two_motors_between_slots_come_on_in_order_of_time);
    suite_add_tcase(suite, paces);

    TCase *events = tcase_create("events");
    tcase_add_checked_fixture(events, setup, teardown);
    tcase_set_timeout(events, 120);
    tcase_add_test(events, K3_nothing_happens_before_the_next_event);
    tcase_add_test(events, K3_a_unit_that_waits_for_ever_has_no_next_event);
    tcase_add_test(events, K3_an_idle_year_passes_at_once);
    tcase_add_test(events, K3_time_ends_at_the_last_tick_and_never_wraps);
    tcase_add_test(events, K3_advancing_by_nothing_changes_nothing);
    suite_add_tcase(suite, events);

    TCase *snapshots = tcase_create("snapshots");
    tcase_add_checked_fixture(snapshots, setup, teardown);
    tcase_set_timeout(snapshots, 120);
    tcase_add_test(snapshots, K3_a_copy_put_back_goes_on_identically);
    tcase_add_test(snapshots, K3_a_copy_goes_on_identically_in_another_place);
    tcase_add_test(snapshots, K3_two_units_in_one_process_know_nothing_of_each_other);
    tcase_add_test(snapshots, P9_what_has_no_name_is_called_unknown);
    suite_add_tcase(suite, snapshots);

    return suite;
}

int main(void)
{
    return rig_run(unit_time_suite(), "./test_unit_time");
}
