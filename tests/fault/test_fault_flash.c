/* SPDX-License-Identifier: MIT */
/* test_fault_flash.c: flash that fails, power that goes in the middle of an operation, inputs that are stuck. One case alone:
 * CK_RUN_CASE=CASE ./test_fault_flash */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "fault_rig.h"

#define STORE "\3" "1"
#define OLD "W1 W2"
#define NEW "W3 W4 W5"

/* A unit with OLD in flash and NEW in memory. */
static void begin(void)
{
    rig_begin(true, 2);
    set(1, "\\" OLD);
    settle();
    ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
    ck_assert_uint_eq(answer_byte(2), 0);
    set(1, "\\" NEW);
    settle();
    forget();
}

/* Is this what Get Command answers? */
static bool has_program(const char *text)
{
    ck_assert_uint_eq(answers_to(1, "\5" "1", 2), 1);
    return answer_byte(2) == (uint8_t)text[0] &&
           (!text[0] || answer_byte(1 + strlen(text)) == (uint8_t)text[strlen(text) - 1]) && rig.host.count == 8 + strlen(text);
}

/* What the flash holds after power-up. */
static const char *found_after_reset(void)
{
    struct rkm04_motor_state state;
    sim_power(&rig.sim, 1, true);
    run(1);
    ck_assert(rkm04_motor_state(rkm04_of(sim_core(&rig.sim, 1)), 1, &state));
    if (state.slot == RKM04_SLOT_LOADED)
        return state.commands == 3 && has_program(NEW) ? "new" : state.commands == 2 && has_program(OLD) ? "old" : "mixed";
    ck_assert_uint_eq(state.commands, 0);
    return state.slot == RKM04_SLOT_EMPTY ? "empty" : "untrusted";
}

/* ---- Operations that fail ------------------------------------------------------------------------------------------- */

START_TEST(P6_a_write_to_flash_that_fails_is_an_error_in_the_answer)
{
    begin();
    inject("{'kind': 'flash', 'count': 1}");
    ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
    ck_assert_uint_ne(answer_byte(2), 0);
    ck_assert_uint_eq(rig.news, 1);
    assert_news(0, "1 flash: an erase of block 1 fails");
    ck_assert_uint_eq(rig.told[0].unit, 1);
    ck_assert(has_program(NEW));
    ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
    ck_assert_uint_eq(answer_byte(2), 0);
    ck_assert_str_eq(found_after_reset(), "new");
    rig_end();
}
END_TEST

START_TEST(any_operation_of_the_flash_may_fail_by_itself)
{
    static const char *const operations[] = {"erase", "program", "read"};
    begin();
    int count = _i / 2 == 2 ? 2 : 1; /* a read is tried twice */
    inject("{'kind': 'flash', 'operation': '%s', 'torn': %s, 'count': %d}", operations[_i / 2], _i % 2 ? "true" : "false", count);
    if (_i / 2 == 2) {
        ck_assert_str_ne(found_after_reset(), "old"); /* it could not be read */
        ck_assert_uint_eq(rig.sim.faults.fault[0].acted, 2);
        ck_assert_str_eq(found_after_reset(), "old");
    } else {
        ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
        ck_assert_uint_ne(answer_byte(2), 0);
        ck_assert_str_ne(found_after_reset(), "mixed");
    }
    rig_end();
}
END_TEST

START_TEST(U5_a_read_that_fails_once_is_tried_again)
{
    begin();
    inject("{'kind': 'flash', 'operation': 'read', 'count': 1}");
    ck_assert_str_eq(found_after_reset(), "old");
    ck_assert_uint_eq(rig.sim.faults.fault[0].acted, 1);
    rig_end();
}
END_TEST

START_TEST(the_flash_of_another_unit_does_not_suffer)
{
    begin();
    inject("{'kind': 'flash', 'unit': 2}");
    ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
    ck_assert_uint_eq(answer_byte(2), 0);
    ck_assert_uint_eq(answers_to(2, STORE, 2), 1);
    ck_assert_uint_ne(answer_byte(2), 0);
    rig_end();
}
END_TEST

/* ---- Power ---------------------------------------------------------------------------------------------------------- */

/* For every operation of a store: nothing is received, the unit is off, and what is found later is whole. */
START_TEST(P6_power_lost_at_any_operation_leaves_the_old_program_or_the_new_one)
{
    unsigned found_old = 0, found_new = 0, n;
    for (n = 1;; n++) {
        begin();
        inject("{'kind': 'power', 'operation': %u}", n);
        unsigned answers = answers_to(1, STORE, 2);
        if (answers == 1)
            break; /* there is no n-th operation */
        ck_assert_uint_eq(rig.host.count, 0);
        ck_assert(!sim_powered(&rig.sim, 1));
        ck_assert(sim_powered(&rig.sim, 2));
        ck_assert_uint_eq(rig.news, 1);
        run(1000000);
        ck_assert_uint_eq(answers_to(1, VERSION, 1), 0);
        const char *found = found_after_reset();
        found_old += strcmp(found, "old") == 0;
        found_new += strcmp(found, "new") == 0;
        ck_assert_uint_eq(found_old + found_new, n);
        set(1, "\\" NEW);
        settle();
        ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
        ck_assert_uint_eq(answer_byte(2), 0);
        ck_assert_str_eq(found_after_reset(), "new");
        rig_end();
    }
    ck_assert_uint_gt(n, 2);
    ck_assert_uint_gt(found_old, 0);
    ck_assert_str_eq(found_after_reset(), "new");
    rig_end();
}
END_TEST

START_TEST(power_that_goes_may_come_back_by_itself)
{
    begin();
    inject("{'kind': 'power', 'operation': 2, 'duration': '3s'}");
    ask(1, STORE, 2);
    settle();
    ck_assert(!sim_powered(&rig.sim, 1));
    uint64_t gone = rig.told[0].tick;
    sim_advance(&rig.sim, gone + 2999999);
    ck_assert(!sim_powered(&rig.sim, 1));
    sim_advance(&rig.sim, gone + 3000000);
    ck_assert(sim_powered(&rig.sim, 1));
    ck_assert_uint_eq(segment_since(&rig.sim.segment, 1), gone + 3000000);
    ck_assert_uint_eq(rig.news, 2);
    assert_news(0, "1 power: power is lost during a write of block 1");
    assert_news(1, "1 power: the power is back");
    ck_assert_uint_eq(answers_to(1, VERSION, 1), 1);
    rig_end();
}
END_TEST

START_TEST(power_does_not_go_before_its_turn_however_far_that_is)
{
    begin();
    inject("{'kind': 'power', 'skip': 2147483647, 'operation': 2147483650}"); /* 2^32 in all */
    ck_assert_uint_eq(answers_to(1, STORE, 2), 1);
    ck_assert_uint_eq(answer_byte(2), 0);
    ck_assert_uint_eq(rig.news, 0);
    ck_assert(sim_powered(&rig.sim, 1));
}
END_TEST

START_TEST(a_broadcast_may_cost_several_units_their_power)
{
    rig_begin(_i, 3);
    inject("{'kind': 'power', 'count': 2}");
    ask(0, "\3" "0", 2);
    settle();
    ck_assert(!sim_powered(&rig.sim, 1));
    ck_assert(!sim_powered(&rig.sim, 2));
    ck_assert(sim_powered(&rig.sim, 3));
    rig_end();
}
END_TEST

START_TEST(P10_power_may_go_when_a_request_is_taken_that_waited)
{
    begin();
    inject("{'kind': 'power'}");
    inject("{'kind': 'delay', 'delay': '100ms', 'count': 1}");
    ask(1, VERSION, 1);
    run(20000);
    ask(1, STORE, 2);
    run(20000);
    ck_assert(sim_powered(&rig.sim, 1));
    settle();
    ck_assert(!sim_powered(&rig.sim, 1));
    ck_assert_uint_ge(rig.host.count, 23);
    ck_assert_uint_le(rig.host.count, 24);
    rig_end();
}
END_TEST

/* ---- Inputs --------------------------------------------------------------------------------------------------------- */

static uint8_t di(unsigned number)
{
    return rkm04_inputs(rkm04_of(sim_core(&rig.sim, number)));
}

START_TEST(U2_a_stuck_input_stays_whatever_is_done_to_it)
{
    rig_begin(true, 2);
    sim_set_di(&rig.sim, 1, 0x81);
    inject("{'kind': 'input', 'unit': 1, 'input': 3, 'level': 1, 'for': '2s'}");
    inject("{'kind': 'input', 'unit': 1, 'input': 8, 'level': 0, 'for': '1s'}");
    ck_assert_uint_eq(di(1), 0x05);
    ck_assert_uint_eq(di(2), 0);
    sim_set_di(&rig.sim, 1, 0xf0);
    ck_assert_uint_eq(di(1), 0x74);
    sim_power(&rig.sim, 1, true);
    ck_assert_uint_eq(di(1), 0x74);
    run(1000000);
    ck_assert_uint_eq(di(1), 0xf4);
    run(1000000);
    ck_assert_uint_eq(di(1), 0xf0);
    rig_end();
}
END_TEST

START_TEST(M_a_stuck_limit_switch_is_not_seen_by_the_guard)
{
    rig_begin(true, 1);
    inject("{'kind': 'input', 'input': 1, 'level': 0, 'after': '10ms'}");
    set(1, "\\S1000V1000M01F2000R");
    settle();
    sim_set_di(&rig.sim, 1, 1);
    run(5000000);
    ck_assert_uint_eq(answers_to(1, "\4" "1", 2), 1);
    ck_assert_uint_eq(answer_byte(9), '2'); /* all 2000 steps */
    rig_end();
}
END_TEST

START_TEST(an_input_may_flicker)
{
    rig_begin(true, 1);
    inject("{'kind': 'input', 'input': 2, 'level': true, 'duration': '3ms', 'every': '10ms', 'count': 5}");
    unsigned on = 0;
    for (unsigned ms = 0; ms < 100; ms++) {
        on += di(1) == 2;
        run(1000);
    }
    ck_assert_uint_eq(on, 15);
    ck_assert_uint_eq(rig.news, 10);
    assert_news(0, "1 input: input 2 is stuck at 1");
    assert_news(1, "1 input: over");
    rig_end();
}
END_TEST

START_TEST(the_last_of_two_faults_of_an_input_holds_it)
{
    rig_begin(true, 1);
    inject("{'kind': 'input', 'input': 2, 'level': 1}");
    inject("{'kind': 'input', 'input': 2, 'level': 0, 'for': '1ms'}");
    ck_assert_uint_eq(di(1), 0);
    run(1000);
    ck_assert_uint_eq(di(1), 2);
    json_decref(run_command("fault.clear", "{'id': 1}"));
    ck_assert_uint_eq(di(1), 0);
    rig_end();
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("fault_flash");
    TCase *flash = tcase_create("flash"), *power = tcase_create("power"), *input = tcase_create("input");
    tcase_add_test(flash, P6_a_write_to_flash_that_fails_is_an_error_in_the_answer);
    tcase_add_loop_test(flash, any_operation_of_the_flash_may_fail_by_itself, 0, 6);
    tcase_add_test(flash, U5_a_read_that_fails_once_is_tried_again);
    tcase_add_test(flash, the_flash_of_another_unit_does_not_suffer);
    tcase_add_test(power, P6_power_lost_at_any_operation_leaves_the_old_program_or_the_new_one);
    tcase_add_test(power, power_that_goes_may_come_back_by_itself);
    tcase_add_test(power, power_does_not_go_before_its_turn_however_far_that_is);
    tcase_add_loop_test(power, a_broadcast_may_cost_several_units_their_power, 0, 2);
    tcase_add_test(power, P10_power_may_go_when_a_request_is_taken_that_waited);
    tcase_add_test(input, U2_a_stuck_input_stays_whatever_is_done_to_it);
    tcase_add_test(input, M_a_stuck_limit_switch_is_not_seen_by_the_guard);
    tcase_add_test(input, an_input_may_flicker);
    tcase_add_test(input, the_last_of_two_faults_of_an_input_holds_it);
    suite_add_tcase(suite, flash);
    suite_add_tcase(suite, power);
    suite_add_tcase(suite, input);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
