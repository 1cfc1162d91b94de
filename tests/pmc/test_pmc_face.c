/* SPDX-License-Identifier: MIT */
/* What a PMC and what is plugged into it have in common: faces, inputs and their levels, pulse widths, limits by hand. */
#include <stdlib.h>

#include "pmc_rig.h"

/* ---- A face that does something at a time of its own ---- */

static uint64_t due, acted_at;
static unsigned acts, resets;
static int32_t way; /* of the move that it asks for; 0: none */

static uint64_t next_due(const struct pmc_unit *asked)
{
    ck_assert_ptr_eq(asked, &unit);
    return due;
}

static void act(struct pmc_unit *asked)
{
    acted_at = pmc_now(asked);
    due = PMC_NEVER;
    acts++;
    const struct pmc_request request = {.kind = PMC_MOVE_BY, .axes = 1, .value = {way}};
    if (way != 0)
        ck_assert_int_eq(pmc_request(asked, &request), PMC_OK);
}

static void reset(struct pmc_unit *asked)
{
    ck_assert_uint_eq(pmc_now(asked) % SLOT, 0);
    resets++;
}

static const struct pmc_face timed = {.name = "timed", .due = next_due, .act = act, .reset = reset}, idle = {.name = "idle"};

static void begin(const struct pmc_face *face)
{
    const struct pmc_config config = {.axes = 2, .face = face};
    due = PMC_NEVER;
    acted_at = acts = resets = 0;
    way = 0;
    pmc_rig_begin(&config);
}

START_TEST(AT3_a_face_acts_at_its_tick)
{
    begin(&timed);
    pmc_advance(&unit, SLOT + 1);
    due = 20003;
    ck_assert_uint_eq(pmc_next_event(&unit), 20003);
    ck_assert_uint_eq(pmc_next_report(&unit), 20003);
    pmc_advance(&unit, 20003 - SLOT - 1);
    ck_assert_uint_eq(acts, 0);
    pmc_advance(&unit, 1);
    ck_assert_uint_eq(acts, 1);
    ck_assert_uint_eq(acted_at, 20003);
    ck_assert_uint_eq(pmc_now(&unit), 20004);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    begin(&timed);
    due = 0; /* at once, at the first tick there is */
    pmc_advance(&unit, 1);
    ck_assert_uint_eq(acts, 1);
    ck_assert_uint_eq(acted_at, 0);
}
END_TEST

START_TEST(AT2_what_a_face_asks_for_at_a_slot_acts_in_it)
{
    begin(&timed);
    way = 3;
    due = 5 * SLOT;
    must(PMC_JOG, 2, 0, 1); /* pulses of the other axis go on across it */
    pmc_advance(&unit, 20 * SLOT);
    ck_assert_uint_eq(acted_at, 5 * SLOT);
    ck_assert_uint_eq(happening[1].tick, 5 * SLOT);
    ck_assert_int_eq(happening[1].what, PMC_EVENT_MOTION);
    ck_assert_uint_eq(pulses[1], 1);
    ck_assert_uint_eq(pulse[1][0], 88000);
}
END_TEST

START_TEST(AU5_reset_reaches_the_face_in_the_slot)
{
    begin(&timed);
    run_to_slot(3);
    must(PMC_RESET, 0, 0, 0);
    ck_assert_uint_eq(resets, 0);
    run_through_slot(3);
    ck_assert_uint_eq(resets, 1);
    begin(&idle);
    must(PMC_RESET, 0, 0, 0);
    run_through_slot(1);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
}
END_TEST

/* ---- Inputs ---- */

START_TEST(AU4_levels_of_inputs)
{
    begin(NULL);
    rig_inputs(0x5541);
    ck_assert_uint_eq(pmc_inputs(&unit), 0x5541);
    ck_assert_uint_eq(axis_state(0).inputs, 0); /* not looked at yet */
    run_through_slot(1);
    ck_assert_uint_eq(axis_state(0).inputs, 0x41);
    ck_assert_uint_eq(axis_state(1).inputs, 0x55);
    /* Each level of its own: what is active at 0 is the opposite of the wire. */
    static const struct {
        enum pmc_parameter which;
        int32_t value;
        unsigned active;
    } rows[] = {{PMC_STEPS, 0x1E03, PMC_NEAR}, {PMC_STEPS, 0x1D03, PMC_HOME}, {PMC_STEPS, 0x1B03, PMC_Z},
                {PMC_STEPS, 0x1703, PMC_IN0},  {PMC_STEPS, 0x0F03, PMC_IN1},
                {PMC_FLAGS, 0x0121, PMC_LIMIT_PLUS | PMC_LIMIT_MINUS}};
    for (unsigned i = 0; i < 6; i++) {
        struct pmc_parameters parameters;
        pmc_parameters_clear(&parameters);
        parameters.value[rows[i].which] = rows[i].value;
        ck_assert_int_eq(pmc_set_parameters(&unit, 1, &parameters), PMC_OK);
        run_through_slot(2 + i);
        ck_assert_uint_eq(axis_state(1).inputs, 0x55 ^ rows[i].active);
        ck_assert_uint_eq(axis_state(0).inputs, 0x41);
    }
    rig_inputs(PMC_EMG);
    run_through_slot(10);
    ck_assert_uint_eq(axis_state(0).inputs, PMC_EMG);
    ck_assert_uint_eq(axis_state(1).inputs, PMC_EMG | PMC_LIMIT_PLUS | PMC_LIMIT_MINUS);
    set(1, PMC_STEPS, 0);
    rig_inputs(0);
    run_through_slot(11);
    ck_assert_uint_eq(axis_state(1).inputs, 0x7F);
}
END_TEST

/* ---- Pulses ---- */

START_TEST(AT5_width_of_a_pulse)
{
    static const struct {
        int32_t m, speed;
        unsigned ticks;
    } rows[] = {{1, 1, 80}, {10, 5000, 80}, {10, 5001, 79}, {10, 8000, 50}, {500, 7999, 1}, {500, 4001, 1}, {500, 4000, 2}};
    begin(NULL);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), 80); /* none has come yet */
    set(0, PMC_MULTIPLIER, rows[_i].m);
    must(PMC_SET_SPEED, 1, rows[_i].speed, 0);
    must(PMC_MOVE_BY, 1, 3, 0); /* does not reach it */
    run_through_slot(1);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), rows[_i].ticks);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
}
END_TEST

START_TEST(AT5_the_highest_speed_there_was_counts)
{
    begin(NULL);
    must(PMC_SET_SPEED, 1, 8000, 0);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(10);
    must(PMC_SET_SPEED, 1, 100, 0);
    run_through_slot(11);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), 50);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(13);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), 80);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_MOVE_BY, 1, 150, 0);
    while (axis_state(0).made < 140)
        run_to(pmc_now(&unit) + 80);
    must(PMC_SET_SPEED, 1, 8000, 0); /* on the final ramp it changes nothing */
    run_to(pmc_now(&unit) + SLOT);
    ck_assert(axis_state(0).moving);
    ck_assert_uint_eq(pmc_pulse_ticks(&unit, 0), 80);
}
END_TEST

/* ---- Reports ---- */

/* What was reported of X, and of outputs, from the first report on. */
static void check_reports(const struct happening *expected, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct happening *got = &happening[i];
        ck_assert_msg(i < happenings && got->tick == expected[i].tick && got->kind == expected[i].kind &&
                          got->what == expected[i].what && got->value == expected[i].value,
                      "report %u", (unsigned)i);
    }
    ck_assert_uint_eq(happenings, count);
}

START_TEST(AT1_every_change_is_reported_once_with_its_tick)
{
    static const struct happening expected[] = {
        {1 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_COMMAND, 1}, /* INC -1 */
        {1 * SLOT, HAPPENED_DIRECTION, 0, 0, false},
        {1 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_MOTION, 1},
        {1 * SLOT + 80000, HAPPENED_EVENT, 0, PMC_EVENT_MOTION, 0}, /* at its pulse */
        {12 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_COMMAND, 2}, /* OUT OUT0 ON */
        {12 * SLOT, HAPPENED_OUTPUTS, 0, 0, 1},
        {13 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_COMMAND, 3}, /* RPE */
        {13 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_ERRORS, PMC_ERROR_PGM},
        {13 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_COMMAND, 0},
        {20 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_ERRORS, 0}, /* a clear, CLL */
        {20 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_POSITION, 0},
        {30 * SLOT, HAPPENED_DIRECTION, 0, 0, true}, /* JOG */
        {30 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_MOTION, 1},
        {40 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_MOTION, 0}, /* RST */
        {40 * SLOT, HAPPENED_EVENT, 0, PMC_EVENT_POSITION, 0},
        {40 * SLOT, HAPPENED_OUTPUTS, 0, 0, 0},
    };
    begin(NULL);
    reg(0, 0, (struct pmc_command){.op = PMC_INC, .value = -10, .speed = 1});
    reg(0, 1, (struct pmc_command){.op = PMC_OUT, .argument = 1});
    reg(0, 2, (struct pmc_command){.op = PMC_RPE});
    must(PMC_RUN, 1, 0, 0);
    run_through_slot(19);
    must(PMC_CLEAR_ERRORS, 1, 0, 0);
    must(PMC_CLEAR_COMMANDED, 1, 0, 0);
    run_through_slot(20);
    must(PMC_CLEAR_ERRORS, 1, 0, 0); /* nothing changes */
    must(PMC_CLEAR_COMMANDED, 1, 0, 0);
    run_through_slot(29);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(39);
    must(PMC_RESET, 0, 0, 0);
    run_through_slot(45);
    check_reports(expected, sizeof expected / sizeof *expected);
}
END_TEST

/* ---- Limits and searches by hand ---- */

START_TEST(AL1_the_limit_in_the_other_direction)
{
    begin(NULL);
    set(0, PMC_SOFT_MINUS, -500);
    set(0, PMC_SOFT_PLUS, -8388608);
    must(PMC_JOG, 1, -1, 0); /* beyond the upper limit already: away from it is free */
    must(PMC_SET_SPEED, 1, 1000, 0);
    run_through_slot(69);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, -500);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_MINUS);
    must(PMC_MOVE_TO, 1, -500, 0); /* no way, no limit */
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, 0);
    must(PMC_MOVE_TO, 1, -501, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_MINUS);
    must(PMC_MOVE_BY, 1, 1, 0); /* from beyond the upper limit, further */
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
    ck_assert_uint_eq(pulses[0], 500);
}
END_TEST

START_TEST(AL1_a_move_to_the_very_limit)
{
    begin(NULL);
    set(0, PMC_SOFT_PLUS, 500);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_MOVE_TO, 1, 500, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, 0); /* does not pass it */
    must(PMC_CLEAR_COMMANDED, 1, 0, 0);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(80);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
    ck_assert_int_lt(axis_state(0).commanded, 500);
    ck_assert_int_eq(axis_state(0).errors, 0); /* stopped short of it */
    must(PMC_JOG, 1, 1, 0);
    while (axis_state(0).commanded < 499)
        run_to(pmc_now(&unit) + 80);
    must(PMC_STOP, 1, 0, 0); /* on its final ramp */
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, 500);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
}
END_TEST

START_TEST(AL1_limits_stay_within_the_counter)
{
    begin(NULL);
    set(0, PMC_NUMERATOR, 65535);
    set(0, PMC_DENOMINATOR, 1);
    unit.axis[0].commanded = PMC_COUNTER_MAX - 2;
    must(PMC_JOG, 1, 1, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, PMC_COUNTER_MAX);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_PLUS);
    set(0, PMC_SOFT_MINUS, -8388608);
    unit.axis[0].commanded = PMC_COUNTER_MIN + 2;
    must(PMC_JOG, 1, -1, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, PMC_COUNTER_MIN);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_SL_MINUS);
}
END_TEST

START_TEST(AL3_limit_switches_and_ramps)
{
    /* Seen in the ramp of a stop: an error all the same; at once where flag 0 says so. Seen when no pulse is to come: none. */
    begin(NULL);
    set(0, PMC_FLAGS, _i == 0 ? 0x0123 : 0x0122);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_JOG, 1, -1, 0);
    run_through_slot(50);
    must(PMC_STOP, 1, 0, 0);
    run_through_slot(55);
    rig_inputs(PMC_LIMIT_PLUS);
    run_through_slot(56);
    ck_assert_int_eq(axis_state(0).errors, 0); /* the other way */
    rig_inputs(PMC_LIMIT_MINUS);
    run_through_slot(57);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_MINUS);
    ck_assert(axis_state(0).moving == (_i == 0));
    run_until_idle(0);
    must(PMC_JOG, 1, -1, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_MINUS);
    must(PMC_MOVE_BY, 1, 1, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, 0);
    rig_inputs(0);
    must(PMC_MOVE_BY, 1, 1, 0);
    while (axis_state(0).moving || axis_state(0).made == 0)
        run_to(pmc_now(&unit) + 8);
    rig_inputs(PMC_LIMIT_PLUS);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AL3_an_error_that_is_cleared_on_the_ramp_comes_again)
{
    begin(NULL);
    must(PMC_SET_SPEED, 1, 1000, 0);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(50);
    rig_inputs(PMC_LIMIT_PLUS);
    run_through_slot(51);
    must(PMC_CLEAR_ERRORS, 1, 0, 0);
    run_through_slot(52);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert(axis_state(0).moving);
    run_through_slot(53);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_PLUS);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_PLUS);
    must(PMC_CLEAR_ERRORS, 1, 0, 0);
    run_to(pmc_now(&unit) + 3 * SLOT);
    ck_assert_int_eq(axis_state(0).errors, 0); /* at rest it is none */
}
END_TEST

START_TEST(AL3_a_search_that_is_ended_meets_the_limit_in_the_next_slot)
{
    begin(NULL);
    set(0, PMC_STEPS, 0x1F01);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(50);
    must(PMC_STOP, 1, 0, 0);
    rig_inputs(PMC_LIMIT_MINUS);
    run_through_slot(51);
    ck_assert_int_eq(axis_state(0).errors, 0); /* in the slot of STO the search looks at it itself */
    run_through_slot(52);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_MINUS);
    run_until_idle(0);
}
END_TEST

START_TEST(AH3_near_and_a_limit_that_stops_at_once_in_one_slot)
{
    begin(NULL);
    set(0, PMC_FLAGS, 0x0122);
    set(0, PMC_STEPS, 0x1F01);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(50);
    rig_inputs(PMC_NEAR | PMC_LIMIT_MINUS);
    run_through_slot(51);
    ck_assert(axis_state(0).stopping); /* the sensor counts */
    run_through_slot(52);
    ck_assert(!axis_state(0).moving); /* and the limit in the ramp */
    run_until_idle(0);
    ck_assert(axis_state(0).homed);
}
END_TEST

START_TEST(AL3_each_axis_decides_for_itself)
{
    begin(NULL);
    rig_inputs(PMC_LIMIT_PLUS);
    must(PMC_JOG, 3, 1, 1);
    run_through_slot(3);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HL_PLUS);
    ck_assert(!axis_state(0).moving);
    ck_assert_int_eq(axis_state(1).errors, 0);
    ck_assert(axis_state(1).moving);
}
END_TEST

START_TEST(AH4_the_limit_a_second_time)
{
    begin(NULL);
    set(0, PMC_STEPS, 0x1F02);
    set(0, PMC_HOME_LOW, 1000);
    must(PMC_SEARCH, 1, 0, 0);
    static const uint16_t levels[] = {0, PMC_LIMIT_MINUS, 0, PMC_HOME, 0, PMC_LIMIT_MINUS};
    for (unsigned i = 0; i < 6; i++) {
        rig_inputs(levels[i]);
        run_through_slot(5 + 5 * i);
        ck_assert_int_eq(axis_state(0).errors, i < 5 ? 0 : PMC_ERROR_HOM);
    }
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
}
END_TEST

START_TEST(AU5_only_a_search_at_power_on)
{
    const struct pmc_config config = {.axes = 2};
    begin(NULL);
    set(0, PMC_FLAGS, 0x0163);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    pmc_rig_restart(&config);
    rig_inputs(PMC_NEAR | PMC_HOME);
    run_through_slot(5);
    rig_inputs(PMC_NEAR);
    run_through_slot(10);
    rig_inputs(PMC_NEAR | PMC_HOME);
    run_through_slot(20);
    ck_assert(axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert_int_eq(axis_state(0).reg, -1);
}
END_TEST

static Suite *face_suite(void)
{
    Suite *suite = suite_create("pmc_face");
    TCase *all = tcase_create("face"), *limits = tcase_create("limits");
    tcase_add_test(all, AT3_a_face_acts_at_its_tick);
    tcase_add_test(all, AT2_what_a_face_asks_for_at_a_slot_acts_in_it);
    tcase_add_test(all, AU5_reset_reaches_the_face_in_the_slot);
    tcase_add_test(all, AU4_levels_of_inputs);
    tcase_add_loop_test(all, AT5_width_of_a_pulse, 0, 7);
    tcase_add_test(all, AT1_every_change_is_reported_once_with_its_tick);
    tcase_add_test(all, AT5_the_highest_speed_there_was_counts);
    tcase_add_test(limits, AL1_the_limit_in_the_other_direction);
    tcase_add_test(limits, AL1_a_move_to_the_very_limit);
    tcase_add_test(limits, AL1_limits_stay_within_the_counter);
    tcase_add_loop_test(limits, AL3_limit_switches_and_ramps, 0, 2);
    tcase_add_test(limits, AL3_an_error_that_is_cleared_on_the_ramp_comes_again);
    tcase_add_test(limits, AL3_a_search_that_is_ended_meets_the_limit_in_the_next_slot);
    tcase_add_test(limits, AH3_near_and_a_limit_that_stops_at_once_in_one_slot);
    tcase_add_test(limits, AL3_each_axis_decides_for_itself);
    tcase_add_test(limits, AH4_the_limit_a_second_time);
    tcase_add_test(limits, AU5_only_a_search_at_power_on);
    suite_add_tcase(suite, all);
    suite_add_tcase(suite, limits);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(face_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
