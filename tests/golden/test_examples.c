/* SPDX-License-Identifier: MIT */
/* test_examples.c: the example programs of the manual's chapter 9, with their inputs in each state the text describes.
 *
 * Times: a text at tick 0 begins in slot 1000, a command takes a slot, the command after a motion is executed in the first slot
 * at or after its last pulse + 10 us, the one after Wn n slots after W (K4). A motion from rest takes move_ticks() (R1). */
#include <check.h>
#include <string.h>

#include "core/rig.h"

static struct rig rig;
static size_t seen; /* motions that a test has accounted for */

static void setup(void)
{
    rig_power_up(&rig, NULL);
    seen = 0;
}

static void teardown(void)
{
    rig_free(&rig);
}

/* The next motion began in this slot, at S100 A2000. Returns the slot of the command after it. */
static uint64_t moved(uint64_t slot, uint64_t v, size_t steps, bool forward)
{
    uint64_t end = slot + move_ticks(100, v, 2000, steps);
    rig_expect_motion(&rig, 1, ++seen, slot, end, steps, forward);
    return slot_behind(end);
}

/* The next motion began in this slot and was stopped on a ramp, last pulse at `end`. Returns the slot of the command after. */
static uint64_t stopped(uint64_t slot, uint64_t end, size_t steps, bool forward)
{
    rig_expect_motion_near(&rig, 1, ++seen, slot, end, steps, forward);
    return slot_behind(end);
}

static void expect_ran(unsigned place, size_t n, uint64_t slot)
{
    uint64_t ran = rig_ran(&rig, place, n);
    ck_assert_msg(ran == slot, "the command at place %u ran at %llu, not %llu", place, (unsigned long long)ran,
                  (unsigned long long)slot);
}

/* The program is in this state, there were no other motions, the counter and the number of pulses are these. */
static void expect_rest(enum rkm04_state state, int32_t position, size_t pulses)
{
    ck_assert_str_eq(rkm04_state_name(rig_motor(&rig, 1).state), rkm04_state_name(state));
    ck_assert_uint_eq(rig_motions(&rig, 1), seen);
    ck_assert_int_eq(rig_motor(&rig, 1).position, position);
    ck_assert_uint_eq(recorder_steps(&rig.record, 1), pulses);
    ck_assert_int_eq(rig_motor(&rig, 1).led, RKM04_LED_OFF);
}


/* T = ((V-S)^2 + N A) / (A V) where V is reached: 5.405 s, 2.405 s, 3.405 s. */
START_TEST(M9_1_out_back_and_home)
{
    rig_accept(&rig, '1', "\\C100\nS100 V1000 A2000 F5000 R\nB2000 R\nH");
    rig_to(&rig, 20 * SECOND);
    uint64_t slot = 6 * MS; /* C S V A F R */
    slot = moved(slot, 1000, 5000, true);
    ck_assert_uint_eq(slot, 5412 * MS);
    slot = moved(slot + 1 * MS, 1000, 2000, false);
    ck_assert_uint_eq(slot, 7819 * MS);
    slot = moved(slot, 1000, 3000, false);
    ck_assert_uint_eq(slot, 11225 * MS);
    expect_rest(RKM04_IDLE, 0, 10000);
}
END_TEST

START_TEST(M9_1_a_second_run_is_like_the_first)
{
    static const char text[] = "\\C100\nS100 V1000 A2000 F5000 R\nB2000 R\nH";
    rig_accept(&rig, '1', text);
    rig_accept_at(&rig, 3 * SECOND + 500, text); /* stops the first motion at once */
    rig_to(&rig, 20 * SECOND);
    seen = 1;
    uint64_t slot = 3 * SECOND + 6 * MS;
    slot = moved(slot, 1000, 5000, true);
    slot = moved(slot + 1 * MS, 1000, 2000, false);
    moved(slot, 1000, 3000, false);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 0);
}
END_TEST

/* T = (700^2 + 1000 * 2000) / (2000 * 800) = 1.55625 s. */
START_TEST(M9_2_there_and_back_for_ever)
{
    rig_accept(&rig, '1', "\\\nS100 V800 A2000\n@1 F1000 R\nW500 D R\nW1000 J1");
    rig_to(&rig, 100 * SECOND);
    uint64_t slot = 6 * MS; /* S V A @ F R */
    for (int pass = 0; pass < 20; pass++) {
        ck_assert_uint_eq(move_ticks(100, 800, 2000, 1000), 1556250);
        slot = moved(slot, 800, 1000, true) + 500 * MS;             /* W to D */
        slot = moved(slot + 1 * MS, 800, 1000, false) + 1000 * MS; /* W to J */
        slot += 3 * MS;                                            /* @ F R */
    }
}
END_TEST

/* At S200 V2000 A5000: T = (1800^2 + 2000 * 5000) / (5000 * 2000) = 1.324 s. The input decides again in each pass. */
START_TEST(M9_3_input_5_decides_the_direction_of_each_pass)
{
    static const bool level[] = {false, true, true, false, true, false, false};
    rig_accept(&rig, '1', "\\\nS200 V2000 A5000\n@1 I05H10 F2000 R J20\n@10 B2000 R \n@20 W600\nJ1");
    uint64_t question = 5 * MS; /* S V A @ I */
    int32_t position = 0;
    for (size_t pass = 0; pass < sizeof level / sizeof *level; pass++) {
        rig_input_at(&rig, question, 5, level[pass]);
        uint64_t begin = question + (level[pass] ? 3 : 2) * MS; /* @10 B R or F R */
        uint64_t end = begin + 1324 * MS;
        uint64_t slot = slot_behind(end);
        rig_to(&rig, end + 1);
        rig_expect_motion(&rig, 1, pass + 1, begin, end, 2000, !level[pass]);
        position += level[pass] ? -2000 : 2000;
        ck_assert_int_eq(rig_motor(&rig, 1).position, position);
        slot += level[pass] ? 0 : 1 * MS;     /* J20 */
        question = slot + (1 + 600 + 2) * MS; /* @20, W to J1, @1, I */
    }
}
END_TEST

/* T(1000) = (500^2 + 1000 * 2000) / (2000 * 600) = 1.875 s, T(500) = 1.0416667 s. F1000 and F500, as the text says. */
START_TEST(M9_4_three_times_there_and_back_and_home)
{
    rig_accept(&rig, '1', "\\C100\nS100 V600 A2000 F1000 R\nL3 F500 R W200 D R W1000 E\nB1000 R");
    rig_to(&rig, 30 * SECOND);
    ck_assert_uint_eq(move_ticks(100, 600, 2000, 1000), 1875000);
    ck_assert_uint_eq(move_ticks(100, 600, 2000, 500), 1041667);
    uint64_t slot = moved(6 * MS, 600, 1000, true); /* C S V A F R, to L */
    expect_ran(7, 1, slot);
    for (size_t pass = 1; pass <= 3; pass++) {
        slot = moved(slot + 2 * MS, 600, 500, true) + 200 * MS;   /* L or E, F, R, W to D */
        slot = moved(slot + 1 * MS, 600, 500, false) + 1000 * MS; /* D, R, W to E */
        expect_ran(14, pass, slot);
    }
    expect_ran(7, 2, RKM04_NEVER);
    moved(slot + 2 * MS, 600, 1000, false);
    expect_rest(RKM04_IDLE, 0, 5000);
}
END_TEST


static const char M9_5[] = "\\C100\nS100 V1000 A2000 F5000 R\nO02 B6000 R\nZ05 F3000 R\nH";

START_TEST(M9_5_inputs_that_are_there_already_hold_nothing_up)
{
    rig_input_at(&rig, 0, 2, true);
    rig_accept(&rig, '1', M9_5);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = moved(6 * MS, 1000, 5000, true); /* to O */
    slot = moved(slot + 2 * MS, 1000, 6000, false);  /* to Z */
    slot = moved(slot + 2 * MS, 1000, 3000, true);   /* to H */
    moved(slot, 1000, 2000, false);
    expect_rest(RKM04_IDLE, 0, 16000);
}
END_TEST

START_TEST(M9_5_the_program_waits_for_input_2_true_and_for_input_5_false)
{
    rig_input_at(&rig, 0, 5, true);
    rig_accept(&rig, '1', M9_5);
    rig_to(&rig, 20 * SECOND);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 7);
    ck_assert_int_eq(rig_motor(&rig, 1).position, 5000);
    rig_input_at(&rig, 20 * SECOND + 1, 2, true); /* seen in the slot after, then B, R */
    rig_to(&rig, 40 * SECOND);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 10);
    ck_assert_int_eq(rig_motor(&rig, 1).position, -1000);
    rig_input_at(&rig, 40 * SECOND, 5, false); /* seen in this slot */
    rig_to(&rig, 60 * SECOND);
    moved(6 * MS, 1000, 5000, true);
    moved(20 * SECOND + 3 * MS, 1000, 6000, false);
    uint64_t slot = moved(40 * SECOND + 2 * MS, 1000, 3000, true);
    moved(slot, 1000, 2000, false);
    expect_rest(RKM04_IDLE, 0, 16000);
}
END_TEST

START_TEST(M9_5_inputs_that_change_before_they_are_asked_for_leave_the_program_waiting)
{
    rig_input_at(&rig, 1 * SECOND, 2, true); /* gone again before O02 */
    rig_accept(&rig, '1', M9_5);
    rig_input_at(&rig, 2 * SECOND, 2, false);
    rig_to(&rig, 60 * SECOND);
    ck_assert_uint_eq(rig_motor(&rig, 1).index, 7);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_WAIT);
}
END_TEST


/* Input 6 is at 1 unless its switch is hit: N06 acts on 0. */
static const char M9_6[] = "\\C100\nS100 V1000 A2000 F5000\nM03 R U\nW200 V600 B4000\nN06 R U\nW300 F500 R";

/* From the slot of the first U to that of the second R; and from that of the second U to that of the third R. */
#define M9_6_MIDDLE ((1 + 200 + 3) * MS) /* U; W to V; B N R */
#define M9_6_END ((1 + 300 + 1) * MS)    /* U; W to F; R */

START_TEST(M9_6_no_limit_switch_reacts)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', M9_6);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = moved(7 * MS, 1000, 5000, true); /* C S V A F M R */
    slot = moved(slot + M9_6_MIDDLE, 600, 4000, false);
    moved(slot + M9_6_END, 600, 500, true);
    expect_rest(RKM04_IDLE, 1500, 9500);
}
END_TEST

/* After 2 s x = 247.5 + 1550 = 1797.5; down to S in 247.5 steps and 0.45 s. */
START_TEST(M9_6_input_3_becomes_true)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', M9_6);
    rig_input_at(&rig, 2007 * MS, 3, true);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = stopped(7 * MS, 2457 * MS, 2045, true);
    slot = moved(slot + M9_6_MIDDLE, 600, 4000, false);
    moved(slot + M9_6_END, 600, 500, true); /* input 3 is still at 1: U has taken M03 away */
    expect_rest(RKM04_IDLE, 2045 - 4000 + 500, 2045 + 4000 + 500);
}
END_TEST

/* V600: up to speed in 0.25 s and 87.5 steps; after 1.25 s x = 687.5; down to S in 87.5 steps and 0.25 s. */
START_TEST(M9_6_input_6_becomes_false)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', M9_6);
    uint64_t begin = slot_behind(7 * MS + move_ticks(100, 1000, 2000, 5000)) + M9_6_MIDDLE;
    rig_input_at(&rig, begin + 1250 * MS, 6, false);
    rig_to(&rig, 30 * SECOND);
    moved(7 * MS, 1000, 5000, true);
    uint64_t slot = stopped(begin, begin + 1500 * MS, 775, false);
    moved(slot + M9_6_END, 600, 500, true);
    expect_rest(RKM04_IDLE, 5000 - 775 + 500, 5000 + 775 + 500);
}
END_TEST

START_TEST(M9_6_both_switches_react)
{
    rig_input_at(&rig, 0, 6, true);
    rig_accept(&rig, '1', M9_6);
    rig_input_at(&rig, 2007 * MS, 3, true);
    uint64_t begin = slot_behind(2457 * MS) + M9_6_MIDDLE;
    rig_input_at(&rig, begin + 1250 * MS, 6, false);
    rig_to(&rig, 30 * SECOND);
    stopped(7 * MS, 2457 * MS, 2045, true);
    uint64_t slot = stopped(begin, begin + 1500 * MS, 775, false);
    moved(slot + M9_6_END, 600, 500, true);
    expect_rest(RKM04_IDLE, 2045 - 775 + 500, 2045 + 775 + 500);
}
END_TEST

START_TEST(M9_6_a_switch_that_is_hit_already_allows_no_step)
{
    rig_input_at(&rig, 0, 3, true); /* and input 6 at 0 */
    rig_accept(&rig, '1', M9_6);
    rig_to(&rig, 30 * SECOND);
    uint64_t slot = 8 * MS + M9_6_MIDDLE; /* a motion without steps takes its one slot */
    slot += 1 * MS + M9_6_END;
    size_t pulses = recorder_steps(&rig.record, 1);
    ck_assert_uint_eq(pulses, 500);
    ck_assert_uint_eq(recorder_step(&rig.record, 1, 500), slot + move_ticks(100, 600, 2000, 500));
    ck_assert_int_eq(rig_motor(&rig, 1).position, 500);
}
END_TEST


static const char M9_7[] = "\\C100\nS100 V1000 A2000\nX04\n@1 F5000 R\nW600 B5000 R\nW1000 J1";

START_TEST(M9_7_input_4_stays_false_and_everything_repeats)
{
    rig_accept(&rig, '1', M9_7);
    rig_to(&rig, 100 * SECOND);
    uint64_t slot = 8 * MS; /* C S V A X @ F R */
    for (int pass = 0; pass < 7; pass++) {
        slot = moved(slot, 1000, 5000, true) + 600 * MS;            /* W to B */
        slot = moved(slot + 1 * MS, 1000, 5000, false) + 1000 * MS; /* W to J */
        slot += 3 * MS;                                            /* @ F R */
    }
}
END_TEST

/* At constant speed 2 s after the beginning: 1797.5 + 247.5 steps. */
START_TEST(M9_7_input_4_stops_the_motion_forward_on_a_ramp_and_ends_the_program)
{
    rig_accept(&rig, '1', M9_7);
    rig_input_at(&rig, 2008 * MS, 4, true);
    rig_input_at(&rig, 2009 * MS, 4, false);
    rig_to(&rig, 60 * SECOND);
    stopped(8 * MS, 2458 * MS, 2045, true);
    expect_rest(RKM04_ENDED, 2045, 2045);
    expect_ran(9, 1, RKM04_NEVER); /* W600 */
}
END_TEST

START_TEST(M9_7_input_4_stops_the_motion_back_on_a_ramp_and_ends_the_program)
{
    rig_accept(&rig, '1', M9_7);
    uint64_t begin = slot_behind(8 * MS + move_ticks(100, 1000, 2000, 5000)) + 601 * MS;
    rig_input_at(&rig, begin + 2000 * MS, 4, true);
    rig_to(&rig, 60 * SECOND);
    moved(8 * MS, 1000, 5000, true);
    stopped(begin, begin + 2450 * MS, 2045, false);
    expect_rest(RKM04_ENDED, 5000 - 2045, 5000 + 2045);
}
END_TEST

START_TEST(M9_7_input_4_during_the_first_dwell_ends_the_program)
{
    rig_accept(&rig, '1', M9_7);
    uint64_t dwell = slot_behind(8 * MS + move_ticks(100, 1000, 2000, 5000));
    rig_input_at(&rig, dwell + 300 * MS, 4, true);
    rig_to(&rig, dwell + 300 * MS + 1);
    ck_assert_int_eq(rig_motor(&rig, 1).state, RKM04_ENDED);
    rig_to(&rig, 60 * SECOND);
    moved(8 * MS, 1000, 5000, true);
    expect_rest(RKM04_ENDED, 5000, 5000);
    expect_ran(10, 1, RKM04_NEVER); /* B5000 */
}
END_TEST

START_TEST(M9_7_input_4_during_the_second_dwell_ends_the_program)
{
    rig_accept(&rig, '1', M9_7);
    uint64_t dwell = slot_behind(8 * MS + move_ticks(100, 1000, 2000, 5000)) + 601 * MS;
    dwell = slot_behind(dwell + move_ticks(100, 1000, 2000, 5000));
    rig_input_at(&rig, dwell + 999 * MS, 4, true);
    rig_to(&rig, 60 * SECOND);
    seen = 2;
    expect_rest(RKM04_ENDED, 0, 10000);
    expect_ran(13, 1, RKM04_NEVER); /* J1 */
}
END_TEST


static const char M9_8[] = "\\C100\nS100 V1000 A2000\n@1 I81L6\n"
                           "T02 F2500 '3 C02 C81 J1\n@6 T05 B2500 '3 C05 T81 J1\n@3 R W500 D R .";

/* The branches take turns, VAR 81 is turned over at the end of each: the first goes back first, with DO 05 on, the next one
 * forward first, with DO 02 on. */
START_TEST(M9_8_the_variable_turns_the_direction_over_in_each_pass)
{
    rig_accept(&rig, '1', M9_8);
    rig_to(&rig, 40 * SECOND);
    uint64_t question = 6 * MS; /* C S V A @ I */
    for (size_t pass = 0; pass < 5; pass++) {
        bool forward = pass % 2;
        uint64_t on = question + (forward ? 1 : 2) * MS; /* T02, or @6 T05 */
        uint64_t slot = on + 4 * MS;                     /* F or B, ', @3, R */
        slot = moved(slot, 1000, 2500, forward) + 500 * MS;
        slot = moved(slot + 1 * MS, 1000, 2500, !forward); /* D, R, to . */
        uint64_t off = slot + 1 * MS;                      /* C02 or C05 */
        ck_assert_uint_eq(rig_outputs_became(&rig, forward ? 0x02 : 0x10, pass / 2 + 1), on);
        ck_assert_uint_eq(rig_outputs_became(&rig, 0, pass + 1), off);
        const struct record *turn =
            recorder_event(&rig.record, 0, RKM04_EVENT_VARIABLE, forward ? 0 : 2, pass / 2 + 1);
        ck_assert_ptr_nonnull(turn);
        ck_assert_uint_eq(turn->tick, off + 1 * MS);
        question = off + 4 * MS; /* C81 or T81, J, @, I */
    }
}
END_TEST

START_TEST(M9_8_another_motor_may_set_the_variable_first)
{
    rig_accept(&rig, '2', "T81");
    rig_accept(&rig, '1', M9_8);
    rig_to(&rig, 10 * SECOND);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0x02, 1), 7 * MS);
    moved(11 * MS, 1000, 2500, true); /* T F ' @ R */
}
END_TEST


/* The manual has lost the listing; this one follows its prose. The last segment, 2000 steps, takes 1880 at 500 and 0.4 s down:
 * it begins with the last pulse of the fifth, 16 000, at 24.469167 - 3.76 - 0.4 s. */
START_TEST(M9_9_output_5_is_on_from_the_last_segment_to_500_ms_after_the_motion)
{
    rig_accept(&rig, '1',
               "\\\nS100 T55\nV500 A2000 F2000 Y\nV2000 Y\nV500 F5000 Y\nV3000 A1000 Y\nV1500 F2000 Y\nV500 Y\nR W500 C05");
    rig_to(&rig, 60 * SECOND);
    uint64_t begin = 20 * MS; /* R is the twentieth command */
    uint64_t slot = stopped(begin, begin + 24469167, 18000, true);
    uint64_t on = rig_outputs_became(&rig, 0x10, 1);
    ck_assert_uint_eq(on, recorder_step(&rig.record, 1, 16000));
    ck_assert_msg(on + 1 >= begin + 20309167 && on <= begin + 20309168, "at %llu", (unsigned long long)on);
    ck_assert_uint_eq(rig_outputs_became(&rig, 0, 1), slot + 500 * MS);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    expect_rest(RKM04_IDLE, 18000, 18000);
}
END_TEST

static Suite *examples_suite(void)
{
    Suite *suite = suite_create("examples");

    TCase *simple = tcase_create("simple");
    tcase_add_checked_fixture(simple, setup, teardown);
    tcase_add_test(simple, M9_1_out_back_and_home);
    tcase_add_test(simple, M9_1_a_second_run_is_like_the_first);
    tcase_add_test(simple, M9_2_there_and_back_for_ever);
    tcase_add_test(simple, M9_3_input_5_decides_the_direction_of_each_pass);
    tcase_add_test(simple, M9_4_three_times_there_and_back_and_home);
    suite_add_tcase(suite, simple);

    TCase *waits = tcase_create("waits");
    tcase_add_checked_fixture(waits, setup, teardown);
    tcase_add_test(waits, M9_5_inputs_that_are_there_already_hold_nothing_up);
    tcase_add_test(waits, M9_5_the_program_waits_for_input_2_true_and_for_input_5_false);
    tcase_add_test(waits, M9_5_inputs_that_change_before_they_are_asked_for_leave_the_program_waiting);
    suite_add_tcase(suite, waits);

    TCase *guards = tcase_create("guards");
    tcase_add_checked_fixture(guards, setup, teardown);
    tcase_add_test(guards, M9_6_no_limit_switch_reacts);
    tcase_add_test(guards, M9_6_input_3_becomes_true);
    tcase_add_test(guards, M9_6_input_6_becomes_false);
    tcase_add_test(guards, M9_6_both_switches_react);
    tcase_add_test(guards, M9_6_a_switch_that_is_hit_already_allows_no_step);
    suite_add_tcase(suite, guards);

    TCase *total_stop = tcase_create("total_stop");
    tcase_add_checked_fixture(total_stop, setup, teardown);
    tcase_add_test(total_stop, M9_7_input_4_stays_false_and_everything_repeats);
    tcase_add_test(total_stop, M9_7_input_4_stops_the_motion_forward_on_a_ramp_and_ends_the_program);
    tcase_add_test(total_stop, M9_7_input_4_stops_the_motion_back_on_a_ramp_and_ends_the_program);
    tcase_add_test(total_stop, M9_7_input_4_during_the_first_dwell_ends_the_program);
    tcase_add_test(total_stop, M9_7_input_4_during_the_second_dwell_ends_the_program);
    suite_add_tcase(suite, total_stop);

    TCase *subroutine = tcase_create("subroutine");
    tcase_add_checked_fixture(subroutine, setup, teardown);
    tcase_add_test(subroutine, M9_8_the_variable_turns_the_direction_over_in_each_pass);
    tcase_add_test(subroutine, M9_8_another_motor_may_set_the_variable_first);
    suite_add_tcase(suite, subroutine);

    TCase *compound = tcase_create("compound");
    tcase_add_checked_fixture(compound, setup, teardown);
    tcase_add_test(compound, M9_9_output_5_is_on_from_the_last_segment_to_500_ms_after_the_motion);
    suite_add_tcase(suite, compound);

    return suite;
}

int main(void)
{
    return rig_run(examples_suite(), "./test_examples");
}
