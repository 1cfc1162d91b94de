/* SPDX-License-Identifier: MIT */
/* Home search of a PMC: the examples of docs/PMC.md, and what else may come in its way. */
#include <stdlib.h>

#include "pmc_rig.h"

static const struct pmc_config two_axes = {.axes = 2};

/* The plant of AX35. */
static const struct rig_switch usual[] = {{PMC_NEAR, -RIG_FAR, 1000, 10}, {PMC_HOME, -RIG_FAR, 200, 5}};

static void begin(int32_t position, const struct rig_switch *switches, size_t count)
{
    pmc_rig_begin(&two_axes);
    rig_plant(0, position, switches, count);
}

/* Search from slot 1 and go on to its end. Returns the slot of that. */
static uint64_t search(void)
{
    must(PMC_SEARCH, 1, 0, 0);
    uint64_t slot = 0;
    while (axis_state(0).driving & 4)
        run_through_slot(++slot);
    return slot;
}

START_TEST(AX35_from_beyond_near)
{
    begin(5000, usual, 2);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(411);
    ck_assert(axis_state(0).stopping);
    run_to_slot(432);
    ck_assert_uint_eq(pulse[0][pulses[0] - 1], 3448000);
    ck_assert_int_eq(rig_true(0), 890);
    run_to_slot(3883);
    ck_assert_int_eq(axis_state(0).state, PMC_SEARCHING);
    run_through_slot(3883);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert_uint_eq(pulse[0][pulses[0] - 1], 31056000);
    ck_assert_int_eq(rig_true(0), 200);
    ck_assert_int_eq(axis_state(0).commanded, 0);
    ck_assert_int_eq(axis_state(0).actual, 0);
    ck_assert(axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX36_from_between_near_and_home)
{
    begin(600, usual, 2);
    ck_assert_uint_eq(search(), 2002);
    ck_assert_int_eq(rig_true(0), 200);
    ck_assert_uint_eq(pulse[0][399], 2001 * SLOT);
    ck_assert_uint_eq(pulses[0], 400);
}
END_TEST

START_TEST(AX36_from_on_home)
{
    begin(100, usual, 2);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(532);
    ck_assert_int_eq(rig_true(0), 206);
    ck_assert_uint_eq(pulses[0], 106);
    run_through_slot(563);
    ck_assert_uint_eq(pulses[0], 112);
    ck_assert_int_eq(rig_true(0), 200);
    ck_assert(axis_state(0).homed);
}
END_TEST

START_TEST(AX36_sensor_and_limit_in_one_slot)
{
    static const struct rig_switch both[] = {{PMC_HOME, -RIG_FAR, 0, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 0, 0}};
    begin(500, both, 2);
    set(0, PMC_STEPS, 0x1F02);
    set(0, PMC_HOME_LOW, 1000);
    ck_assert_uint_eq(search(), 53);
    ck_assert_uint_eq(pulse[0][pulses[0] - 1], 416000);
    ck_assert_int_eq(rig_true(0), -10);
    ck_assert(axis_state(0).homed);
}
END_TEST

START_TEST(AX37_on_the_wrong_side)
{
    static const struct rig_switch switches[] = {
        {PMC_NEAR, 2000, 2400, 10}, {PMC_HOME, 2100, 2300, 5}, {PMC_LIMIT_MINUS, -RIG_FAR, -300, 0}};
    begin(1500, switches, 3);
    must(PMC_SEARCH, 1, 0, 0);
    run_to_slot(191);
    ck_assert(!axis_state(0).stopping);
    run_through_slot(191);
    ck_assert(axis_state(0).stopping);
    run_to_slot(212);
    ck_assert_int_eq(rig_true(0), -410);
    run_to_slot(12763);
    ck_assert(axis_state(0).moving);
    run_through_slot(12763);
    run_through_slot(13794);
    ck_assert_int_eq(rig_true(0), 2306);
    run_to_slot(13825);
    ck_assert_int_eq(axis_state(0).state, PMC_SEARCHING);
    run_through_slot(13825);
    ck_assert_int_eq(rig_true(0), 2300);
    ck_assert(axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX38_no_home_switch)
{
    static const struct rig_switch switches[] = {
        {PMC_NEAR, -RIG_FAR, 1000, 10}, {PMC_LIMIT_MINUS, -RIG_FAR, -300, 0}, {PMC_LIMIT_PLUS, 6000, RIG_FAR, 0}};
    begin(5000, switches, 3);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(6383);
    ck_assert_int_eq(rig_true(0), -300);
    run_to_slot(37884);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_through_slot(37884);
    ck_assert_int_eq(rig_true(0), 6000);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert(!axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
}
END_TEST

START_TEST(AX38_limits_on_both_sides)
{
    static const struct rig_switch switches[] = {
        {PMC_HOME, -RIG_FAR, 100, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 10000, 0}, {PMC_LIMIT_PLUS, 20000, RIG_FAR, 0}};
    begin(50, switches, 3);
    set(0, PMC_STEPS, 0x1F02);
    set(0, PMC_HOME_LOW, 8000);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(2);
    ck_assert_int_eq(rig_true(0), 130);
    ck_assert(!axis_state(0).moving);
    run_through_slot(3);
    ck_assert(axis_state(0).forward);
    run_to_slot(252);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_through_slot(252);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert_int_eq(rig_true(0), 20050);
}
END_TEST

START_TEST(AX39_offset)
{
    begin(5000, usual, 2);
    set(0, PMC_STEPS, 0x1F8B);
    set(0, PMC_HOME_OFFSET, 1000);
    ck_assert_uint_eq(search(), 4002);
    ck_assert_int_eq(rig_true(0), 1200);
    ck_assert_int_eq(axis_state(0).commanded, 0);
}
END_TEST

START_TEST(AX39_no_step)
{
    begin(5000, usual, 2);
    set(0, PMC_STEPS, 0x1F00);
    ck_assert_uint_eq(search(), 1);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert_uint_eq(pulses[0], 0);
    ck_assert(!axis_state(0).homed);
}
END_TEST

START_TEST(AX54_search_and_program_at_power_on)
{
    begin(0, NULL, 0);
    set(0, PMC_FLAGS, 0x01E3);
    reg(0, 0, (struct pmc_command){.op = PMC_ABS, .value = 1000, .speed = 3});
    reg(0, 1, (struct pmc_command){.op = PMC_END});
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    pmc_rig_restart(&two_axes);
    rig_plant(0, 5000, usual, 2);
    run_to_slot(100);
    ck_assert_uint_eq(axis_state(0).driving, 5); /* the program has not begun */
    run_to_slot(3883);
    ck_assert_uint_eq(slot_of_reg(0, 0, 0), 0);
    const size_t before = pulses[0];
    run_to_slot(4500);
    ck_assert_uint_eq(slot_of_reg(0, 0, 0), 3883);
    ck_assert_uint_eq(pulse[0][before], 31073889);
    ck_assert_int_eq(axis_state(0).commanded, 100);
    ck_assert(!axis_state(0).not_homed);
    ck_assert_uint_ne(slot_of_reg(0, 1, 0), 0);
    ck_assert_uint_eq(slot_of_reg(0, 0, 1), 0); /* once */
    must(PMC_RESET, 0, 0, 0);
    const size_t after = pulses[0];
    run_to_slot(5000);
    ck_assert_int_eq(axis_state(0).commanded, 0);
    ck_assert(!axis_state(0).homed);
    ck_assert_uint_eq(pulses[0], after);
}
END_TEST

START_TEST(AU5_no_program_where_the_search_ends_badly)
{
    static const struct rig_switch limits[] = {{PMC_LIMIT_MINUS, -RIG_FAR, 0, 0}, {PMC_LIMIT_PLUS, 0, RIG_FAR, 0}};
    begin(0, NULL, 0);
    set(0, PMC_FLAGS, 0x01E3);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    pmc_rig_restart(&two_axes);
    if (_i == 0)
        rig_plant(0, 0, limits, 2);
    else
        rig_plant(0, 5000, usual, 2);
    run_through_slot(100);
    if (_i == 1)
        must(PMC_STOP, 1, 0, 0);
    if (_i == 2)
        rig_inputs(PMC_EMG);
    run_to_slot(200);
    if (_i == 2) {
        rig_inputs(0);
        must(PMC_SEARCH, 1, 0, 0); /* one that ends well, but it is not that of power-on */
    }
    run_to_slot(6000);
    ck_assert_uint_eq(slot_of_reg(0, 0, 0), 0);
    ck_assert(axis_state(0).homed == (_i == 2));
}
END_TEST

/* ---- Beside the examples ---- */

START_TEST(AH3_a_limit_that_stops_at_once)
{
    static const struct rig_switch switches[] = {{PMC_HOME, 300, 400, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, -300, 0}};
    begin(1000, switches, 2);
    set(0, PMC_FLAGS, 0x0122);
    set(0, PMC_HOME_LOW, 500);
    must(PMC_SEARCH, 1, 0, 0);
    while (!axis_state(0).forward || axis_state(0).moving == false)
        run_through_slot((pmc_now(&unit) + SLOT - 1) / SLOT);
    ck_assert_int_ge(rig_true(0), -312); /* no ramp */
    run_until_idle(0);
    ck_assert(axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AH3_a_limit_in_the_ramp_after_near)
{
    static const struct rig_switch switches[] = {
        {PMC_NEAR, -RIG_FAR, 1000, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 950, 0}, {PMC_HOME, 1200, 1300, 0}};
    int32_t lowest[2];
    for (int slow = 0; slow < 2; slow++) {
        begin(5000, switches, 3);
        set(0, PMC_FLAGS, slow ? 0x0123 : 0x0122);
        set(0, PMC_HOME_LOW, 100);
        must(PMC_SEARCH, 1, 0, 0);
        while (!axis_state(0).forward || !axis_state(0).moving)
            run_through_slot((pmc_now(&unit) + SLOT - 1) / SLOT);
        lowest[slow] = rig_true(0);
        run_until_idle(0);
        ck_assert(axis_state(0).homed);
        ck_assert_int_eq(axis_state(0).errors, 0);
    }
    ck_assert_int_ge(lowest[0], 940);
    ck_assert_int_le(lowest[1], 900);
}
END_TEST

START_TEST(AH4_step_3)
{
    /* Active at its begin, a limit at its begin, a limit under way, and found. */
    static const struct rig_switch rows[][3] = {
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_Z, -RIG_FAR, 250, 0}, {0}},
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_Z, -RIG_FAR, 100, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 200, 0}},
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_Z, -RIG_FAR, 100, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 150, 0}},
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_Z, -RIG_FAR, 100, 0}, {PMC_LIMIT_MINUS, -RIG_FAR, 99, 0}},
    };
    static const int32_t end[] = {200, 200, 150, 100};
    begin(300, rows[_i], _i == 0 ? 2 : 3);
    set(0, PMC_STEPS, 0x1F06);
    search();
    run_until_idle(0);
    ck_assert_int_eq(rig_true(0), end[_i]);
    ck_assert(axis_state(0).homed == (_i == 3));
    ck_assert_int_eq(axis_state(0).errors, _i == 3 ? 0 : PMC_ERROR_HOM);
}
END_TEST

START_TEST(AH5_limits_of_step_4)
{
    static const struct rig_switch rows[][2] = {
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_LIMIT_PLUS, 150, RIG_FAR, 0}},
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_LIMIT_PLUS, 400, RIG_FAR, 0}},
        {{PMC_HOME, -RIG_FAR, 200, 5}, {PMC_LIMIT_PLUS, 1201, RIG_FAR, 0}},
    };
    begin(300, rows[_i], 2);
    set(0, PMC_STEPS, 0x1F8A);
    set(0, PMC_HOME_OFFSET, _i == 0 ? 0 : 1000);
    search();
    run_until_idle(0);
    ck_assert(axis_state(0).homed == (_i != 1));
    ck_assert_int_eq(axis_state(0).errors, _i == 1 ? PMC_ERROR_HOM : 0);
    if (_i == 1)
        ck_assert_int_lt(rig_true(0), 450);
    else
        ck_assert_int_eq(rig_true(0), _i == 0 ? 200 : 1200);
}
END_TEST

START_TEST(AH6_counters_are_kept_with_flag_8_off)
{
    begin(600, usual, 2);
    set(0, PMC_FLAGS, 0x0023);
    search();
    ck_assert_int_eq(axis_state(0).commanded, -400);
    ck_assert_int_eq(axis_state(0).actual, -400);
    ck_assert(axis_state(0).homed);
    must(PMC_SEARCH, 1, 0, 0);
    run_through_slot(2003);
    ck_assert(!axis_state(0).homed); /* the begin of another search */
}
END_TEST

START_TEST(AH6_too_many_pulses)
{
    begin(0, NULL, 0);
    unit.axis[0].parameters.value[PMC_MULTIPLIER] = 500;
    set(0, PMC_HOME_HIGH, 8000);
    set(0, PMC_HOME_LOW, 8000);
    set(0, PMC_ACCELERATION, 8000);
    set(0, PMC_STEPS, _i == 0 ? 0x1F01 : 0x1F12);
    static const struct pmc_port quiet;
    unit.port = &quiet;
    must(PMC_SEARCH, 1, 0, 0);
    run_to_slot(4150);
    ck_assert_int_eq(axis_state(0).state, PMC_SEARCHING);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert_int_eq(axis_state(0).commanded, 0); /* 2^24 is once round the counter */
    ck_assert_uint_eq(unit.axis[0].motion.made, 1u << 24);
}
END_TEST

START_TEST(AH6_stop_of_a_search)
{
    begin(5000, usual, 2);
    must(PMC_SEARCH, 1, 0, 0);
    run_to_slot(100);
    must(_i == 0 ? PMC_STOP : PMC_STOP_NOW, 1, 0, 0);
    run_through_slot(100);
    ck_assert_int_eq(axis_state(0).state, _i == 0 ? PMC_MANUAL : PMC_IDLE);
    ck_assert(axis_state(0).stopping == (_i == 0));
    run_until_idle(0);
    ck_assert(!axis_state(0).homed);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(0).commanded, rig_true(0) - 5000);
}
END_TEST

START_TEST(AL4_emergency_in_a_search)
{
    begin(5000, usual, 2);
    must(PMC_SEARCH, 1, 0, 0);
    run_to_slot(100);
    rig_inputs(PMC_EMG);
    run_through_slot(100);
    const size_t made = pulses[0];
    run_to_slot(200);
    ck_assert_uint_eq(pulses[0], made);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_EMG);
    must(PMC_SEARCH, 1, 0, 0);
    run_to_slot(210);
    ck_assert_uint_eq(pulses[0], made);
}
END_TEST

START_TEST(AM7_the_fifth_speed_does_not_touch_a_search)
{
    begin(5000, usual, 2);
    must(PMC_SEARCH, 1, 0, 0);
    for (unsigned slot = 1; slot < 4000; slot += 50) {
        run_to_slot(slot);
        must(PMC_SET_SPEED, 1, (int32_t)slot, 0);
    }
    ck_assert_uint_eq(pulse[0][pulses[0] - 1], 31056000);
    ck_assert(axis_state(0).homed);
}
END_TEST

START_TEST(AT4_a_search_in_a_program)
{
    /* The command behind it is executed in the slot in which it ends; without a pulse it takes one slot. */
    begin(600, usual, 2);
    reg(0, 0, (struct pmc_command){.op = PMC_HOM});
    reg(0, 1, (struct pmc_command){.op = PMC_END});
    if (_i == 1) {
        set(0, PMC_STEPS, 0x1F01); /* near is active already */
        rig_plant(0, 600, usual, 1);
    }
    must(PMC_RUN, 1, 0, 0);
    run_through_slot(1);
    ck_assert_int_eq(axis_state(0).state, _i == 0 ? PMC_SEARCHING : PMC_PROGRAM);
    ck_assert_uint_eq(axis_state(0).driving, _i == 0 ? 7 : 2);
    run_to_slot(2100);
    ck_assert_uint_eq(slot_of_reg(0, 1, 0), _i == 0 ? 2002 : 2);
    ck_assert(axis_state(0).homed);
}
END_TEST

START_TEST(AC6_an_error_of_a_search_ends_the_program)
{
    begin(600, usual, 2);
    set(0, PMC_STEPS, 0x1F00);
    reg(0, 0, (struct pmc_command){.op = PMC_HOM});
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(10);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert_uint_eq(slot_of_reg(0, 1, 0), 0);
}
END_TEST

static Suite *home_suite(void)
{
    Suite *suite = suite_create("pmc_home");
    TCase *examples = tcase_create("examples"), *more = tcase_create("more");
    tcase_set_timeout(more, 60);
    tcase_add_test(examples, AX35_from_beyond_near);
    tcase_add_test(examples, AX36_from_between_near_and_home);
    tcase_add_test(examples, AX36_from_on_home);
    tcase_add_test(examples, AX36_sensor_and_limit_in_one_slot);
    tcase_add_test(examples, AX37_on_the_wrong_side);
    tcase_add_test(examples, AX38_no_home_switch);
    tcase_add_test(examples, AX38_limits_on_both_sides);
    tcase_add_test(examples, AX39_offset);
    tcase_add_test(examples, AX39_no_step);
    tcase_add_test(examples, AX54_search_and_program_at_power_on);
    tcase_add_loop_test(more, AU5_no_program_where_the_search_ends_badly, 0, 3);
    tcase_add_test(more, AH3_a_limit_that_stops_at_once);
    tcase_add_test(more, AH3_a_limit_in_the_ramp_after_near);
    tcase_add_loop_test(more, AH4_step_3, 0, 4);
    tcase_add_loop_test(more, AH5_limits_of_step_4, 0, 3);
    tcase_add_test(more, AH6_counters_are_kept_with_flag_8_off);
    tcase_add_loop_test(more, AH6_too_many_pulses, 0, 2);
    tcase_add_loop_test(more, AH6_stop_of_a_search, 0, 2);
    tcase_add_test(more, AL4_emergency_in_a_search);
    tcase_add_test(more, AM7_the_fifth_speed_does_not_touch_a_search);
    tcase_add_loop_test(more, AT4_a_search_in_a_program, 0, 2);
    tcase_add_test(more, AC6_an_error_of_a_search_ends_the_program);
    suite_add_tcase(suite, examples);
    suite_add_tcase(suite, more);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(home_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
