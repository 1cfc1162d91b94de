/* SPDX-License-Identifier: MIT */
/* What goes to hardware that plays pulses by itself (src/port/common/feed.c), and the queues of the line (line.c). */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "../src/port/common/board.h"
#include "../src/port/common/feed.h"
#include "../src/port/common/line.h"

#define WORDS 64

static const struct feed_timing timing = {.apart = 20, .rest = 11};
struct pulses board_pulses;
static uint32_t after[WORDS], levels[WORDS];
static unsigned words, room, looks;

unsigned board_feed_room(unsigned lane)
{
    (void)lane;
    return room;
}

void board_feed_give(unsigned lane, uint32_t distance, uint32_t mask)
{
    (void)lane;
    ck_assert_uint_gt(room, 0); /* a word more than there is room for would be lost */
    room--;
    after[words] = distance;
    levels[words++] = mask;
}

void board_line(void)
{
    looks++;
}

/* A lane whose pins have changed last at `end`, with room for eight words. */
static void begin(unsigned lane, uint32_t end)
{
    pulses_start(&board_pulses, end);
    feed_start(lane, end);
    words = 0;
    room = 8;
}

static void word(unsigned number, uint32_t distance, uint32_t mask)
{
    ck_assert_uint_lt(number, words);
    ck_assert_uint_eq(after[number], distance);
    ck_assert_uint_eq(levels[number], mask);
}

START_TEST(R7_pulses_come_at_their_distances_and_the_direction_lasts)
{
    begin(1, 1000);
    pulses_put(&board_pulses, 1, 1100, PULSE_FORWARD);
    pulses_put(&board_pulses, 1, 1120, PULSE_STEP);
    pulses_put(&board_pulses, 1, 1182, PULSE_STEP);
    pulses_put(&board_pulses, 1, 1300, PULSE_BACK);
    pulses_put(&board_pulses, 1, 1340, PULSE_STEP);
    feed(1, &timing, 1000);
    word(0, 100, 2);
    word(1, 20, 3);
    word(2, 62, 3);
    word(3, 118, 0);
    word(4, 40, 1);
    ck_assert_uint_eq(board_pulses.latest, 0);
}
END_TEST

START_TEST(an_empty_lane_waits_without_running_dry)
{
    uint32_t end = 0xffffff00u; /* the tick wraps on the way */
    begin(2, end);
    for (uint32_t now = end; now - end < 100000; now += 200) {
        room = 8;
        words = 0;
        feed(2, &timing, now);
        for (unsigned i = 0; i < words; i++) {
            ck_assert_uint_eq(levels[i], 0);
            end += after[i];
        }
        ck_assert_int_gt((int32_t)(end + timing.rest - now), 200); /* it lasts until the next call */
        ck_assert_int_le((int32_t)(end - now), FEED_WINDOW);       /* and what comes into the queue is never too late */
    }
}
END_TEST

START_TEST(what_is_far_off_waits_in_the_queue_and_comes_at_its_tick)
{
    uint32_t end = 0;
    begin(3, 0);
    pulses_put(&board_pulses, 3, 7001, PULSE_STEP);
    for (uint32_t now = 0; now < 8000; now += 200) {
        room = 8;
        words = 0;
        feed(3, &timing, now);
        for (unsigned i = 0; i < words; i++) {
            end += after[i];
            if (levels[i] == 1)
                ck_assert_uint_eq(end, 7001);
        }
    }
    ck_assert_uint_eq(board_pulses.lane[3].out, 1);
    ck_assert_uint_eq(board_pulses.latest, 0);
}
END_TEST

START_TEST(late_pulses_are_kept_apart_and_reported)
{
    begin(1, 1000);
    for (unsigned i = 0; i < 3; i++)
        pulses_put(&board_pulses, 1, 900, PULSE_STEP);
    feed(1, &timing, 1000);
    for (unsigned i = 0; i < 3; i++)
        word(i, 20, 1);
    ck_assert_uint_eq(board_pulses.latest, 160);
}
END_TEST

START_TEST(a_full_queue_is_filled_later)
{
    begin(1, 0);
    room = 2;
    for (uint32_t i = 1; i <= 5; i++)
        pulses_put(&board_pulses, 1, 100 * i, PULSE_STEP);
    feed(1, &timing, 0);
    ck_assert_uint_eq(words, 2);
    room = 8;
    feed(1, &timing, 150);
    ck_assert_uint_ge(words, 5);
    for (unsigned i = 0; i < 5; i++)
        word(i, 100, 1);
}
END_TEST

START_TEST(a_lane_that_ran_dry_begins_with_the_next_word)
{
    begin(1, 0);
    pulses_put(&board_pulses, 1, 5100, PULSE_STEP);
    feed(1, &timing, 5000); /* the last word ended at 11 */
    word(0, 111, 1);
}
END_TEST

START_TEST(outputs_of_a_tick_change_at_once_and_keep_the_LEDs)
{
    begin(0, 0);
    feed_levels(0xf00, 0x300);
    pulses_put(&board_pulses, 0, 100, 0x01);
    pulses_put(&board_pulses, 0, 100, 0x03);
    pulses_put(&board_pulses, 0, 200, 0x02);
    feed(0, &timing, 0);
    word(0, 100, 0x303);
    word(1, 100, 0x302);
    feed_levels(0x200, 0);
    ck_assert_uint_eq(feed_level(), 0x102);
}
END_TEST

START_TEST(U7_the_driver_is_on_until_the_last_stop_bit_has_left)
{
    uint8_t byte;
    ck_assert(!line_drives(true));
    line_send((const uint8_t *)"ab", 2);
    ck_assert_uint_gt(looks, 0);
    ck_assert(line_drives(true)); /* before the first byte */
    ck_assert(line_next(&byte));
    ck_assert_uint_eq(byte, 'a');
    ck_assert(line_drives(false));
    ck_assert(line_next(&byte));
    ck_assert(!line_next(&byte));
    ck_assert(line_drives(false));
    ck_assert(!line_drives(true));
}
END_TEST

START_TEST(bytes_come_in_order_and_a_full_queue_says_so)
{
    const uint8_t *bytes;
    for (unsigned round = 0, next = 0; round < 5; round++) {
        unsigned count = 0, taken = 0;
        for (; line_has_room(); count++)
            line_came((uint8_t)(next + count));
        ck_assert_uint_eq(count, LINE_ROOM);
        ck_assert(line_needs_main_loop(false));
        for (size_t length; (length = line_poll(&bytes)) > 0; taken += (unsigned)length) {
            length = length > 7 ? 7 : length;
            for (unsigned i = 0; i < length; i++)
                ck_assert_uint_eq(bytes[i], (uint8_t)(next + taken + i));
            line_take(length);
        }
        ck_assert_uint_eq(taken, count);
        ck_assert(!line_needs_main_loop(false));
        next += count;
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("feed");
    TCase *tests = tcase_create("feed");
    tcase_add_test(tests, R7_pulses_come_at_their_distances_and_the_direction_lasts);
    tcase_add_test(tests, an_empty_lane_waits_without_running_dry);
    tcase_add_test(tests, what_is_far_off_waits_in_the_queue_and_comes_at_its_tick);
    tcase_add_test(tests, late_pulses_are_kept_apart_and_reported);
    tcase_add_test(tests, a_full_queue_is_filled_later);
    tcase_add_test(tests, a_lane_that_ran_dry_begins_with_the_next_word);
    tcase_add_test(tests, outputs_of_a_tick_change_at_once_and_keep_the_LEDs);
    tcase_add_test(tests, U7_the_driver_is_on_until_the_last_stop_bit_has_left);
    tcase_add_test(tests, bytes_come_in_order_and_a_full_queue_says_so);
    suite_add_tcase(suite, tests);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_NORMAL);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
