/* SPDX-License-Identifier: MIT */
/* Goals of an axis with two accelerations: motions that can be reckoned by hand. tests/reference/goal.py judges random ones. */
#include <check.h>
#include <inttypes.h>

#include "profile.h"
#include "ramp.h"

#define RATE 1000000
#define PULSES_MAX 110000

static struct rkm04_motion motion;
static uint64_t tick[PULSES_MAX];
static uint32_t pulses;

/* From 200 to 1000 steps/s takes 480 steps and 0.8 s, back to 200 takes 120 steps and 0.2 s. */
static const struct profile_goal usual = {
    .kind = PROFILE_TO_PLACE, .way = 1600, .speed = 1000, .start_speed = 200, .acceleration = 1000, .deceleration = 4000};

static void setup(void)
{
    motion = (struct rkm04_motion){.moving = false};
    pulses = 0;
}

static enum profile_answer go(uint64_t at, enum profile_goal_kind kind, int64_t way, int32_t speed)
{
    struct profile_goal goal = usual;
    goal.kind = kind;
    goal.way = way;
    goal.speed = speed;
    return profile_go(&motion, at, RATE, &goal);
}

/* Pulses due up to `limit`, or up to the end of the motion, kept from tick[0] on. */
static void run(uint64_t limit)
{
    pulses = 0;
    while (motion.moving && motion.ramp.next <= limit) {
        size_t n = ramp_pulses(&motion.ramp, &motion.profile, limit, tick + pulses, PULSES_MAX - pulses);
        pulses += (uint32_t)n;
        motion.done += (uint32_t)n;
        ck_assert_uint_lt(pulses, PULSES_MAX);
        if (motion.ramp.next == RKM04_NEVER)
            motion.moving = false;
    }
}

/* Pulse k, counted from 1, of what run() has seen. */
static void expect_pulse(uint32_t k, uint64_t due, uint64_t late)
{
    ck_assert_uint_le(k, pulses);
    ck_assert_uint_ge(tick[k - 1], due - late);
    ck_assert_uint_le(tick[k - 1], due + late);
}

START_TEST(a_motion_from_rest_has_its_two_accelerations_in_both_directions)
{
    const bool forward = _i == 0;
    ck_assert_int_eq(go(5000, PROFILE_TO_PLACE, forward ? 1600 : -1600, 1000), PROFILE_MOVES);
    ck_assert(motion.moving && motion.forward == forward);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 1600);
    expect_pulse(480, 5000 + 800000, 0);
    expect_pulse(1480, 5000 + 1800000, 0);
    expect_pulse(1600, 5000 + 2000000, 0);
}
END_TEST

START_TEST(a_motion_that_does_not_reach_its_speed_has_its_peak_where_both_accelerations_meet)
{
    ck_assert_int_eq(go(0, PROFILE_TO_PLACE, 600, 2000), PROFILE_MOVES);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 600);
    expect_pulse(480, 800000, 1); /* at 1000 steps/s */
    expect_pulse(600, 1000000, 1);
}
END_TEST

START_TEST(an_axis_at_rest_stays_there_without_a_way_and_when_it_is_to_stop)
{
    ck_assert_int_eq(go(0, PROFILE_TO_PLACE, 0, 1000), PROFILE_STANDS);
    ck_assert(!motion.moving);
    ck_assert_int_eq(go(0, PROFILE_TO_STOP, 7, 1000), PROFILE_STANDS);
    ck_assert(!motion.moving);
}
END_TEST

/* With 600 steps done at 0.8 + 0.12 s, and `at` as soon as they are. */
static uint64_t cruise(bool forward)
{
    ck_assert_int_eq(go(0, PROFILE_FOR_EVER, 0, forward ? 1000 : -1000), PROFILE_MOVES);
    run(920000);
    ck_assert_uint_eq(pulses, 600);
    ck_assert(motion.forward == forward);
    return 920000;
}

START_TEST(a_motion_for_ever_keeps_its_speed)
{
    cruise(_i == 0);
    run(100000000);
    ck_assert_uint_eq(tick[pulses - 1], 100000000);
    ck_assert_uint_eq(tick[0], 921000);
    ck_assert_uint_eq(pulses, 100000000 / 1000 - 920);
}
END_TEST

START_TEST(a_speed_in_the_same_direction_is_taken_on_the_way)
{
    uint64_t at = cruise(_i == 0);
    const int32_t speed = _i == 0 ? 500 : -500; /* falls by 375000 / 4000 = 93.75 steps in 0.125 s */
    ck_assert_int_eq(go(at, PROFILE_FOR_EVER, 0, speed), PROFILE_MOVES);
    ck_assert(motion.moving && motion.forward == (_i == 0));
    run(at + 1125000);
    ck_assert_uint_eq(pulses, 593); /* 93.75 + 500 */
    expect_pulse(94, at + 125000 + 500, 1);
    expect_pulse(593, at + 125000 + 998500, 1);
}
END_TEST

START_TEST(a_stop_on_the_way_takes_the_deceleration)
{
    uint64_t at = cruise(_i == 0);
    ck_assert_int_eq(go(at, PROFILE_TO_STOP, 0, 0), PROFILE_MOVES);
    ck_assert_uint_eq(motion.done, 0);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 120);
    expect_pulse(120, at + 200000, 1);
    ck_assert(!motion.moving && motion.forward == (_i == 0));
}
END_TEST

/* The ramp continues as it was, but places on it are kept rounded from here on: that makes the way of a stop no step longer. */
START_TEST(a_whole_way_of_a_stop_stays_whole_after_a_goal_on_the_way)
{
    const uint64_t at = 123457 + 2 * (uint64_t)_i;
    ck_assert_int_eq(go(0, PROFILE_FOR_EVER, 0, 900), PROFILE_MOVES);
    run(at);
    uint32_t before = pulses;
    ck_assert_int_eq(go(at, PROFILE_FOR_EVER, 0, 1000), PROFILE_MOVES);
    run(920000);
    ck_assert_uint_eq(before + pulses, 600);
    ck_assert_int_eq(go(920000, PROFILE_TO_STOP, 0, 0), PROFILE_MOVES);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 120);
}
END_TEST

START_TEST(a_place_ahead_is_reached_without_a_turn_from_the_way_of_a_stop_on)
{
    const int thousands = _i / 2, way = 120 + 1000 * thousands;
    const bool forward = _i % 2 == 0;
    uint64_t at = cruise(forward);
    ck_assert_int_eq(go(at, PROFILE_TO_PLACE, forward ? way : -way, 1000), PROFILE_MOVES);
    ck_assert(motion.forward == forward);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, (unsigned)way);
    expect_pulse(pulses, at + 200000 + 1000000 * (uint64_t)thousands, 1);
}
END_TEST

/* Half a step after the last pulse: from there a stop takes 120.5 steps. */
START_TEST(a_place_ahead_must_leave_room_for_the_part_of_a_step_that_is_done)
{
    cruise(true);
    ck_assert_int_eq(go(920500, PROFILE_TO_PLACE, 120 + _i, 1000), _i == 0 ? PROFILE_TURNS : PROFILE_MOVES);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 121);
}
END_TEST

/* Stop after 120 steps, then from rest to where it was to go. */
static void expect_turn(uint64_t at, int64_t left, bool forward)
{
    ck_assert(motion.moving);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 120);
    expect_pulse(120, at + 200000, 1);
    ck_assert(motion.forward == forward);
    at = tick[pulses - 1];
    ck_assert_int_eq(go(at, PROFILE_TO_PLACE, left, 1000), PROFILE_MOVES);
    ck_assert(motion.forward == (left > 0));
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, (uint64_t)(left < 0 ? -left : left));
}

START_TEST(a_place_ahead_that_is_too_near_is_reached_by_a_turn)
{
    const int way = _i == 0 ? 119 : -119;
    uint64_t at = cruise(_i == 0);
    ck_assert_int_eq(go(at, PROFILE_TO_PLACE, way, 1000), PROFILE_TURNS);
    expect_turn(at, _i == 0 ? -1 : 1, _i == 0);
    expect_pulse(1, at + 200000 + 4951, 1); /* to the root of 41600 steps/s, and down again */
}
END_TEST

START_TEST(a_place_behind_or_passed_is_reached_by_a_turn)
{
    uint64_t at = cruise(true);
    ck_assert_int_eq(go(at, PROFILE_TO_PLACE, _i == 0 ? 0 : -1480, 1000), PROFILE_TURNS);
    expect_turn(at, _i == 0 ? -120 : -1600, true);
    if (_i == 1)
        expect_pulse(1600, at + 2200000, 1);
}
END_TEST

START_TEST(a_speed_in_the_other_direction_is_reached_by_a_turn)
{
    uint64_t at = cruise(_i == 0);
    ck_assert_int_eq(go(at, PROFILE_FOR_EVER, 0, _i == 0 ? -1000 : 1000), PROFILE_TURNS);
    run(RKM04_NEVER - 1);
    ck_assert_uint_eq(pulses, 120);
    at = tick[pulses - 1];
    ck_assert_int_eq(go(at, PROFILE_FOR_EVER, 0, _i == 0 ? -1000 : 1000), PROFILE_MOVES);
    ck_assert(motion.forward == (_i == 1));
    run(at + 1800000);
    ck_assert_uint_eq(pulses, 1480);
    expect_pulse(480, at + 800000, 0);
}
END_TEST

/* No ramps: start_speed is the highest there is. */
START_TEST(without_ramps_a_stop_and_a_turn_take_no_step)
{
    struct profile_goal goal = usual;
    goal.kind = PROFILE_FOR_EVER;
    goal.start_speed = RKM04_SPEED_MAX;
    ck_assert_int_eq(profile_go(&motion, 0, RATE, &goal), PROFILE_MOVES);
    run(10000);
    ck_assert_uint_eq(pulses, 10);
    expect_pulse(1, 1000, 0);
    switch (_i) {
    case 0:
        goal.kind = PROFILE_TO_STOP;
        ck_assert_int_eq(profile_go(&motion, 10000, RATE, &goal), PROFILE_STANDS);
        ck_assert(!motion.moving);
        break;
    case 1:
        goal.kind = PROFILE_TO_PLACE;
        goal.way = 0;
        ck_assert_int_eq(profile_go(&motion, 10000, RATE, &goal), PROFILE_STANDS);
        ck_assert(!motion.moving);
        break;
    default:
        goal.speed = -500;
        ck_assert_int_eq(profile_go(&motion, 10000, RATE, &goal), PROFILE_MOVES);
        ck_assert(motion.moving && !motion.forward);
        run(20000);
        ck_assert_uint_eq(pulses, 5);
        expect_pulse(1, 12000, 0);
        break;
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("profile_goal");
    TCase *goal = tcase_create("goal");
    tcase_add_checked_fixture(goal, setup, NULL);
    tcase_add_loop_test(goal, a_motion_from_rest_has_its_two_accelerations_in_both_directions, 0, 2);
    tcase_add_test(goal, a_motion_that_does_not_reach_its_speed_has_its_peak_where_both_accelerations_meet);
    tcase_add_test(goal, an_axis_at_rest_stays_there_without_a_way_and_when_it_is_to_stop);
    tcase_add_loop_test(goal, a_motion_for_ever_keeps_its_speed, 0, 2);
    tcase_add_loop_test(goal, a_speed_in_the_same_direction_is_taken_on_the_way, 0, 2);
    tcase_add_loop_test(goal, a_stop_on_the_way_takes_the_deceleration, 0, 2);
    tcase_add_loop_test(goal, a_whole_way_of_a_stop_stays_whole_after_a_goal_on_the_way, 0, 40);
    tcase_add_loop_test(goal, a_place_ahead_is_reached_without_a_turn_from_the_way_of_a_stop_on, 0, 6);
    tcase_add_loop_test(goal, a_place_ahead_must_leave_room_for_the_part_of_a_step_that_is_done, 0, 2);
    tcase_add_loop_test(goal, a_place_ahead_that_is_too_near_is_reached_by_a_turn, 0, 2);
    tcase_add_loop_test(goal, a_place_behind_or_passed_is_reached_by_a_turn, 0, 2);
    tcase_add_loop_test(goal, a_speed_in_the_other_direction_is_reached_by_a_turn, 0, 2);
    tcase_add_loop_test(goal, without_ramps_a_stop_and_a_turn_take_no_step, 0, 3);
    suite_add_tcase(suite, goal);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
