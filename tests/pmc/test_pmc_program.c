/* SPDX-License-Identifier: MIT */
/* Programs of a PMC: repetitions, slots, outputs. The examples of docs/PMC.md, and the clauses beside them. */
#include <stdlib.h>
#include <string.h>

#include "crc32.h"
#include "pmc_rig.h"

static const struct pmc_config two_axes = {.axes = 2}, passes = {.axes = 2, .passes = true}, refuse = {.axes = 2, .refuse = true};

static struct pmc_command op(enum pmc_op name, unsigned argument)
{
    return (struct pmc_command){.op = (uint8_t)name, .argument = (uint8_t)argument};
}

static struct pmc_command inc(int32_t tenths, unsigned speed, unsigned ms)
{
    return (struct pmc_command){.op = PMC_INC, .value = tenths, .speed = (uint8_t)speed, .ms = (uint16_t)ms};
}

/* ---- Repetitions ---- */

static uint8_t trace[4096];
static size_t traced;

/* Run the program of X and note the registers. Returns how many there were. */
static size_t run_program(void)
{
    traced = 0;
    happenings = 0;
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    for (size_t i = 0; i < happenings; i++)
        if (happening[i].kind == HAPPENED_EVENT && happening[i].what == PMC_EVENT_COMMAND && happening[i].value != 0) {
            ck_assert_uint_eq(happening[i].tick, happening[0].tick + traced * SLOT); /* one a slot */
            trace[traced++] = (uint8_t)(happening[i].value - 1);
        }
    return traced;
}

static unsigned count_of(uint8_t number)
{
    unsigned count = 0;
    for (size_t i = 0; i < traced; i++)
        count += trace[i] == number;
    return count;
}

/* The article's figure 5. */
static void figure5(const struct pmc_config *config, unsigned first)
{
    static const uint8_t count[] = {5, 10, 3};
    pmc_rig_begin(config);
    for (unsigned i = 0; i < 3; i++) {
        reg(0, first + 5 * i, op(PMC_REP, count[i]));
        reg(0, 20 + 5 * i, op(PMC_RPE, 0));
    }
    reg(0, 33, op(PMC_END, 0));
}

START_TEST(AX18_the_articles_repetitions)
{
    figure5(&two_axes, 5);
    ck_assert_uint_eq(run_program(), 2049);
    ck_assert_uint_eq(crc32_update(0, trace, traced), 0x37FDB50B);
    static const unsigned counts[] = {1, 6, 66, 264, 66, 6, 1}, from[] = {0, 6, 11, 16, 21, 26, 31, 34};
    for (unsigned i = 0; i < 7; i++)
        for (unsigned r = from[i]; r < from[i + 1]; r++)
            ck_assert_uint_eq(count_of((uint8_t)r), counts[i]);
    for (unsigned i = 0; i <= 20; i++)
        ck_assert_uint_eq(trace[i], i);
    ck_assert_uint_eq(trace[21], 16);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX19_the_same_a_register_earlier)
{
    figure5(&two_axes, 4);
    ck_assert_uint_eq(run_program(), 2312);
    ck_assert_uint_eq(crc32_update(0, trace, traced), 0x95F34575);
    ck_assert_uint_eq(count_of(5), 6);
    ck_assert_uint_eq(count_of(10), 66);
    ck_assert_uint_eq(count_of(15), 264);
}
END_TEST

START_TEST(AX20_the_same_counted_in_passes)
{
    figure5(&passes, 5);
    ck_assert_uint_eq(run_program(), 1309);
    ck_assert_uint_eq(crc32_update(0, trace, traced), 0xF727FE7A);
    figure5(&passes, 4);
    ck_assert_uint_eq(run_program(), 1458);
    ck_assert_uint_eq(crc32_update(0, trace, traced), 0x1C7881D5);
}
END_TEST

START_TEST(AX21_one_and_255_repetitions)
{
    static const struct {
        bool passes;
        uint8_t count;
        unsigned registers;
    } rows[] = {{false, 1, 6}, {true, 1, 4}, {false, 255, 514}, {true, 255, 512}};
    pmc_rig_begin(rows[_i].passes ? &passes : &two_axes);
    reg(0, 0, op(PMC_REP, rows[_i].count));
    reg(0, 2, op(PMC_RPE, 0));
    reg(0, 3, op(PMC_END, 0));
    ck_assert_uint_eq(run_program(), rows[_i].registers);
    if (_i == 0)
        ck_assert_mem_eq(trace, "\0\1\2\1\2\3", 6);
}
END_TEST

START_TEST(AX22_errors_of_a_program)
{
    static const unsigned slots[] = {4, 4, 65, 4};
    pmc_rig_begin(&two_axes);
    if (_i == 0)
        reg(0, 3, op(PMC_RPE, 0));
    for (unsigned i = 0; i < 4 && _i == 1; i++)
        reg(0, i, op(PMC_REP, 1));
    if (_i == 3) {
        reg(0, 0, op(PMC_JMP, 5));
        reg(0, 5, op(PMC_REP, 2));
        reg(0, 6, op(PMC_JMP, 2));
        reg(0, 2, op(PMC_RPE, 0));
    }
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(slots[_i]);
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(0).state, PMC_PROGRAM);
    run_through_slot(slots[_i]);
    ck_assert_int_eq(axis_state(0).errors, PMC_ERROR_PGM);
    ck_assert_int_eq(axis_state(0).state, PMC_IDLE);
    ck_assert_int_eq(axis_state(0).reg, -1);
}
END_TEST

START_TEST(AX23_a_repetition_that_is_begun_again)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, op(PMC_REP, 1));
    reg(0, 1, op(PMC_REP, 1));
    reg(0, 2, op(PMC_JMP, 0));
    must(PMC_RUN, 1, 0, 0);
    for (unsigned slot = 1; slot < 1000; slot++) {
        run_through_slot(slot);
        ck_assert_uint_le(axis_state(0).repetitions, 2);
    }
    ck_assert_int_eq(axis_state(0).errors, 0);
    ck_assert_int_eq(axis_state(0).state, PMC_PROGRAM);
    must(PMC_RUN, 2, 0, 0);
    must(PMC_STOP, 1, 0, 0);
    run_until_idle(0);
    must(PMC_RUN, 1, 40, 0);
    run_through_slot(1001);
    ck_assert_uint_eq(axis_state(0).repetitions, 0); /* a start clears them */
}
END_TEST

/* ---- Slots ---- */

START_TEST(AX24_the_slots_of_a_program)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, inc(1000, 3, 50));
    reg(0, 1, (struct pmc_command){.op = PMC_TIM, .ms = 20});
    reg(0, 2, (struct pmc_command){.op = PMC_OUT, .argument = 1});
    reg(0, 3, (struct pmc_command){.op = PMC_OTP, .number = 1, .ms = 5});
    reg(0, 4, (struct pmc_command){.op = PMC_IJP, .argument = 6});
    reg(0, 5, op(PMC_JMP, 7));
    reg(0, 7, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(200);
    static const unsigned regs[] = {0, 1, 2, 3, 4, 5, 7}, slots[] = {1, 78, 98, 99, 100, 101, 102};
    for (unsigned i = 0; i < 7; i++)
        ck_assert_uint_eq(slot_of_reg(0, regs[i], 0), slots[i]);
    ck_assert_uint_eq(slot_of_reg(0, 6, 0), 0);
    ck_assert_uint_eq(pulses[0], 100);
    ck_assert_uint_eq(pulse[0][99], 218840);
    ck_assert_int_eq(axis_state(0).commanded, 100);
    static const struct {
        unsigned slot, outputs;
    } changes[] = {{98, 1}, {99, 3}, {104, 1}};
    unsigned n = 0;
    for (size_t i = 0; i < happenings; i++)
        if (happening[i].kind == HAPPENED_OUTPUTS) {
            ck_assert_uint_eq(happening[i].tick, changes[n].slot * SLOT);
            ck_assert_uint_eq(happening[i].value, changes[n++].outputs);
        }
    ck_assert_uint_eq(n, 3);
}
END_TEST

START_TEST(AX25_a_move_without_a_pulse)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, inc(0, 1, 3));
    reg(0, 1, op(PMC_END, 0));
    rig_inputs(PMC_LIMIT_PLUS | PMC_LIMIT_MINUS); /* meets no limit */
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(20);
    ck_assert_uint_eq(slot_of_reg(0, 1, 0), 5);
    ck_assert_int_eq(axis_state(0).errors, 0);
}
END_TEST

START_TEST(AX26_both_axes_begin_at_one_tick)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, inc(100, 3, 0));
    reg(1, 0, inc(100, 3, 0));
    must(PMC_RUN, 3, 0, 0);
    run_to_slot(20);
    ck_assert_uint_eq(pulse[0][0], 17889);
    ck_assert_uint_eq(pulse[1][0], 17889);
    ck_assert_uint_eq(pulses[0], 10);
    ck_assert_uint_eq(pulses[1], 10);
}
END_TEST

START_TEST(AC2_a_dwell_may_be_a_post_timer)
{
    pmc_rig_begin(&two_axes);
    for (unsigned i = 0; i < 3; i++)
        set(0, (enum pmc_parameter)(PMC_TIMER1 + i), 7 * (int32_t)(i + 1));
    reg(0, 0, (struct pmc_command){.op = PMC_INC, .speed = 1, .number = (uint8_t)(_i + 1)});
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(60);
    ck_assert_uint_eq(slot_of_reg(0, 1, 0), 2 + 7 * ((unsigned)_i + 1));
}
END_TEST

START_TEST(AC5_outputs_and_their_pulses)
{
    pmc_rig_begin(&two_axes);
    reg(1, 0, (struct pmc_command){.op = PMC_OTP, .number = 1, .ms = 3});              /* slot 1, until 4 */
    reg(1, 1, (struct pmc_command){.op = PMC_OTP, .ms = 100});                         /* slot 2 */
    reg(1, 2, op(PMC_NOP, 0));                                                         /* slot 3 */
    reg(1, 3, (struct pmc_command){.op = PMC_OTP, .number = 1, .ms = 10});             /* slot 4: instead of off */
    reg(1, 4, (struct pmc_command){.op = PMC_OUT, .argument = 1});                     /* slot 5: the pulse is over, it stays */
    reg(1, 5, (struct pmc_command){.op = PMC_OTP, .number = 1, .ms = 4, .wait = true}); /* slot 6 */
    reg(1, 6, op(PMC_END, 0));                                                         /* slot 10 */
    must(PMC_RUN, 2, 0, 0);
    run_through_slot(4);
    ck_assert_uint_eq(pmc_outputs(&unit), 12);
    run_through_slot(9);
    ck_assert_uint_eq(axis_state(1).outputs, 3);
    run_through_slot(10);
    ck_assert_uint_eq(slot_of_reg(1, 6, 0), 10);
    ck_assert_uint_eq(pmc_outputs(&unit), 4);
    ck_assert_uint_eq(axis_state(0).outputs, 0);
    run_to_slot(300);
    ck_assert_uint_eq(pmc_outputs(&unit), 4); /* END leaves outputs as they are */
    must(PMC_RESET, 0, 0, 0);
    run_through_slot(300);
    ck_assert_uint_eq(pmc_outputs(&unit), 0);
}
END_TEST

START_TEST(AC5_a_pulse_ends_at_its_time_after_the_program)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, (struct pmc_command){.op = PMC_OTP, .ms = 50});
    reg(0, 1, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_through_slot(50);
    ck_assert_uint_eq(pmc_outputs(&unit), 1);
    run_through_slot(51);
    ck_assert_uint_eq(pmc_outputs(&unit), 0);
}
END_TEST

START_TEST(AC5_a_jump_on_an_input_looks_once)
{
    pmc_rig_begin(&two_axes);
    reg(0, 0, (struct pmc_command){.op = PMC_IJP, .number = 1, .argument = 9});
    reg(0, 1, (struct pmc_command){.op = PMC_IJP, .number = 1, .argument = 9});
    reg(0, 2, op(PMC_END, 0));
    reg(0, 9, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_through_slot(1);
    rig_inputs(PMC_IN1);
    run_to_slot(10);
    ck_assert_uint_eq(slot_of_reg(0, 1, 0), 2);
    ck_assert_uint_eq(slot_of_reg(0, 9, 0), 3);
    set(0, PMC_STEPS, 0x0F03); /* in1 is active at 0 */
    happenings = 0;
    must(PMC_RUN, 1, 0, 0);
    run_to_slot(20);
    ck_assert_uint_eq(slot_of_reg(0, 2, 0), 12);
}
END_TEST

START_TEST(AX40_absolute_without_a_home_search)
{
    pmc_rig_begin(_i == 0 ? &two_axes : &refuse);
    struct pmc_command command = inc(100, 3, 0);
    command.op = PMC_ABS;
    reg(0, 0, command);
    reg(0, 1, op(PMC_END, 0));
    must(PMC_RUN, 1, 0, 0);
    run_until_idle(0);
    ck_assert_uint_eq(pulses[0], _i == 0 ? 10 : 0);
    ck_assert(axis_state(0).not_homed == (_i == 0));
    ck_assert_int_eq(axis_state(0).errors, _i == 0 ? 0 : PMC_ERROR_PGM);
    must(PMC_MOVE_TO, 1, 5, 0); /* is never refused */
    run_until_idle(0);
    ck_assert_int_eq(axis_state(0).commanded, 5);
    ck_assert(axis_state(0).not_homed);
    must(PMC_MOVE_BY, 1, 5, 0);
    run_until_idle(0);
    ck_assert(!axis_state(0).not_homed); /* cleared with the errors */
}
END_TEST

static Suite *program_suite(void)
{
    Suite *suite = suite_create("pmc_program");
    TCase *repetitions = tcase_create("repetitions"), *slots = tcase_create("slots");
    tcase_add_test(repetitions, AX18_the_articles_repetitions);
    tcase_add_test(repetitions, AX19_the_same_a_register_earlier);
    tcase_add_test(repetitions, AX20_the_same_counted_in_passes);
    tcase_add_loop_test(repetitions, AX21_one_and_255_repetitions, 0, 4);
    tcase_add_loop_test(repetitions, AX22_errors_of_a_program, 0, 4);
    tcase_add_test(repetitions, AX23_a_repetition_that_is_begun_again);
    tcase_add_test(slots, AX24_the_slots_of_a_program);
    tcase_add_test(slots, AX25_a_move_without_a_pulse);
    tcase_add_test(slots, AX26_both_axes_begin_at_one_tick);
    tcase_add_loop_test(slots, AC2_a_dwell_may_be_a_post_timer, 0, 3);
    tcase_add_test(slots, AC5_outputs_and_their_pulses);
    tcase_add_test(slots, AC5_a_pulse_ends_at_its_time_after_the_program);
    tcase_add_test(slots, AC5_a_jump_on_an_input_looks_once);
    tcase_add_loop_test(slots, AX40_absolute_without_a_home_search, 0, 2);
    suite_add_tcase(suite, repetitions);
    suite_add_tcase(suite, slots);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(program_suite());
    srunner_run_all(runner, CK_NORMAL);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? 0 : 1;
}
