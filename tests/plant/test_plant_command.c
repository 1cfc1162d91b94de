/* SPDX-License-Identifier: MIT */
/* test_plant_command.c: plant.get and plant.set. One test case alone: CK_RUN_CASE=commands ./test_plant_command */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "plant_rig.h"

static struct plant_rig rig;

static const char plant[] = "motors: {1: {offset: 5, stops: {low: 0, high: 50}}, 3: {turn: 20}}\n"
                            "switches: [{input: 02, motor: 1, at_most: 4, bounce: 1ms}]\n";

static void setup(void)
{
    ck_assert(plant_rig_begin(&rig, "1", plant));
}

static void teardown(void)
{
    plant_rig_end(&rig);
}

#define ck_assert_command(method, params, result) ck_assert_str_eq(plant_rig_command(&rig, method, params), result)

START_TEST(plant_get_has_counter_and_true_position_side_by_side)
{
    plant_rig_program(&rig, 1, '1', "S100 F60 R");
    plant_rig_program(&rig, 1, '3', "S100 B7 R");
    plant_rig_run(&rig, 1000000);
    ck_assert_command("plant.get", NULL,
                      "{\"plant\":{\"levels\":0,\"mask\":2,\"motors\":["
                      "{\"angle\":null,\"hold\":\"end_stop\",\"jammed\":false,\"lost\":15,\"missing_lead\":false,\"motor\":1,"
                      "\"position\":60,\"stops\":{\"high\":50,\"low\":0},\"true_position\":50,\"turn\":null},"
                      "{\"angle\":13,\"hold\":null,\"jammed\":false,\"lost\":0,\"missing_lead\":false,\"motor\":3,"
                      "\"position\":-7,\"stops\":{\"high\":null,\"low\":null},\"true_position\":-7,\"turn\":20}],"
                      "\"switches\":[{\"actuated\":false,\"bouncing\":false,\"from\":null,\"input\":2,\"motor\":1,\"to\":4}]},"
                      "\"t_us\":1000000}");
}
END_TEST

START_TEST(plant_get_without_a_plant_says_so)
{
    ck_assert_command("plant.set", "{\"plant\": null}", "{\"t_us\":0}");
    ck_assert_command("plant.get", NULL, "{\"plant\":null,\"t_us\":0}");
}
END_TEST

START_TEST(a_plant_may_be_given_as_an_object_or_as_text)
{
    ck_assert_command("plant.set", "{\"plant\": {\"motors\": {\"2\": {\"offset\": 3}}, \"switches\": [{\"input\": \"08\","
                                   " \"motor\": 2, \"between\": [3, 4]}]}}", "{\"t_us\":0}");
    ck_assert_int_eq(true_position(&rig, 2), 3);
    ck_assert_uint_eq(inputs(&rig), 0x80);
    ck_assert_command("plant.set", "{\"plant\": \"motors:\\n  2: {offset: 4}\\n\"}", "{\"t_us\":0}");
    ck_assert_int_eq(true_position(&rig, 2), 4);
    ck_assert_str_eq(rig.sim.plant_text, "motors:\n  2: {offset: 4}\n");
}
END_TEST

START_TEST(a_hand_puts_the_carriage_somewhere_and_the_switches_follow)
{
    ck_assert_str_ne(plant_rig_command(&rig, "plant.set", "{\"motor\": 1, \"position\": 0}"), "");
    ck_assert_int_eq(true_position(&rig, 1), 0);
    ck_assert_int_eq(counter(&rig, 1), 0);
    ck_assert_uint_eq(inputs(&rig), 2);
    plant_rig_run(&rig, 5000);
    ck_assert_uint_gt(rig.inputs, 1); /* it has bounced */
    ck_assert_uint_eq(inputs(&rig), 2);
    ck_assert_command("plant.set", "{\"motor\": 1, \"position\": 51}",
                      "-32602 position: expected a position between the end stops of motor 1");
    ck_assert_int_eq(true_position(&rig, 1), 0);
}
END_TEST

START_TEST(a_hand_jams_a_motor_and_lets_it_go)
{
    plant_rig_program(&rig, 1, '1', "S100 V100 F20 R");
    plant_rig_run(&rig, 59000);
    ck_assert_ptr_nonnull(strstr(plant_rig_command(&rig, "plant.set", "{\"motor\": 1, \"jammed\": true}"), "\"jammed\":true"));
    plant_rig_run(&rig, 50000);
    ck_assert_int_eq(true_position(&rig, 1), 5 + 5);
    plant_rig_command(&rig, "plant.set", "{\"motor\": 1, \"jammed\": false}");
    plant_rig_run(&rig, 1000000);
    ck_assert_int_eq(true_position(&rig, 1), 5 + 15);
}
END_TEST

START_TEST(a_hand_takes_a_lead_off_and_puts_it_on_again)
{
    plant_rig_command(&rig, "plant.set", "{\"motor\": 1, \"missing_lead\": true, \"jammed\": false}");
    plant_rig_program(&rig, 1, '1', "S100 F20 R");
    plant_rig_run(&rig, 1000000);
    ck_assert_int_eq(true_position(&rig, 1), 5);
    plant_rig_command(&rig, "plant.set", "{\"motor\": 1, \"missing_lead\": false}");
    plant_rig_program(&rig, 1, '1', "F20 R");
    plant_rig_run(&rig, 1000000);
    ck_assert_int_eq(true_position(&rig, 1), 25);
}
END_TEST

static const char *const refused[][2] = {
    {"{}", "-32602 expected plant, or motor and one of position, jammed, missing_lead"},
    {"{\"plant\": 5}", "-32602 plant: expected an object, the text of a plant file, or null"},
    {"{\"plant\": null, \"motor\": 1}", "-32602 unknown parameter `motor': expected plant"},
    {"{\"plant\": {\"motors\": {\"1\": {\"offset\": true}}}}",
     "-32602 plant: expected the offset, a whole number -1000000000000..1000000000000, found true"},
    {"{\"plant\": \"motors: {1: {ofset: 1}}\\n\"}",
     "-32602 plant: plant:1:14: error: expected offset, stops, turn, stall, jam or missing_lead,"
     " found \"ofset\"; did you mean `offset'?"},
    {"{\"motor\": 1}", "-32602 expected position, jammed or missing_lead"},
    {"{\"motor\": 1, \"jammed\": 1}", "-32602 jammed: expected true or false"},
    {"{\"motor\": 1, \"jammed\": true, \"position\": 1}", "-32602 expected position alone, without jammed and missing_lead"},
    {"{\"motor\": 1, \"position\": \"1\"}", "-32602 position: expected a whole number from -1000000000000 to 1000000000000"},
    {"{\"motor\": 2, \"jammed\": true}", "-32000 motor 2 is not in the plant: configure it with plant.set and plant"},
    {"{\"motor\": 5, \"jammed\": true}", "-32602 motor: expected a whole number from 1 to 4"},
    {"{\"unit\": 2, \"motor\": 1, \"jammed\": true}", "-32602 unit: there is no such unit: expected one of 1"},
    {"{\"motor\": 1, \"jam\": true}",
     "-32602 unknown parameter `jam': expected unit, motor, position, jammed, missing_lead"},
};

START_TEST(what_cannot_be_done_is_refused_with_the_reason)
{
    ck_assert_command("plant.set", refused[_i][0], refused[_i][1]);
    ck_assert_str_eq(rig.sim.plant_text, plant);
    ck_assert_int_eq(true_position(&rig, 1), 5);
}
END_TEST

static Suite *plant_command_suite(void)
{
    Suite *suite = suite_create("plant_command");
    TCase *commands = tcase_create("commands");
    tcase_add_checked_fixture(commands, setup, teardown);
    tcase_add_test(commands, plant_get_has_counter_and_true_position_side_by_side);
    tcase_add_test(commands, plant_get_without_a_plant_says_so);
    tcase_add_test(commands, a_plant_may_be_given_as_an_object_or_as_text);
    tcase_add_test(commands, a_hand_puts_the_carriage_somewhere_and_the_switches_follow);
    tcase_add_test(commands, a_hand_jams_a_motor_and_lets_it_go);
    tcase_add_test(commands, a_hand_takes_a_lead_off_and_puts_it_on_again);
    tcase_add_loop_test(commands, what_cannot_be_done_is_refused_with_the_reason, 0, sizeof refused / sizeof refused[0]);
    suite_add_tcase(suite, commands);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(plant_command_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=commands ./test_plant_command");
    return failed > 0;
}
