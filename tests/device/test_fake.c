/* SPDX-License-Identifier: MIT */
/* test_fake.c: a second kind of device, after src/device/device.h alone: bus, time, flash, faults, plants, conditions. */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "fake.h"
#include "fake_device.h"
#include "fake_rig.h"

#define SECOND UINT64_C(1000000)

static struct fake_rig rig;

static void begin_one(void)
{
    fake_rig_begin(&rig, "1", false);
}

static void end(void)
{
    fake_rig_end(&rig);
}

static void expect_seen(const char *expected)
{
    ck_assert_str_eq(fake_rig_seen(&rig), expected);
}

/* ---- Kinds ---------------------------------------------------------------------------------------------------------- */

START_TEST(kind_is_found_by_its_name_after_those_of_the_product)
{
    ck_assert_str_eq(device_kind_at(0)->name, "rkm04");
    ck_assert_ptr_eq(device_kind_named("fake"), &fake_device);
    ck_assert_ptr_null(device_kind_named("fak"));
    ck_assert_ptr_null(device_kind_named(""));
    unsigned count = 0;
    while (device_kind_at(count))
        count++;
    ck_assert_ptr_eq(device_kind_at(count - 2), &fake_device);
}
END_TEST

/* ---- Bus and time --------------------------------------------------------------------------------------------------- */

/* 6 bytes of 3125/6 us, the turnaround, and the two bytes of the answer. */
START_TEST(bytes_take_their_time_on_the_wires)
{
    fake_rig_begin(&rig, "1", true);
    fake_rig_ask(&rig, 1, "POS?");
    sim_advance(&rig.sim, SECOND);
    expect_seen("4167 heard 30\n4688 heard 0d\n");
    end();
}
END_TEST

START_TEST(units_answer_to_their_address_only)
{
    fake_rig_begin(&rig, "7,16", false);
    fake_rig_expect_answer(&rig, 7, "MOVE 3", "OK");
    sim_advance(&rig.sim, SECOND);
    fake_rig_expect_answer(&rig, 7, "POS?", "3");
    fake_rig_expect_answer(&rig, 16, "POS?", "0");
    fake_rig_expect_answer(&rig, 9, "POS?", "");
    end();
}
END_TEST

/* 4 ticks are 1 us: steps at 333333.25 us, 666666.5 us, 999999.75 us. */
START_TEST(ticks_of_a_unit_become_us)
{
    fake_rig_expect_answer(&rig, 1, "RATE 3", "OK");
    sim_advance(&rig.sim, 1000);
    fake_rig_ask(&rig, 1, "MOVE -3");
    sim_advance(&rig.sim, 2 * SECOND);
    expect_seen("1000 heard 4f\n1000 heard 4b\n1000 heard 0d\n"
                "1000 unit 1 motor 1 direction 0\n1000 unit 1 motor 1 motion 1\n1000 unit 1 motor 1 led 1\n"
                "334333 unit 1 motor 1 step -1\n667666 unit 1 motor 1 step -2\n1000999 unit 1 motor 1 step -3\n"
                "1000999 unit 1 motor 1 motion 0\n1000999 unit 1 motor 1 led 0\n");
}
END_TEST

START_TEST(next_event_is_the_next_step_and_next_report_the_end)
{
    fake_rig_expect_answer(&rig, 1, "MOVE 5", "OK");
    sim_unwatch(&rig.sim, &rig.watcher);
    ck_assert_uint_eq(sim_next_event(&rig.sim), 10000);
    ck_assert_uint_eq(sim_next_report(&rig.sim), 50000);
    sim_advance(&rig.sim, SECOND);
    ck_assert_uint_eq(sim_next_event(&rig.sim), DEVICE_NEVER);
    sim_watch(&rig.sim, &rig.watcher);
}
END_TEST

START_TEST(requests_are_obeyed_or_refused)
{
    static const char *const pairs[][2] = {
        {"POS?", "0"}, {"OUT 1", "OK"}, {"OUT 2", "E2"}, {"OUT", "E1"}, {"MOVE 0", "E2"}, {"MOVE 1000001", "E2"},
        {"MOVE -", "E2"}, {"MOVE", "E1"}, {"RATE 0", "E2"}, {"RATE 10001", "E2"}, {"RATE 10000", "OK"}, {"pos?", "E1"},
        {"MOVE 99999999999", "E2"}, {"MOVE 9999999999999", ""}, {"IN?", "0"}, {"", "E1"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        fake_rig_expect_answer(&rig, 1, pairs[i][0], pairs[i][1]);
    fake_rig_expect_state(&rig, "do", "1");
}
END_TEST

START_TEST(texts_and_messages_reach_the_unit_without_the_bus)
{
    struct device_unit *unit = sim_core(&rig.sim, 1);
    char error[DEVICE_ERROR_SIZE];
    uint8_t answer[FAKE_TEXT_MAX];
    ck_assert_int_eq(fake_device.set_text(unit, 1, "MOVE 4", 6, error), 0);
    ck_assert_int_eq(fake_device.set_text(unit, 1, "MOVE x", 6, error), 12);
    ck_assert_str_eq(error, "the unit answers E2");
    sim_advance(&rig.sim, SECOND);
    ck_assert_uint_eq(fake_device.exchange(unit, (const uint8_t *)"POS?", 4, answer, sizeof answer), 1);
    ck_assert_int_eq(answer[0], '4');
}
END_TEST

START_TEST(address_is_set_like_a_switch_and_read_at_power_up)
{
    fake_rig_do(&rig, "switch", "{\"node\": 100}");
    fake_rig_expect_answer(&rig, 1, "POS?", "0");
    fake_rig_do(&rig, "reset", "{}");
    fake_rig_expect_answer(&rig, 1, "POS?", "");
    fake_rig_expect_answer(&rig, 100, "POS?", "0");
    fake_rig_expect_refusal(&rig, "switch", "{\"node\": 101}", "100");
}
END_TEST

/* ---- Snapshots and flash -------------------------------------------------------------------------------------------- */

START_TEST(snapshot_is_a_copy_of_the_unit)
{
    fake_rig_expect_answer(&rig, 1, "MOVE 4", "OK");
    sim_advance(&rig.sim, 25000);
    fake_rig_do(&rig, "snapshot", "{\"name\": \"a\"}");
    fake_rig_seen(&rig);
    sim_advance(&rig.sim, 100000);
    expect_seen("30000 unit 1 motor 1 step 3\n40000 unit 1 motor 1 step 4\n40000 unit 1 motor 1 motion 0\n"
                "40000 unit 1 motor 1 led 0\n");
    fake_rig_do(&rig, "restore", "{\"name\": \"a\"}");
    fake_rig_expect_state(&rig, "motors.0.position", "2");
    fake_rig_seen(&rig);
    sim_advance(&rig.sim, 200000);
    expect_seen("100000 unit 1 motor 1 position 2\n100000 unit 1 motor 1 motion 1\n100000 unit 1 motor 1 led 1\n"
                "105000 unit 1 motor 1 step 3\n115000 unit 1 motor 1 step 4\n115000 unit 1 motor 1 motion 0\n"
                "115000 unit 1 motor 1 led 0\n");
}
END_TEST

START_TEST(flash_outlives_the_power)
{
    fake_rig_expect_answer(&rig, 1, "RATE 500", "OK");
    fake_rig_expect_answer(&rig, 1, "SAVE", "OK");
    fake_rig_expect_answer(&rig, 1, "RATE 700", "OK");
    fake_rig_do(&rig, "power", "{\"on\": false}");
    fake_rig_expect_answer(&rig, 1, "POS?", "");
    fake_rig_do(&rig, "power", "{\"on\": true}");
    fake_rig_expect_answer(&rig, 1, "POS?", "0");
    fake_rig_expect_state(&rig, "rate", "500");
}
END_TEST

/* ---- Injected faults ------------------------------------------------------------------------------------------------- */

START_TEST(faults_of_bytes_and_answers)
{
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"drop\", \"direction\": \"to_units\", \"count\": 1}");
    fake_rig_expect_answer(&rig, 1, "POS?", "");
    fake_rig_expect_answer(&rig, 1, "POS?", "0");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"no_answer\", \"count\": 1}");
    fake_rig_expect_answer(&rig, 1, "POS?", "");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"cut\", \"bytes\": 1, \"count\": 1}");
    fake_rig_expect_answer(&rig, 1, "MOVE 1", "O");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"flip\", \"mask\": 1, \"direction\": \"to_master\", \"count\": 1}");
    fake_rig_expect_answer(&rig, 1, "POS?", "1");
    fake_rig_expect_answer(&rig, 1, "POS?", "0");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"wrong_fcs\"}", "lines");
}
END_TEST

START_TEST(fault_delays_an_answer)
{
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"delay\", \"delay\": \"7ms\", \"count\": 1}");
    fake_rig_ask(&rig, 1, "POS?");
    fake_rig_seen(&rig);
    sim_advance(&rig.sim, SECOND);
    expect_seen("0 unit 1 motor 0 injected 1\n7000 heard 30\n7000 heard 0d\n");
}
END_TEST

START_TEST(flash_fails)
{
    fake_rig_expect_answer(&rig, 1, "RATE 500", "OK");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"flash\", \"operation\": \"program\", \"count\": 1}");
    fake_rig_expect_answer(&rig, 1, "SAVE", "E4");
    fake_rig_do(&rig, "reset", "{}");
    fake_rig_expect_state(&rig, "rate", "100");
}
END_TEST

START_TEST(power_fails_within_a_write)
{
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"power\", \"operation\": 1, \"duration\": \"50ms\"}");
    fake_rig_expect_answer(&rig, 1, "SAVE", "");
    fake_rig_expect_answer(&rig, 1, "POS?", "");
    sim_advance(&rig.sim, 60000);
    fake_rig_expect_answer(&rig, 1, "POS?", "0");
}
END_TEST

START_TEST(fault_holds_an_input)
{
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": 1, \"level\": 1, \"duration\": \"20ms\"}");
    fake_rig_expect_answer(&rig, 1, "IN?", "1");
    fake_rig_expect_answer(&rig, 1, "MOVE 5", "E3");
    sim_advance(&rig.sim, 30000);
    fake_rig_expect_answer(&rig, 1, "IN?", "0");
    fake_rig_do(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": 20, \"level\": 1, \"duration\": \"20ms\"}");
    fake_rig_expect_answer(&rig, 1, "IN?", "524288");
    fake_rig_expect_refusal(&rig, "fault.inject", "{\"kind\": \"input\", \"input\": 21, \"level\": 1}", "20");
}
END_TEST

/* ---- Inputs, plants, conditions --------------------------------------------------------------------------------------- */

START_TEST(inputs_are_set_by_hand)
{
    fake_rig_do(&rig, "di.set", "{\"di\": {\"02\": 1}}");
    fake_rig_expect_answer(&rig, 1, "IN?", "2");
    fake_rig_do(&rig, "di.set", "{\"di\": {\"20\": 1}}");
    fake_rig_expect_answer(&rig, 1, "IN?", "524290");
    fake_rig_expect_state(&rig, "di", "524290");
    fake_rig_do(&rig, "di.set", "{\"mask\": 1024}");
    fake_rig_expect_answer(&rig, 1, "IN?", "1024");
    fake_rig_expect_refusal(&rig, "di.set", "{\"di\": {\"21\": 1}}", "expected 1 to 20");
    fake_rig_expect_refusal(&rig, "di.set", "{\"mask\": 1048576}", "1048575");
}
END_TEST

START_TEST(device_has_methods_of_its_own)
{
    fake_rig_do(&rig, "fake.rate", "{\"rate\": 1000, \"unit\": 1}");
    fake_rig_expect_state(&rig, "rate", "1000");
    fake_rig_expect_refusal(&rig, "fake.rate", "{\"rate\": 0}", "rate: expected steps/s from 1 to 10000");
    fake_rig_expect_refusal(&rig, "fake.rate", "{\"rate\": 5, \"unit\": 7}", "unit: there is no such unit");
    fake_rig_do(&rig, "di.set", "{\"di\": {\"2\": 1}}");
    fake_rig_expect_refusal(&rig, "fake.rote", "{}", "did you mean `fake.rate'?");
    fake_rig_expect_refusal(&rig, "stat", "{}", "did you mean `state'?");
    fake_rig_expect_refusal(&rig, "snapshoot", "{}", "did you mean `snapshot'?");
    fake_rig_do(&rig, "power", "{\"on\": false}");
    fake_rig_expect_refusal(&rig, "fake.rate", "{\"rate\": 5}", "unit 1 has no power");
}
END_TEST

/* A plant is taken, or refused with a message that has `refusal` in it. */
static void set_plant(const char *text, const char *refusal)
{
    char *errors;
    size_t length;
    FILE *out = open_memstream(&errors, &length);
    bool is_taken = sim_configure_plants(&rig.sim, "plant", text, strlen(text), out);
    fclose(out);
    ck_assert_msg(is_taken == (refusal == NULL) && (is_taken || strstr(errors, refusal)), "%s: %s", text, errors);
    free(errors);
}

START_TEST(switch_of_a_plant_ends_the_motion)
{
    set_plant("motors:\n  1: {offset: 100}\nswitches:\n  - {input: 1, motor: 1, at_least: 105}\n", NULL);
    fake_rig_expect_answer(&rig, 1, "MOVE 50", "OK");
    sim_advance(&rig.sim, SECOND);
    const char *seen = fake_rig_seen(&rig);
    ck_assert_msg(strstr(seen, "50001 unit 1 motor 0 inputs 1\n50001 unit 1 motor 1 motion 0\n50001 unit 1 motor 1 led 0\n"
                               "50001 unit 1 motor 1 fault 1\n"),
                  "%s", seen);
    fake_rig_expect_state(&rig, "motors.0.position", "5");
    fake_rig_expect_state(&rig, "motors.0.true_position", "105");
    fake_rig_expect_state(&rig, "motors.0.fault", "\"limit\"");
    fake_rig_expect_answer(&rig, 1, "MOVE 1", "E3");
    fake_rig_expect_answer(&rig, 1, "MOVE -2", "OK");
    sim_advance(&rig.sim, 2 * SECOND);
    fake_rig_expect_answer(&rig, 1, "IN?", "0");
}
END_TEST

START_TEST(plant_has_the_axes_and_inputs_of_the_device)
{
    set_plant("motors: {2: {offset: 1}}", "plant:1:10: error: expected 1, found");
    set_plant("switches: [{input: 20, motor: 1, at_least: 0}]", NULL);
    fake_rig_expect_answer(&rig, 1, "IN?", "524288");
    fake_rig_do(&rig, "di.set", "{\"mask\": 2}");
    fake_rig_expect_answer(&rig, 1, "IN?", "524290");
    set_plant("switches: [{input: 21, motor: 1, at_least: 5}]", "expected an input, a whole number 1..20, found 21");
}
END_TEST

static void expect_condition(const char *text, bool holds, uint64_t limit, uint64_t us)
{
    struct refusal refusal;
    json_t *json = json_loads(text, 0, NULL);
    struct condition *condition = condition_read(&rig.sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s: %s", text, refusal.text);
    condition_arm(condition);
    ck_assert_msg(condition_run(condition, limit) == holds, "%s", text);
    ck_assert_uint_eq(sim_now(&rig.sim), us);
    condition_free(condition);
    json_decref(json);
}

static void expect_no_condition(const char *text, const char *expected)
{
    struct refusal refusal;
    json_t *json = json_loads(text, 0, NULL);
    ck_assert_msg(condition_read(&rig.sim, json, &refusal) == NULL, "%s is taken", text);
    ck_assert_msg(strstr(refusal.text, expected) != NULL, "%s: %s", text, refusal.text);
    json_decref(json);
}

START_TEST(conditions_know_the_names_and_numbers_of_the_device)
{
    fake_rig_expect_answer(&rig, 1, "MOVE 10", "OK");
    expect_condition("{\"motor\": 1, \"state\": \"moving\"}", true, SECOND, 1);
    expect_condition("{\"motor\": 1, \"position\": {\">=\": 5}}", true, SECOND, 50001);
    expect_condition("{\"motor\": 1, \"led\": \"off\"}", true, SECOND, 100001);
    expect_condition("{\"idle\": true, \"do\": {\"1\": 0}}", true, SECOND, 100001);
    expect_condition("{\"motor\": 1, \"fault\": \"limit\"}", false, 150000, 150000);
    expect_no_condition("{\"motor\": 2, \"position\": 5}", "1");
    expect_no_condition("{\"motor\": 1, \"state\": \"dwell\"}", "moving");
    expect_no_condition("{\"motor\": 1, \"fault\": \"no_label\"}", "limit");
    fake_rig_do(&rig, "di.set", "{\"di\": {\"20\": 1}}");
    expect_condition("{\"di\": {\"20\": 1, \"12\": 0}}", true, SECOND, 150000);
    expect_no_condition("{\"di\": {\"21\": 1}}", "20");
    expect_no_condition("{\"do\": {\"2\": 1}}", "1");
    expect_no_condition("{\"var\": {\"80\": 1}}", "var");
}
END_TEST

static Suite *fake_suite(void)
{
    Suite *suite = suite_create("fake");
    TCase *bus = tcase_create("bus"), *one = tcase_create("one");
    tcase_add_test(bus, kind_is_found_by_its_name_after_those_of_the_product);
    tcase_add_test(bus, bytes_take_their_time_on_the_wires);
    tcase_add_test(bus, units_answer_to_their_address_only);
    tcase_add_checked_fixture(one, begin_one, end);
    tcase_add_test(one, ticks_of_a_unit_become_us);
    tcase_add_test(one, next_event_is_the_next_step_and_next_report_the_end);
    tcase_add_test(one, requests_are_obeyed_or_refused);
    tcase_add_test(one, texts_and_messages_reach_the_unit_without_the_bus);
    tcase_add_test(one, address_is_set_like_a_switch_and_read_at_power_up);
    tcase_add_test(one, snapshot_is_a_copy_of_the_unit);
    tcase_add_test(one, flash_outlives_the_power);
    tcase_add_test(one, faults_of_bytes_and_answers);
    tcase_add_test(one, fault_delays_an_answer);
    tcase_add_test(one, flash_fails);
    tcase_add_test(one, power_fails_within_a_write);
    tcase_add_test(one, fault_holds_an_input);
    tcase_add_test(one, inputs_are_set_by_hand);
    tcase_add_test(one, device_has_methods_of_its_own);
    tcase_add_test(one, switch_of_a_plant_ends_the_motion);
    tcase_add_test(one, plant_has_the_axes_and_inputs_of_the_device);
    tcase_add_test(one, conditions_know_the_names_and_numbers_of_the_device);
    suite_add_tcase(suite, bus);
    suite_add_tcase(suite, one);
    return suite;
}

int main(void)
{
    return rig_run(fake_suite(), "./test_fake");
}
