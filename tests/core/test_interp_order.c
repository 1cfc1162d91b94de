/* SPDX-License-Identifier: MIT */
/* test_interp_order.c: what meets in one slot: K, C75, V, new commands and inputs (K2, C3, C4, C6); what is reported of it. */
#include <check.h>

#include "rig.h"

static struct rig rig;

static void setup(void)
{
    rig_power_up(&rig, NULL);
}

static void teardown(void)
{
    rig_free(&rig);
}

static void send_many(const char *text, unsigned count)
{
    for (unsigned i = 0; i < count; i++)
        rig_accept(&rig, '1', text);
}

/* ---- Inputs and a hold ---- */

/* A limit move of 1 step/s from slot 2000, held before its first step; its input comes in slot 701. */
static void hold_limit_move(const char *meanwhile)
{
    rig_accept(&rig, '1', "S1 )05 T02");
    rig_accept_at(&rig, 500 * MS, "K");
    rig_accept_at(&rig, 600 * MS, meanwhile);
    rig_input_at(&rig, 700 * MS + 1, 5, true);
}

START_TEST(K2_a_hold_that_an_input_leads_to_ends_in_that_slot_if_new_commands_are_there)
{
    hold_limit_move("T01");
    rig_to(&rig, 701 * MS + 1); /* the slot is done */
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 701 * MS);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), 702 * MS);
}
END_TEST

START_TEST(K2_a_hold_that_an_input_leads_to_ends_in_that_slot_if_C75_is_remembered)
{
    hold_limit_move("C75");
    rig_to(&rig, 701 * MS + 1);
    ck_assert_uint_eq(rig_outputs_became(&rig, 2, 1), 701 * MS);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), 702 * MS);
}
END_TEST

START_TEST(K2_an_input_just_after_a_slot_is_seen_in_the_next_one)
{
    hold_limit_move("X06 T01");
    rig_input_at(&rig, 701 * MS + 1, 6, true);
    rig_to(&rig, 1 * SECOND);
    ck_assert_ptr_nonnull(recorder_event(&rig.record, 1, RKM04_EVENT_COMMAND, 4, 1));
    ck_assert_ptr_null(recorder_event(&rig.record, 1, RKM04_EVENT_COMMAND, 5, 1)); /* T01 */
    rig_expect_state(&rig, 1, RKM04_ENDED);
}
END_TEST

/* ---- Requests that change nothing ---- */

/* A loop that waits for its E. */
static void leave_loop_open(void)
{
    rig_accept(&rig, '1', "L2 T01");
    rig_to(&rig, 100 * MS);
    rig_expect_state(&rig, 1, RKM04_IDLE);
}

START_TEST(C3_K_of_an_idle_motor_leaves_its_loops_to_the_commands_that_follow_in_the_same_slot)
{
    static const char *const requests[][3] = {{"K"}, {"C75", "K"}, {"C75", "K", "C75"}, {"K", "C75", "K"}};
    leave_loop_open();
    for (size_t i = 0; i < 3 && requests[_i][i]; i++)
        rig_accept(&rig, '1', requests[_i][i]);
    rig_accept(&rig, '1', "C01 E");
    rig_to(&rig, 200 * MS);
    ck_assert_int_eq(rig_motor(&rig, 1).fault, RKM04_FAULT_NONE);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 2), 102 * MS); /* C01 in 100, E in 101 */
    rig_expect_state(&rig, 1, RKM04_IDLE);
}
END_TEST

START_TEST(C3_a_flood_of_requests_in_one_slot_harms_nobody)
{
    static const char other[] = "C90 W10 C91 U L3 A100 E @1 J2 @2";
    rig_accept(&rig, '2', other);
    rig_accept(&rig, '1', "U U T01");
    rig_to(&rig, 2001);
    send_many("C75", 1000);
    for (unsigned i = 0; i < 500; i++) {
        rig_accept(&rig, '1', "K");
        rig_accept(&rig, '1', "C75");
    }
    send_many("K", 1000);
    rig_to(&rig, 10 * MS);
    rig_expect_state(&rig, 1, RKM04_HELD);
    send_many("K", 1000);
    send_many("C75", 1000);
    rig_to(&rig, 20 * MS);
    ck_assert_uint_eq(rig_outputs_became(&rig, 1, 1), 10 * MS);
    ck_assert_str_eq(rig_program(&rig, 2), other);
}
END_TEST

/* ---- V and K ---- */

#define LATENCY 5 /* ms */

/* "F5000 R" from slot 2000 at 1000 steps/s; V2000 comes at 1000 ms, after `before` if there is one, so that it is due with the
 * K. The rest runs at the speed in force at the hold. */
static void change_and_hold(const char *before)
{
    const struct rkm04_config config = {.node = 1, .readings.speed_change = LATENCY};
    rig_power_up(&rig, &config);
    rig_accept(&rig, '1', "F5000 R");
    rig_to(&rig, 1000 * MS);
    if (before)
        rig_accept(&rig, '1', before);
    rig_accept(&rig, '1', "V2000");
    rig_accept_at(&rig, (1000 + LATENCY) * MS, "K");
    rig_accept_at(&rig, 3 * SECOND, "C75");
    rig_to(&rig, 20 * SECOND);
    /* At 1005 ms x = 247.5 + 553 = 800.5; V up to 2000 begins and is stopped: 247.5 steps to S, 1048 in all. */
    rig_expect_motion_near(&rig, 1, 2, 3 * SECOND, 3 * SECOND + move_ticks(100, 2000, 2000, 5000 - 1048), 5000 - 1048, true);
}

START_TEST(C4_a_change_that_is_due_in_the_slot_of_a_K_came_first)
{
    change_and_hold(NULL);
    change_and_hold("C75");
}
END_TEST

/* ---- X ---- */

/* "X04 F5000 R", K one second later, X on the ramp to the hold. */
static void stop_for_good(const char *on_the_ramp)
{
    rig_accept(&rig, '1', "X04 F5000 R T01");
    rig_accept_at(&rig, 1003 * MS, "K");
    rig_accept_at(&rig, 1103 * MS, on_the_ramp);
    rig_input_at(&rig, 1203 * MS, 4, true);
    rig_to(&rig, 10 * SECOND);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER); /* nothing is left to be done */
}

START_TEST(C6_X_on_the_ramp_of_a_hold_ends_the_commands_that_were_to_follow_it)
{
    stop_for_good("T02");
}
END_TEST

START_TEST(C6_X_on_the_ramp_of_a_hold_ends_the_C75_that_was_remembered)
{
    stop_for_good("C75");
}
END_TEST

START_TEST(C6_X_fires_before_the_first_command_after_a_fault)
{
    rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings.fault_exit = RKM04_FAULT_EXIT_NEW});
    rig_accept(&rig, '1', "X04 E");
    rig_input_at(&rig, 100 * MS, 4, true);
    rig_to(&rig, 200 * MS);
    rig_expect_state(&rig, 1, RKM04_FAULTY); /* without a command to execute X is not checked */
    rig_accept(&rig, '1', "T01");
    rig_to(&rig, 300 * MS);
    rig_expect_state(&rig, 1, RKM04_ENDED);
    ck_assert_uint_eq(rkm04_outputs(&rig.unit), 0);
}
END_TEST

/* "F5000 R", K one second later, and two messages on the ramp to the hold, of which E is a fault when the motor stands. */
static void fault_for_good(const char *first, const char *second)
{
    rig_accept(&rig, '1', "F5000 R");
    rig_accept_at(&rig, 1003 * MS, "K");
    rig_accept_at(&rig, 1103 * MS, first);
    rig_accept_at(&rig, 1105 * MS, second);
    rig_to(&rig, 2 * SECOND);
    rig_expect_state(&rig, 1, RKM04_FAULTY);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER);
}

START_TEST(C1_a_C75_remembered_is_forgotten)
{
    fault_for_good("C75", "\\ E");
}
END_TEST

START_TEST(C3_a_C75_for_commands_that_wait_for_the_end_of_the_ramp_is_not_remembered_after_them)
{
    fault_for_good("E", "C75");
}
END_TEST

START_TEST(K3_a_unit_without_programs_has_nothing_to_do)
{
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER);
    rig_accept(&rig, '1', "W5");
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(rkm04_next_event(&rig.unit), RKM04_NEVER);
}
END_TEST

/* ---- What is reported ---- */

static size_t events_of(enum rkm04_event what)
{
    size_t count = 0;
    for (size_t i = 0; i < rig.record.count; i++)
        count += rig.record.list[i].kind == RECORD_EVENT && rig.record.list[i].motor == 1 && rig.record.list[i].what == what;
    return count;
}

START_TEST(C1_a_reset_tells_that_no_command_is_executed_any_more)
{
    rig_accept(&rig, '1', "W1000");
    rig_accept_at(&rig, 10 * MS + 5, "\\");
    ck_assert_uint_eq(events_of(RKM04_EVENT_COMMAND), 2);
    ck_assert_uint_eq(recorder_event(&rig.record, 1, RKM04_EVENT_COMMAND, 0, 1)->tick, 10 * MS + 5);
    rig_accept(&rig, '1', "\\");
    ck_assert_uint_eq(events_of(RKM04_EVENT_COMMAND), 2); /* there was none */
}
END_TEST

START_TEST(C6_a_total_stop_tells_that_no_command_is_executed_any_more)
{
    rig_accept(&rig, '1', "X04 W1000");
    rig_input_at(&rig, 10 * MS, 4, true);
    rig_to(&rig, 100 * MS);
    ck_assert_uint_eq(recorder_event(&rig.record, 1, RKM04_EVENT_COMMAND, 0, 1)->tick, 10 * MS);
    ck_assert_uint_eq(events_of(RKM04_EVENT_COMMAND), 3);
}
END_TEST

START_TEST(C7_a_fault_is_told_once_and_so_is_its_end)
{
    rig_power_up(&rig, &(struct rkm04_config){.node = 1, .readings.fault_exit = RKM04_FAULT_EXIT_NEW});
    rig_accept(&rig, '1', "E");
    rig_to(&rig, 10 * MS);
    ck_assert_uint_eq(events_of(RKM04_EVENT_FAULT), 1);
    rig_accept(&rig, '1', "U U");
    rig_to(&rig, 20 * MS);
    ck_assert_uint_eq(recorder_event(&rig.record, 1, RKM04_EVENT_FAULT, RKM04_FAULT_NONE, 1)->tick, 10 * MS);
    ck_assert_uint_eq(events_of(RKM04_EVENT_FAULT), 2);
    rig_accept(&rig, '1', "E");
    rig_to(&rig, 30 * MS);
    rig_accept(&rig, '1', "\\");
    rig_accept(&rig, '1', "\\");
    ck_assert_uint_eq(recorder_event(&rig.record, 1, RKM04_EVENT_FAULT, RKM04_FAULT_NONE, 2)->tick, 30 * MS);
    ck_assert_uint_eq(events_of(RKM04_EVENT_FAULT), 4);
}
END_TEST

static Suite *interp_order_suite(void)
{
    Suite *suite = suite_create("interp_order");

    TCase *slot = tcase_create("slot");
    tcase_add_checked_fixture(slot, setup, teardown);
    tcase_add_test(slot, K2_a_hold_that_an_input_leads_to_ends_in_that_slot_if_new_commands_are_there);
    tcase_add_test(slot, K2_a_hold_that_an_input_leads_to_ends_in_that_slot_if_C75_is_remembered);
    tcase_add_test(slot, K2_an_input_just_after_a_slot_is_seen_in_the_next_one);
    tcase_add_loop_test(slot, C3_K_of_an_idle_motor_leaves_its_loops_to_the_commands_that_follow_in_the_same_slot, 0, 4);
    tcase_add_test(slot, C3_a_flood_of_requests_in_one_slot_harms_nobody);
    tcase_add_test(slot, C4_a_change_that_is_due_in_the_slot_of_a_K_came_first);
    tcase_add_test(slot, C6_X_on_the_ramp_of_a_hold_ends_the_commands_that_were_to_follow_it);
    tcase_add_test(slot, C6_X_on_the_ramp_of_a_hold_ends_the_C75_that_was_remembered);
    tcase_add_test(slot, C6_X_fires_before_the_first_command_after_a_fault);
    tcase_add_test(slot, C1_a_C75_remembered_is_forgotten);
    tcase_add_test(slot, C3_a_C75_for_commands_that_wait_for_the_end_of_the_ramp_is_not_remembered_after_them);
    tcase_add_test(slot, K3_a_unit_without_programs_has_nothing_to_do);
    suite_add_tcase(suite, slot);

    TCase *told = tcase_create("told");
    tcase_add_checked_fixture(told, setup, teardown);
    tcase_add_test(told, C1_a_reset_tells_that_no_command_is_executed_any_more);
    tcase_add_test(told, C6_a_total_stop_tells_that_no_command_is_executed_any_more);
    tcase_add_test(told, C7_a_fault_is_told_once_and_so_is_its_end);
    suite_add_tcase(suite, told);
    return suite;
}

int main(void)
{
    return rig_run(interp_order_suite(), "./test_interp_order");
}
