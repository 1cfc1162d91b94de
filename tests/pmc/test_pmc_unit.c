/* SPDX-License-Identifier: MIT */
/* Parameters, units, requests, RST of a PMC: the examples of docs/PMC.md, and the clauses beside them. */
#include <stdlib.h>
#include <string.h>

#include "pmc_rig.h"

static const struct pmc_config two_axes = {.axes = 2};

static struct pmc_command op(enum pmc_op name, unsigned argument)
{
    return (struct pmc_command){.op = (uint8_t)name, .argument = (uint8_t)argument};
}

static struct pmc_command inc(int32_t tenths, unsigned speed, unsigned ms)
{
    return (struct pmc_command){.op = PMC_INC, .value = tenths, .speed = (uint8_t)speed, .ms = (uint16_t)ms};
}

/* ---- Parameters ---- */

START_TEST(AX13_the_deceleration_follows_until_it_is_written)
{
    struct pmc_parameters parameters;
    pmc_parameters_clear(&parameters);
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 400);
    ck_assert(pmc_parameter_put(&parameters, PMC_ACCELERATION, 52));
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 52);
    ck_assert(pmc_parameter_put(&parameters, PMC_DECELERATION, 400));
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_FLAGS), 0x0133);
    ck_assert(pmc_parameter_put(&parameters, PMC_ACCELERATION, 60));
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 400);
    ck_assert(pmc_parameter_put(&parameters, PMC_FLAGS, 0x0133)); /* the flag stays: so does the value */
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 400);
    ck_assert(pmc_parameter_put(&parameters, PMC_FLAGS, 0x0123));
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 60);
    ck_assert(pmc_parameter_put(&parameters, PMC_FLAGS, 0x0133)); /* set: what it reads stays */
    ck_assert(pmc_parameter_put(&parameters, PMC_ACCELERATION, 7));
    ck_assert_int_eq(pmc_parameter(&parameters, PMC_DECELERATION), 60);
}
END_TEST

START_TEST(AX14_what_is_refused)
{
    pmc_rig_begin(&two_axes);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_SPEED1, 8001), PMC_RANGE);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_MULTIPLIER, 0), PMC_RANGE);
    reg(0, 0, inc(1000, 3, 0));
    must(PMC_RUN, 1, 0, 0);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_SPEED3, 2000), PMC_BUSY);
    run_through_slot(2);
    const struct pmc_command command = inc(1, 1, 0);
    struct pmc_parameters parameters;
    pmc_parameters_clear(&parameters);
    ck_assert_int_eq(pmc_set_parameter(&unit, 0, PMC_SPEED3, 2000), PMC_BUSY);
    ck_assert_int_eq(pmc_set_parameters(&unit, 0, &parameters), PMC_BUSY);
    ck_assert_int_eq(pmc_set_command(&unit, 0, 5, &command), PMC_BUSY);
    ck_assert_int_eq(pmc_set_program(&unit, 0, unit.axis[1].program), PMC_BUSY);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_BUSY);
    ck_assert_int_eq(pmc_register_position(&unit, 0, 5), PMC_BUSY);
    set(1, PMC_SPEED3, 2000); /* the other axis is free */
    ck_assert_int_eq(pmc_store(&unit, 1), PMC_OK);
    ck_assert_int_eq(pmc_set_parameter(&unit, 2, PMC_SPEED3, 2000), PMC_NO_AXIS);
    ck_assert_int_eq(pmc_set_command(&unit, 1, 64, &command), PMC_RANGE);
    ck_assert_int_eq(unit.axis[0].parameters.value[PMC_SPEED3], 1000);
}
END_TEST

START_TEST(AP1_every_parameter_has_its_range_and_default)
{
    for (unsigned i = 0; i < PMC_PARAMETERS; i++) {
        const struct pmc_parameter_row *row = &pmc_parameter_rows[i];
        struct pmc_parameters parameters;
        pmc_parameters_clear(&parameters);
        ck_assert_int_eq(parameters.value[i], row->standard);
        ck_assert(pmc_parameter_put(&parameters, (enum pmc_parameter)i, row->low));
        ck_assert_int_eq(pmc_parameter(&parameters, (enum pmc_parameter)i), row->low);
        ck_assert(pmc_parameter_put(&parameters, (enum pmc_parameter)i, row->high));
        ck_assert_int_eq(pmc_parameter(&parameters, (enum pmc_parameter)i), row->high);
        ck_assert(!pmc_parameter_put(&parameters, (enum pmc_parameter)i, row->low - 1));
        ck_assert(!pmc_parameter_put(&parameters, (enum pmc_parameter)i, row->high + 1));
        ck_assert_int_eq(pmc_parameter(&parameters, (enum pmc_parameter)i), row->high);
        for (unsigned j = 0; j < i; j++)
            ck_assert_str_ne(row->key, pmc_parameter_rows[j].key);
    }
    struct pmc_parameters parameters;
    ck_assert(!pmc_parameter_put(&parameters, PMC_PARAMETERS, 1));
}
END_TEST

START_TEST(AX15_units)
{
    static const struct {
        int32_t numerator, denominator, tenths, pulses, shown;
    } rows[] = {
        {5, 1, 100, 50, 100},       {5, 1, 3, 2, 4},        {5, 3, 10, 2, 12},     {5, 3, 100, 17, 102},
        {1, 2, 10, 1, 20},          {1, 2, -10, -1, -20},   {1, 2, 9, 0, 0},       {1000, 1000, 205, 21, 210},
        {1000, 1000, -205, -21, -210}, {1, 65535, 83886070, 128, 83884800},
    };
    struct pmc_parameters parameters;
    pmc_parameters_clear(&parameters);
    parameters.value[PMC_NUMERATOR] = rows[_i].numerator;
    parameters.value[PMC_DENOMINATOR] = rows[_i].denominator;
    ck_assert_int_eq(pmc_pulses_of(&parameters, rows[_i].tenths), rows[_i].pulses);
    ck_assert_int_eq(pmc_tenths_of(&parameters, rows[_i].pulses), rows[_i].shown);
}
END_TEST

START_TEST(AX16_distances_are_rounded_one_by_one)
{
    struct pmc_parameters parameters;
    pmc_parameters_clear(&parameters);
    parameters.value[PMC_NUMERATOR] = 1;
    parameters.value[PMC_DENOMINATOR] = 3;
    ck_assert_int_eq(pmc_pulses_of(&parameters, 10), 0);
    ck_assert_int_eq(pmc_pulses_of(&parameters, 30), 1);
    pmc_rig_begin(&two_axes);
    set(0, PMC_NUMERATOR, 1);
    set(0, PMC_DENOMINATOR, 3);
    for (unsigned i = 0; i < 3; i++)
        reg(0, i, inc(10, 3, 0));
    reg(0, 3, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 0);
    ck_assert_uint_eq(pmc_now(&unit), 4 * SLOT + 1);
}
END_TEST

START_TEST(AX17_absolute_and_relative)
{
    static const int32_t way[] = {1000, 2500, -500};
    pmc_rig_begin(&two_axes);
    for (unsigned i = 0; i < 3; i++) {
        struct pmc_command command = inc(way[i], 4, 0);
        command.op = _i == 0 ? PMC_ABS : PMC_INC;
        reg(0, i, command);
    }
    reg(0, 3, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, _i == 0 ? -50 : 300);
    ck_assert_int_eq(axis_state(0).actual, axis_state(0).commanded);
    ck_assert_int_eq(reported[0], axis_state(0).commanded);
    ck_assert(axis_state(0).not_homed == (_i == 0));
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX56_register_the_position)
{
    pmc_rig_begin(&two_axes);
    set(0, PMC_NUMERATOR, 5);
    set(0, PMC_DENOMINATOR, 1);
    must(PMC_MOVE_BY, 1, 50, 0);
    run_until_idle(0);
    ck_assert_int_eq(pmc_register_position(&unit, 0, 7), PMC_OK);
    const struct pmc_command expected = {.op = PMC_ABS, .value = 100, .speed = 1};
    ck_assert_int_eq(unit.axis[0].program[7].value, expected.value);
    ck_assert_int_eq(unit.axis[0].program[7].op, PMC_ABS);
    ck_assert_int_eq(unit.axis[0].program[7].speed, 1);
    set(0, PMC_NUMERATOR, 1);
    set(0, PMC_DENOMINATOR, 65535);
    unit.axis[0].commanded = 129; /* 8 454 015 units */
    ck_assert_int_eq(pmc_register_position(&unit, 0, 7), PMC_RANGE);
    unit.axis[0].commanded = PMC_COUNTER_MAX; /* more than 32 bits */
    ck_assert_int_eq(pmc_register_position(&unit, 0, 7), PMC_RANGE);
    ck_assert_int_eq(pmc_register_position(&unit, 0, 64), PMC_RANGE);
    ck_assert_int_eq(pmc_register_position(&unit, 2, 0), PMC_NO_AXIS);
}
END_TEST

/* ---- Registers ---- */

START_TEST(AB3_only_what_a_command_uses_is_set)
{
    static const struct {
        bool valid;
        struct pmc_command command;
    } rows[] = {
        {true, {.op = PMC_NOP}},
        {false, {.op = PMC_NOP, .ms = 1}},
        {false, {.op = PMC_NOP, .value = 1}},
        {false, {.op = PMC_OPS}},
        {true, {.op = PMC_ABS, .value = -83886080, .speed = 1}},
        {true, {.op = PMC_ABS, .value = 83886070, .speed = 4, .ms = 65535}},
        {false, {.op = PMC_ABS, .value = -83886081, .speed = 1}},
        {false, {.op = PMC_ABS, .value = 83886071, .speed = 1}},
        {false, {.op = PMC_ABS, .speed = 0}},
        {false, {.op = PMC_INC, .speed = 5}},
        {true, {.op = PMC_INC, .speed = 1, .number = 3}},
        {false, {.op = PMC_INC, .speed = 1, .number = 4}},
        {false, {.op = PMC_INC, .speed = 1, .number = 1, .ms = 1}},
        {false, {.op = PMC_INC, .speed = 1, .wait = true}},
        {false, {.op = PMC_INC, .speed = 1, .argument = 1}},
        {true, {.op = PMC_IJP, .number = 1, .argument = 63}},
        {false, {.op = PMC_IJP, .number = 2}},
        {false, {.op = PMC_IJP, .argument = 64}},
        {true, {.op = PMC_OUT, .number = 1, .argument = 1}},
        {false, {.op = PMC_OUT, .number = 2}},
        {false, {.op = PMC_OUT, .argument = 2}},
        {true, {.op = PMC_OTP, .ms = 1, .wait = true}},
        {true, {.op = PMC_OTP, .ms = 65535, .number = 1}},
        {false, {.op = PMC_OTP}},
        {true, {.op = PMC_JMP, .argument = 63}},
        {false, {.op = PMC_JMP, .argument = 64}},
        {true, {.op = PMC_REP, .argument = 1}},
        {true, {.op = PMC_REP, .argument = 255}},
        {false, {.op = PMC_REP}},
        {true, {.op = PMC_TIM, .ms = 1}},
        {false, {.op = PMC_TIM}},
        {false, {.op = PMC_END, .speed = 1}},
        {true, {.op = PMC_RPE}},
        {true, {.op = PMC_HOM}},
    };
    pmc_rig_begin(&two_axes);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        ck_assert_msg(pmc_command_valid(&rows[i].command) == rows[i].valid, "row %u", (unsigned)i);
        ck_assert_int_eq(pmc_set_command(&unit, 0, 63, &rows[i].command), rows[i].valid ? PMC_OK : PMC_RANGE);
    }
}
END_TEST

/* ---- Requests ---- */

START_TEST(AX42_counters)
{
    pmc_rig_begin(&two_axes);
    must(PMC_SET_SPEED, 1, 8000, 0);
    must(PMC_MOVE_BY, 1, 100000, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, 100000);
    must(PMC_CLEAR_COMMANDED, 1, 0, 0);
    must(PMC_MOVE_BY, 1, -10, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, -10);
    ck_assert_int_eq(axis_state(0).actual, 99990);
    must(PMC_CLEAR_ACTUAL, 1, 0, 0);
    run_through_slot(1700);
    ck_assert_int_eq(axis_state(0).actual, 0);
    ck_assert_int_eq(axis_state(0).commanded, -10);
    ck_assert_uint_eq(axis_state(0).fifth, 8000);
    ck_assert_uint_eq(pulses[0], 100010);
}
END_TEST

START_TEST(AX44_what_is_refused_changes_nothing)
{
    pmc_rig_begin(&two_axes);
    ck_assert_int_eq(ask(PMC_RUN, 1, 64, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_RUN, 1, -1, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_SET_SPEED, 1, 0, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_SET_SPEED, 3, 1, 8001), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_MOVE_TO, 1, 8388608, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 1, -8388609, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_JOG, 2, 1, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_RESET + 1, 1, 0, 0), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_JOG, 0, 1, 0), PMC_NO_AXIS);
    ck_assert_int_eq(ask(PMC_JOG, 5, 1, 0), PMC_NO_AXIS);
    ck_assert_uint_eq(axis_state(0).fifth, 10);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_SLOT_TICKS);
    must(PMC_MOVE_BY, 1, 100, 0);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 1, 1, 0), PMC_BUSY);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 3, 1, 1), PMC_BUSY);
    ck_assert_int_eq(ask(PMC_CLEAR_COMMANDED, 1, 0, 0), PMC_BUSY);
    run_through_slot(5);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 1, 1, 0), PMC_BUSY);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 3, 1, 1), PMC_BUSY);
    ck_assert_int_eq(ask(PMC_MOVE_BY, 3, 8388608, 1), PMC_RANGE);
    ck_assert_int_eq(ask(PMC_CLEAR_ACTUAL, 3, 0, 0), PMC_BUSY);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 100);
    ck_assert_uint_eq(pulses[1], 0);
    ck_assert_int_eq(axis_state(0).errors, 0);
    static const struct pmc_config one_axis = {.axes = 1};
    pmc_rig_begin(&one_axis);
    ck_assert_int_eq(ask(PMC_JOG, 3, 1, 1), PMC_NO_AXIS);
    must(PMC_RESET, 0, 0, 0);
}
END_TEST

START_TEST(AX45_what_an_axis_does)
{
    pmc_rig_begin(&two_axes);
    set(0, PMC_FLAGS, 0x0103);
    ck_assert_uint_eq(axis_state(0).driving, 0);
    must(PMC_JOG, 1, 1, 0);
    ck_assert_uint_eq(axis_state(0).driving, 1);
    run_through_slot(1);
    ck_assert_uint_eq(axis_state(0).driving, 1);
    ck_assert_uint_eq(axis_state(0).speed, 100);
    ck_assert(axis_state(0).endless);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
    ck_assert_uint_eq(axis_state(0).driving, 0);
    ck_assert_uint_eq(pulses[0], 1);
    reg(0, 0, inc(100, 1, 0));
    must(PMC_RUN, 1, 0, 0);
    ck_assert_uint_eq(axis_state(0).driving, 2);
    ck_assert_int_eq(axis_state(0).state, PMC_PROGRAM);
    run_to(pmc_now(&unit) + 2 * SLOT);
    ck_assert_uint_eq(axis_state(0).driving, 3);
    must(PMC_STOP, 1, 0, 0);
    run_to(pmc_now(&unit) + SLOT);
    ck_assert_int_eq(axis_state(0).state, PMC_MANUAL); /* a ramp that outlives its program */
    ck_assert_int_eq(ask(PMC_JOG, 1, 1, 0), PMC_BUSY);
    run_until_idle(0);
    must(PMC_SEARCH, 1, 0, 0);
    ck_assert_uint_eq(axis_state(0).driving, 4);
    ck_assert_int_eq(axis_state(0).state, PMC_SEARCHING);
}
END_TEST

START_TEST(AX57_a_start_that_is_dropped)
{
    static const enum pmc_request_kind starts[] = {PMC_JOG, PMC_RUN, PMC_SEARCH, PMC_MOVE_BY}, stops[] = {PMC_STOP, PMC_STOP_NOW};
    pmc_rig_begin(&two_axes);
    unit.axis[0].errors = PMC_ERROR_HOM;
    must(starts[_i % 4], 1, 1, 0);
    ck_assert(pmc_is_busy(&unit, 0));
    must(PMC_SET_SPEED, 1, 77, 0);
    must(stops[_i / 4], 1, 0, 0);
    ck_assert(!pmc_is_busy(&unit, 0));
    run_to_slot(20);
    ck_assert_uint_eq(pulses[0], 0);
    ck_assert_uint_eq(axis_state(0).fifth, 77);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_HOM);
    ck_assert_uint_eq(happenings, 0);
    must(PMC_MOVE_BY, 1, 1, 0);
    must(PMC_STOP, 1, 0, 0);
    must(PMC_MOVE_BY, 1, 2, 0); /* free at once */
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 2);
}
END_TEST

START_TEST(AX58_without_software_limits)
{
    pmc_rig_begin(&two_axes);
    set(0, PMC_FLAGS, 0x0103);
    unit.axis[0].commanded = 8388600;
    ck_assert_int_eq(ask(PMC_MOVE_BY, 1, 100, 0), PMC_RANGE);
    must(PMC_MOVE_BY, 1, 7, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, 8388607);
    unit.axis[0].commanded = 8388600;
    reg(0, 0, inc(1000, 3, 0));
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_PGM);
    unit.axis[0].commanded = -8388600;
    reg(0, 0, inc(-1000, 3, 0));
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_PGM);
    for (int sign = -1; sign <= 1; sign += 2) { /* to the very end it may */
        reg(0, 0, inc(sign < 0 ? -80 : 70, 3, 0));
        reg(0, 1, op(PMC_END, 0));
        unit.axis[0].commanded = sign * 8388600;
        must(PMC_RUN, 1, 0, 0);
        run_until_idle(0);
        ck_assert_int_eq(axis_state(0).errors, 0);
    }
    pulses[0] = 7;
    unit.axis[0].commanded = 8388600;
    ck_assert_uint_eq(pulses[0], 7);
    must(PMC_JOG, 1, 1, 0);
    run_to(pmc_now(&unit) + 20 * 80000);
    ck_assert_uint_eq(pulses[0], 7 + 19);
    ck_assert_int_eq(axis_state(0).commanded, -8388608 + 11);
    ck_assert_int_eq(reported[0], -8388608 + 11);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    const int32_t from = axis_state(0).commanded;
    must(PMC_JOG, 1, -1, 0);
    run_to(pmc_now(&unit) + 20 * 80000);
    ck_assert_int_eq(axis_state(0).commanded, from - 19 + (1 << 24));
    ck_assert_int_eq(reported[0], axis_state(0).commanded);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    must(PMC_CLEAR_COMMANDED, 1, 0, 0);
    must(PMC_MOVE_BY, 1, 100, 0); /* counts from 0, as the counter will */
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, 100);
}
END_TEST

START_TEST(AT3_many_requests_in_one_slot)
{
    pmc_rig_begin(&two_axes);
    unsigned taken = 0;
    while (ask(taken % 2 ? PMC_CLEAR_ACTUAL : PMC_CLEAR_COMMANDED, 1, 0, 0) == PMC_OK)
        ck_assert_uint_le(++taken, 100);
    ck_assert_uint_eq(taken, PMC_PENDING_MAX);
    ck_assert_int_eq(ask(PMC_CLEAR_ERRORS, 1, 0, 0), PMC_BUSY);
    ck_assert_int_eq(ask(PMC_CLEAR_ERRORS, 2, 0, 0), PMC_OK);
    must(PMC_STOP, 1, 0, 0);
    must(PMC_RESET, 0, 0, 0);
    must(PMC_MOVE_BY, 1, 5, 0);
    for (int32_t i = 1; i < 100; i++)
        must(PMC_SET_SPEED, 1, i, 0); /* the last one counts */
    ck_assert_uint_eq(unit.axis[0].pendings, 3);
    run_until_idle(0);
    ck_assert_uint_eq(axis_state(0).fifth, 99);
    ck_assert_int_eq(axis_state(0).commanded, 5);
}
END_TEST

START_TEST(AT3_a_stop_has_its_place_in_a_full_list)
{
    pmc_rig_begin(&two_axes);
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(3);
    unsigned taken = 0;
    while (ask(taken % 2 ? PMC_CLEAR_ERRORS : PMC_SET_SPEED, 1, 5, 0) == PMC_OK)
        taken++;
    ck_assert_uint_eq(taken, PMC_PENDING_MAX);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], 1);
}
END_TEST

START_TEST(AB4_end_the_program)
{
    pmc_rig_begin(&two_axes);
    must(PMC_RUN, 1, 0, 0);
    must(PMC_STOP_PROGRAM, 1, 0, 0); /* drops the start */
    ck_assert(!pmc_is_busy(&unit, 0));
    must(PMC_JOG, 1, 1, 0);
    run_through_slot(2);
    must(PMC_STOP_PROGRAM, 1, 0, 0); /* no program */
    run_to_slot(50);
    ck_assert(axis_state(0).moving);
    must(PMC_STOP_NOW, 1, 0, 0);
    run_until_idle(0);
    reg(0, 0, (struct pmc_command){.op = PMC_TIM, .ms = 60000});
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(100);
    ck_assert_int_eq(axis_state(0).reg, 0);
    must(PMC_STOP_PROGRAM, 1, 0, 0);
    run_through_slot(100);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert(!pmc_is_busy(&unit, 0));
    must(PMC_RUN, 1, 0, 0); /* begins at once, whatever was waited for */
    run_through_slot(101);
    ck_assert_uint_eq(slot_of_reg(0, 0, 1), 101);
}
END_TEST

START_TEST(AL5_errors_are_cleared_on_request)
{
    pmc_rig_begin(&two_axes);
    must(PMC_RUN, 1, 63, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_PGM);
    must(PMC_CLEAR_ERRORS, 3, 0, 0);
    run_to_slot(10);
    ck_assert_int_eq(axis_state(0).errors, 0);
    rig_inputs(PMC_EMG);
    run_to_slot(12);
    must(PMC_CLEAR_ERRORS, 3, 0, 0);
    run_through_slot(12);
    ck_assert_int_eq(axis_state(0).errors, 0);
    run_through_slot(13); /* a level: it comes again */
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_EMG);
    ck_assert_int_eq(axis_state(1).errors, PMC_ERROR_EMG);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
}
END_TEST

START_TEST(AU5_a_program_at_power_on)
{
    pmc_rig_begin(&two_axes);
    set(1, PMC_FLAGS, 0x01A3);
    reg(1, 0, inc(50, 1, 0));
    ck_assert_int_eq(pmc_store(&unit, 1), PMC_OK);
    pmc_rig_restart(&two_axes);
    ck_assert(pmc_is_busy(&unit, 1));
    ck_assert(!pmc_is_busy(&unit, 0));
    run_through_slot(1);
    ck_assert_uint_eq(slot_of_reg(1, 0, 0), 1);
    pmc_rig_restart(&two_axes);
    must(PMC_STOP, 2, 0, 0);
    run_to_slot(10);
    ck_assert_uint_eq(happenings, 0);
    must(PMC_RESET, 0, 0, 0); /* does not do it */
    run_to_slot(20);
    ck_assert_uint_eq(happenings, 0);
}
END_TEST

START_TEST(AU5_reset)
{
    pmc_rig_begin(&two_axes);
    set(0, PMC_SPEED1, 20);
    ck_assert_int_eq(pmc_store(&unit, 0), PMC_OK);
    set(0, PMC_SPEED1, 30); /* is lost */
    reg(0, 5, op(PMC_END, 0));
    reg(0, 0, (struct pmc_command){.op = PMC_OTP, .ms = 1000});
    struct pmc_command command = inc(-1000, 4, 0);
    command.op = PMC_ABS;
    reg(0, 1, command);
    must(PMC_RUN, 1, 0, 0);
    must(PMC_SET_SPEED, 3, 500, 600);
    must(PMC_JOG, 2, 0, 1);
    run_to_slot(12);
    must(PMC_RESET, 0, 5, 5); /* values do not count */
    ck_assert(axis_state(0).moving);
    run_through_slot(12);
    const size_t made = pulses[0];
    ck_assert_uint_gt(made, 0);
    run_to_slot(30);
    for (unsigned i = 0; i < 2; i++) {
        const struct pmc_axis_state state = axis_state(i);
        ck_assert_int_eq(state.commanded, 0);
        ck_assert_int_eq(state.actual, 0);
        ck_assert_int_eq(state.state, PMC_IDLE);
        ck_assert(!state.moving && !state.not_homed);
        ck_assert_int_eq(state.reg, -1);
        ck_assert_uint_eq(state.fifth, i == 0 ? 20 : 10);
    }
    ck_assert_uint_eq(pulses[0], made);
    ck_assert(!axis_state(0).forward); /* the output stays */
    ck_assert_uint_eq(pmc_outputs(&unit), 0);
    ck_assert_int_eq(unit.axis[0].parameters.value[PMC_SPEED1], 20);
    ck_assert_int_eq(unit.axis[0].program[5].op, PMC_NOP);
    ck_assert_uint_eq(pmc_next_event(&unit), PMC_NEVER);
    must(PMC_MOVE_BY, 1, -3, 0);
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, -3);
}
END_TEST

static Suite *unit_suite(void)
{
    Suite *suite = suite_create("pmc_unit");
    TCase *parameters = tcase_create("parameters"), *requests = tcase_create("requests");
    tcase_add_test(parameters, AX13_the_deceleration_follows_until_it_is_written);
    tcase_add_test(parameters, AX14_what_is_refused);
    tcase_add_test(parameters, AP1_every_parameter_has_its_range_and_default);
    tcase_add_loop_test(parameters, AX15_units, 0, 10);
    tcase_add_test(parameters, AX16_distances_are_rounded_one_by_one);
    tcase_add_loop_test(parameters, AX17_absolute_and_relative, 0, 2);
    tcase_add_test(parameters, AX56_register_the_position);
    tcase_add_test(parameters, AB3_only_what_a_command_uses_is_set);
    tcase_add_test(requests, AX42_counters);
    tcase_add_test(requests, AX44_what_is_refused_changes_nothing);
    tcase_add_test(requests, AX45_what_an_axis_does);
    tcase_add_loop_test(requests, AX57_a_start_that_is_dropped, 0, 8);
    tcase_add_test(requests, AX58_without_software_limits);
    tcase_add_test(requests, AT3_many_requests_in_one_slot);
    tcase_add_test(requests, AT3_a_stop_has_its_place_in_a_full_list);
    tcase_add_test(requests, AB4_end_the_program);
    tcase_add_test(requests, AL5_errors_are_cleared_on_request);
    tcase_add_test(requests, AU5_a_program_at_power_on);
    tcase_add_test(requests, AU5_reset);
    suite_add_tcase(suite, parameters);
    suite_add_tcase(suite, requests);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(unit_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
