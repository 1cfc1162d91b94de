/* SPDX-License-Identifier: MIT */
/* test_plant.c: what the motors move, and what its switches do to the inputs.
 * One test case alone: CK_RUN_CASE=motors ./test_plant */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "plant_rig.h"

#define SECOND UINT64_C(1000000)
#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct plant_rig rig;

static void begin(const char *plant)
{
    bool ok = plant_rig_begin(&rig, "1", plant);
    ck_assert_msg(ok, "%s", rig.errors);
}

static void teardown(void)
{
    plant_rig_end(&rig);
}

/* Run a program of motor 1 for a time that is long enough for it. */
static void run(const char *program)
{
    plant_rig_program(&rig, 1, '1', program);
    plant_rig_run(&rig, 60 * SECOND);
}

static void assert_news(unsigned at, enum plant_event what, const char *text)
{
    ck_assert_uint_lt(at, rig.news);
    ck_assert_str_eq(rig.report[at].text, text);
    ck_assert_str_eq(plant_event_name(rig.report[at].what), plant_event_name(what));
}

/* ---- Motors --------------------------------------------------------------------------------------------------------- */

START_TEST(the_true_position_follows_the_pulses)
{
    begin("motors: {1: }");
    run("S100 V1000 F500 R");
    ck_assert_int_eq(true_position(&rig, 1), 500);
    run("B200 R");
    ck_assert_int_eq(true_position(&rig, 1), 300);
    ck_assert_int_eq(counter(&rig, 1), 300);
    ck_assert_uint_eq(rig.news, 0);
}
END_TEST

START_TEST(C11_in_simulation_mode_nothing_moves)
{
    begin("motors: {1: }");
    run("S100 V1000 F500 R T41 F300 R C41 F7 R");
    ck_assert_int_eq(counter(&rig, 1), 807);
    ck_assert_int_eq(true_position(&rig, 1), 507);
}
END_TEST

START_TEST(C11_the_direction_is_right_after_simulation_mode)
{
    begin("motors: {1: }");
    run("S100 F10 R T41 B4 R C41 B3 R");
    ck_assert_int_eq(true_position(&rig, 1), 7);
}
END_TEST

START_TEST(a_counter_that_is_set_does_not_move_the_axis)
{
    begin("motors: {1: {offset: -20}}");
    ck_assert_int_eq(true_position(&rig, 1), -20);
    run("S100 F50 R C100 F5 R =-1000");
    ck_assert_int_eq(true_position(&rig, 1), 35);
    ck_assert_int_eq(counter(&rig, 1), -1000);
}
END_TEST

START_TEST(the_offset_counts_from_the_counter_when_the_plant_comes)
{
    begin(NULL);
    run("S100 F50 R");
    ck_assert(plant_rig_configure(&rig, "motors: {1: {offset: 7}, 2: {}}"));
    ck_assert_int_eq(true_position(&rig, 1), 57);
    ck_assert_int_eq(true_position(&rig, 2), 0);
}
END_TEST

START_TEST(motors_that_the_plant_does_not_name_have_no_true_position)
{
    int64_t position = 77;
    begin("motors: {2: }");
    const struct plant *plant = rig.sim.unit[0].plant;
    for (unsigned motor = 0; motor <= 5; motor++)
        ck_assert_int_eq(plant_position(plant, motor, &position), motor == 2);
    position = 77;
    ck_assert(!plant_position(plant, 1, &position));
    ck_assert_int_eq(position, 77);
    run("S100 F50 R");
    ck_assert_int_eq(true_position(&rig, 2), 0);
}
END_TEST

START_TEST(U8_a_reset_clears_the_counter_and_leaves_the_axis_where_it_is)
{
    begin("motors: {1: }");
    run("S100 F50 R");
    sim_power(&rig.sim, 1, true);
    ck_assert_int_eq(counter(&rig, 1), 0);
    ck_assert_int_eq(true_position(&rig, 1), 50);
    run("S100 F50 R");
    ck_assert_int_eq(counter(&rig, 1), 50);
    ck_assert_int_eq(true_position(&rig, 1), 100);
}
END_TEST

START_TEST(a_motor_without_power_does_not_move)
{
    begin("motors: {1: }");
    plant_rig_program(&rig, 1, '1', "S100 V100 F500 R");
    plant_rig_run(&rig, 55000);
    sim_power(&rig.sim, 1, false);
    plant_rig_run(&rig, SECOND);
    ck_assert_int_eq(true_position(&rig, 1), 5);
}
END_TEST

START_TEST(an_end_stop_costs_the_steps_that_go_against_it)
{
    begin("motors: {1: {stops: {low: -3, high: 100}}}");
    run("S100 F150 R");
    ck_assert_int_eq(true_position(&rig, 1), 100);
    ck_assert_int_eq(counter(&rig, 1), 150);
    run("B50 R");
    ck_assert_int_eq(true_position(&rig, 1), 50);
    run("B50 R B50 R");
    ck_assert_int_eq(true_position(&rig, 1), -3);
    ck_assert_int_eq(counter(&rig, 1), 0);
    ck_assert_uint_eq(rig.news, 3);
    assert_news(0, PLANT_END_STOP, "motor 1 runs against its end stop at 100");
    assert_news(1, PLANT_FREE, "motor 1 moves again, at 100, after 50 lost steps");
    assert_news(2, PLANT_END_STOP, "motor 1 runs against its end stop at -3");
}
END_TEST

START_TEST(a_missing_lead_means_that_the_motor_does_not_turn)
{
    begin("motors: {1: {missing_lead: true}, 2: }");
    run("S100 F150 R");
    plant_rig_program(&rig, 1, '2', "S100 F10 R");
    plant_rig_run(&rig, SECOND);
    ck_assert_int_eq(counter(&rig, 1), 150);
    ck_assert_int_eq(true_position(&rig, 1), 0);
    ck_assert_int_eq(true_position(&rig, 2), 10);
    ck_assert_uint_eq(rig.news, 1);
    assert_news(0, PLANT_LEAD, "motor 1 does not turn, at 0: a lead is missing");
}
END_TEST

/* S100 V100 from tick 4000 on: pulse k at 4000 + 10000 k. */
START_TEST(a_jam_holds_the_motor_from_a_time_to_a_time)
{
    begin("motors: {1: {jam: [{from: 24ms, to: 54ms}, {from: 84ms, to: 104001us}]}}");
    run("S100 V100 F20 R");
    ck_assert_int_eq(counter(&rig, 1), 20);
    ck_assert_int_eq(true_position(&rig, 1), 20 - 3 - 3);
    ck_assert_uint_eq(rig.news, 4);
    assert_news(0, PLANT_JAM, "motor 1 is jammed at 1");
    ck_assert_uint_eq(rig.report[0].tick, 24000);
    assert_news(1, PLANT_FREE, "motor 1 moves again, at 1, after 3 lost steps");
    ck_assert_uint_eq(rig.report[1].tick, 54000);
    ck_assert_uint_eq(rig.report[2].tick, 84000);
    assert_news(3, PLANT_FREE, "motor 1 moves again, at 4, after 3 lost steps");
    ck_assert_uint_eq(rig.report[3].tick, 114000);
}
END_TEST

START_TEST(a_jam_without_an_end_has_none)
{
    begin("motors: {1: {jam: {from: 24ms}}}");
    run("S100 V100 F20 R");
    ck_assert_int_eq(true_position(&rig, 1), 1);
}
END_TEST

/* ---- Switches ------------------------------------------------------------------------------------------------------- */

static void assert_inputs(unsigned at, uint64_t tick, uint8_t mask)
{
    ck_assert_uint_lt(at, rig.inputs);
    ck_assert_uint_eq(rig.input[at].tick, tick);
    ck_assert_uint_eq(rig.input[at].mask, mask);
}

START_TEST(an_input_is_1_while_the_position_is_at_least_at_most_or_between)
{
    begin("switches:\n"
          "  - {input: 01, motor: 1, at_least: 3}\n"
          "  - {input: 2, motor: 1, at_most: 1}\n"
          "  - {input: 08, motor: 1, between: [2, 3]}\n");
    ck_assert_uint_eq(inputs(&rig), 0x02);
    run("S100 V100 F5 R"); /* pulse k at 4000 + 10000 k; it is seen a tick later */
    ck_assert_uint_eq(rig.inputs, 5);
    assert_inputs(0, 0, 0x02);
    assert_inputs(1, 24001, 0x00);
    assert_inputs(2, 24001, 0x80);
    assert_inputs(3, 34001, 0x81);
    assert_inputs(4, 44001, 0x01);
    run("B5 R");
    ck_assert_uint_eq(inputs(&rig), 0x02);
}
END_TEST

START_TEST(a_limit_move_ends_at_the_switch)
{
    begin("switches: [{input: 01, motor: 1, at_least: 3}]");
    run("S100 )01");
    ck_assert_int_eq(counter(&rig, 1), 3);
    ck_assert_int_eq(true_position(&rig, 1), 3);
}
END_TEST

/* At 2000 steps/s there are two pulses a slot: the switch is seen in the slot after it, however the unit's slots lie. */
START_TEST(K2_a_switch_is_seen_in_the_next_slot_of_a_unit_that_was_powered_up_at_any_tick)
{
    begin("motors: {1: {offset: -1000}}\nswitches: [{input: 01, motor: 1, at_least: -899}]");
    plant_rig_run(&rig, 12900);
    sim_power(&rig.sim, 1, true);
    run("S2000 )01"); /* pulse k at 2000 + 500 k of its own time: the 101st at 52500 is seen at 53000 */
    ck_assert_int_eq(counter(&rig, 1), 102);
    ck_assert_uint_eq(rig.inputs, 1);
    ck_assert_uint_eq(rig.input[0].tick, 12900 + 52501);
}
END_TEST

START_TEST(hysteresis_keeps_a_switch_until_the_motor_is_that_far_away)
{
    begin("switches: [{input: 01, motor: 1, at_least: 10, hysteresis: 4}]");
    run("S100 F10 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("B4 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    run("F4 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    run("F1 R");
    ck_assert_uint_eq(inputs(&rig), 1);
}
END_TEST

START_TEST(hysteresis_of_a_window_counts_on_both_sides)
{
    begin("switches: [{input: 01, motor: 1, between: [10, 12], hysteresis: 2}]");
    run("S100 F14 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("F1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    run("B3 R B4 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
}
END_TEST

START_TEST(a_normally_closed_switch_is_1_until_it_is_actuated)
{
    begin("switches: [{input: 03, motor: 1, at_least: 2, normally_closed: true}]");
    ck_assert_uint_eq(inputs(&rig), 4);
    run("S100 F2 R");
    ck_assert_uint_eq(inputs(&rig), 0);
}
END_TEST

START_TEST(of_several_switches_at_an_input_one_is_enough)
{
    begin("switches: [{input: 01, motor: 1, at_least: 2}, {input: 01, motor: 2, at_least: 1}]");
    plant_rig_program(&rig, 1, '2', "S100 F1 R");
    run("S100 F2 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    plant_rig_program(&rig, 1, '2', "B1 R");
    plant_rig_run(&rig, SECOND);
    ck_assert_uint_eq(inputs(&rig), 1);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
}
END_TEST

START_TEST(other_inputs_stay_as_a_hand_has_set_them)
{
    begin("switches: [{input: 01, motor: 1, at_least: 2}]");
    sim_set_di(&rig.sim, 1, 0x11);
    ck_assert_uint_eq(inputs(&rig), 0x10);
    run("S100 F2 R");
    ck_assert_uint_eq(inputs(&rig), 0x11);
    ck_assert(plant_rig_configure(&rig, NULL));
    sim_set_di(&rig.sim, 1, 0x10);
    ck_assert_uint_eq(inputs(&rig), 0x10);
}
END_TEST

START_TEST(without_a_plant_inputs_are_those_set_by_hand_again)
{
    begin("switches: [{input: 01, motor: 1, at_most: 2}]");
    ck_assert_uint_eq(inputs(&rig), 1);
    ck_assert(plant_rig_configure(&rig, NULL));
    ck_assert_uint_eq(inputs(&rig), 0);
    ck_assert_ptr_null(rig.sim.unit[0].plant);
}
END_TEST

START_TEST(switches_of_a_turntable_depend_on_the_angle)
{
    begin("motors: {1: {turn: 100}}\n"
          "switches: [{input: 01, motor: 1, between: [98, 1]}, {input: 02, motor: 1, at_least: 50}]");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("S100 F2 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    run("B4 R");
    ck_assert_uint_eq(inputs(&rig), 3);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 2);
    run("F253 R"); /* now at 250 */
    ck_assert_int_eq(true_position(&rig, 1), 250);
    ck_assert_uint_eq(inputs(&rig), 2);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
}
END_TEST

START_TEST(hysteresis_of_a_turntable_reaches_across_zero)
{
    begin("motors: {1: {turn: 100}}\nswitches: [{input: 01, motor: 1, between: [0, 1], hysteresis: 2}]");
    run("S100 B2 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("B1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    run("F6 R");
    ck_assert_uint_eq(inputs(&rig), 1);
    run("F1 R");
    ck_assert_uint_eq(inputs(&rig), 0);
}
END_TEST

START_TEST(a_switch_that_bounces_changes_several_times_and_then_rests)
{
    begin("switches: [{input: 01, motor: 1, at_least: 3, bounce: 5ms}]");
    run("S100 V100 F3 R B3 R");
    ck_assert_uint_eq(inputs(&rig), 0);
    assert_inputs(0, 34001, 1);
    unsigned on = 0;
    while (on < rig.inputs && rig.input[on].tick <= 34001 + 5000)
        on++;
    ck_assert_uint_gt(on, 2);
    ck_assert_uint_eq(on % 2, 1); /* it ends at 1 */
    ck_assert_uint_lt(on, rig.inputs);
    uint64_t off = rig.input[on].tick; /* after the first pulse back */
    ck_assert_uint_gt(off, 34001 + 5000);
    ck_assert_uint_eq((rig.inputs - on) % 2, 1);
    ck_assert_uint_le(rig.input[rig.inputs - 1].tick, off + 5000);
}
END_TEST

START_TEST(a_wait_for_an_input_sees_a_bounce_that_lasts_into_a_slot)
{
    begin("switches: [{input: 01, motor: 1, at_least: 3, bounce: 400ms}]");
    plant_rig_program(&rig, 1, '2', "L5 O01 Z01 E"); /* counts it as five */
    run("S100 F10 R");
    struct rkm04_motor_state state;
    rkm04_motor_state(rkm04_of(sim_core(&rig.sim, 1)), 2, &state);
    ck_assert_str_eq(rkm04_state_name(state.state), "idle");
}
END_TEST

/* ---- Time ----------------------------------------------------------------------------------------------------------- */

static const char busy_plant[] = "motors: {1: {stops: {high: 60}}, 2: {turn: 30}, 3: {stall: {start: 300, limit: ["
                                 "{speed: 900, acceleration: 1500}]}, jam: {from: 300ms, to: 350ms}}}\n"
                                 "switches:\n"
                                 "  - {input: 01, motor: 1, between: [10, 50], hysteresis: 3, bounce: 7ms}\n"
                                 "  - {input: 02, motor: 2, at_least: 20, bounce: 2ms}\n"
                                 "  - {input: 02, motor: 3, at_least: 100, normally_closed: yes}\n"
                                 "  - {input: 03, motor: 3, at_most: 40, bounce: 1s}\n";

static struct plant_rig other;

static void run_busy(struct plant_rig *to, unsigned seed)
{
    ck_assert(plant_rig_begin(to, "1", busy_plant));
    plant_rig_program(to, 1, '1', "S100 V800 A3000 L3 F70 R B60 R E )02 (01");
    plant_rig_program(to, 1, '2', "S500 V2000 A9000 L4 M03 F55 R U D R E");
    plant_rig_program(to, 1, '3', "S200 V1000 A2000 F400 R O01 B300 R");
    while (sim_now(&to->sim) < 4 * SECOND)
        plant_rig_run(to, seed == 0 ? 4 * SECOND : 1 + (uint64_t)rand() % 1500);
    sim_advance(&to->sim, 4 * SECOND + 2000);
}

static void assert_same(void)
{
    ck_assert_uint_gt(rig.inputs, 20);
    ck_assert_uint_gt(rig.news, 3);
    ck_assert_uint_eq(other.inputs, rig.inputs);
    for (unsigned i = 0; i < rig.inputs; i++) {
        ck_assert_uint_eq(other.input[i].tick, rig.input[i].tick);
        ck_assert_uint_eq(other.input[i].mask, rig.input[i].mask);
    }
    ck_assert_uint_eq(other.news, rig.news);
    for (unsigned i = 0; i < rig.news; i++) {
        ck_assert_uint_eq(other.report[i].tick, rig.report[i].tick);
        ck_assert_str_eq(other.report[i].text, rig.report[i].text);
    }
    for (unsigned motor = 1; motor <= 3; motor++) {
        ck_assert_int_eq(true_position(&other, motor), true_position(&rig, motor));
        ck_assert_int_eq(counter(&other, motor), counter(&rig, motor));
    }
}

START_TEST(K3_it_does_not_matter_how_time_is_cut)
{
    srand((unsigned)_i);
    run_busy(&rig, 0);
    run_busy(&other, (unsigned)_i + 1u);
    assert_same();
    plant_rig_end(&other);
}
END_TEST

/* The rest of a run after a copy was put in place of the plant; the time of the bus continued in between. */
START_TEST(a_copy_goes_on_as_the_original_would_have_only_later)
{
    begin("motors: {1: {jam: {from: 64ms, to: 84ms}}}\nswitches: [{input: 01, motor: 1, at_least: 3, bounce: 50ms}]");
    plant_rig_program(&rig, 1, '1', "S100 V100 F20 R");
    plant_rig_run(&rig, 70000); /* in the middle of bouncing, and in a jam */
    struct plant *plant = plant_copy(rig.sim.unit[0].plant, 0), *later = plant_copy(plant, SECOND);
    struct plant_change change, expected;
    unsigned changes = 0;
    ck_assert(plant && later);
    ck_assert_uint_eq(plant_next(later), plant_next(plant) + SECOND);
    json_t *before = plant_json(plant), *after = plant_json(later);
    ck_assert(json_equal(before, after));
    ck_assert(json_is_true(json_object_get(json_array_get(json_object_get(after, "motors"), 0), "jammed")));
    json_decref(before);
    json_decref(after);
    for (uint64_t tick = 74000; tick <= 204000; tick += 10000) {
        plant_step(plant, tick, 1, true);
        plant_step(later, tick + SECOND, 1, true);
    }
    while (plant_take_change(plant, 300000, &expected)) {
        ck_assert(plant_take_change(later, 300000 + SECOND, &change));
        ck_assert_uint_eq(change.tick, expected.tick + SECOND);
        ck_assert_uint_eq(change.level, expected.level);
        changes++;
    }
    ck_assert(!plant_take_change(later, 300000 + SECOND, &change));
    ck_assert_uint_gt(changes, 0);
    int64_t position, other_position;
    ck_assert(plant_position(plant, 1, &position) && plant_position(later, 1, &other_position));
    ck_assert_int_eq(position, other_position);
    ck_assert_int_eq(position, 20 - 2); /* two were jammed */
    plant_free(plant);
    plant_free(later);
}
END_TEST

START_TEST(pulses_that_nobody_takes_still_count)
{
    begin("motors: {1: }\nswitches: [{input: 01, motor: 1, at_least: 10}]");
    struct plant *plant = plant_copy(rig.sim.unit[0].plant, 0);
    struct plant_change change;
    int64_t position;
    for (uint64_t tick = 0; tick < 10000; tick++)
        plant_step(plant, 100 * tick, 1, true);
    while (plant_take_change(plant, 10 * SECOND, &change))
        ck_assert(change.level);
    ck_assert(plant_position(plant, 1, &position));
    ck_assert_int_eq(position, 10000);
    ck_assert_uint_eq(plant_levels(plant), 1);
    plant_free(plant);
}
END_TEST

static Suite *plant_suite(void)
{
    Suite *suite = suite_create("plant");
    TCase *motors = tcase_create("motors");
    tcase_add_checked_fixture(motors, NULL, teardown);
    tcase_add_test(motors, the_true_position_follows_the_pulses);
    tcase_add_test(motors, C11_in_simulation_mode_nothing_moves);
    tcase_add_test(motors, C11_the_direction_is_right_after_simulation_mode);
    tcase_add_test(motors, a_counter_that_is_set_does_not_move_the_axis);
    tcase_add_test(motors, the_offset_counts_from_the_counter_when_the_plant_comes);
    tcase_add_test(motors, motors_that_the_plant_does_not_name_have_no_true_position);
    tcase_add_test(motors, U8_a_reset_clears_the_counter_and_leaves_the_axis_where_it_is);
    tcase_add_test(motors, a_motor_without_power_does_not_move);
    tcase_add_test(motors, an_end_stop_costs_the_steps_that_go_against_it);
    tcase_add_test(motors, a_missing_lead_means_that_the_motor_does_not_turn);
    tcase_add_test(motors, a_jam_holds_the_motor_from_a_time_to_a_time);
    tcase_add_test(motors, a_jam_without_an_end_has_none);
    suite_add_tcase(suite, motors);

    TCase *switches = tcase_create("switches");
    tcase_add_checked_fixture(switches, NULL, teardown);
    tcase_add_test(switches, an_input_is_1_while_the_position_is_at_least_at_most_or_between);
    tcase_add_test(switches, a_limit_move_ends_at_the_switch);
    tcase_add_test(switches, K2_a_switch_is_seen_in_the_next_slot_of_a_unit_that_was_powered_up_at_any_tick);
    tcase_add_test(switches, hysteresis_keeps_a_switch_until_the_motor_is_that_far_away);
    tcase_add_test(switches, hysteresis_of_a_window_counts_on_both_sides);
    tcase_add_test(switches, a_normally_closed_switch_is_1_until_it_is_actuated);
    tcase_add_test(switches, of_several_switches_at_an_input_one_is_enough);
    tcase_add_test(switches, other_inputs_stay_as_a_hand_has_set_them);
    tcase_add_test(switches, without_a_plant_inputs_are_those_set_by_hand_again);
    tcase_add_test(switches, switches_of_a_turntable_depend_on_the_angle);
    tcase_add_test(switches, hysteresis_of_a_turntable_reaches_across_zero);
    tcase_add_test(switches, a_switch_that_bounces_changes_several_times_and_then_rests);
    tcase_add_test(switches, a_wait_for_an_input_sees_a_bounce_that_lasts_into_a_slot);
    suite_add_tcase(suite, switches);

    TCase *time = tcase_create("time");
    tcase_add_checked_fixture(time, NULL, teardown);
    tcase_add_loop_test(time, K3_it_does_not_matter_how_time_is_cut, 0, 10);
    tcase_add_test(time, a_copy_goes_on_as_the_original_would_have_only_later);
    tcase_add_test(time, pulses_that_nobody_takes_still_count);
    suite_add_tcase(suite, time);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(plant_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=motors|switches|time ./test_plant");
    return failed > 0;
}
