/* SPDX-License-Identifier: MIT */
/* test_plant_read.c: plant files: what is refused, and with which words.
 * One test case alone: CK_RUN_CASE=files ./test_plant_read */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "plant_rig.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static struct plant_rig rig;

static void teardown(void)
{
    plant_rig_end(&rig);
}

/* ---- Units ---------------------------------------------------------------------------------------------------------- */

START_TEST(with_several_units_each_has_its_own_plant)
{
    int64_t position;
    ck_assert(plant_rig_begin(&rig, "3,5,5", "units:\n  3: {motors: {1: {offset: 30}}}\n"
                                             "  5-2: {switches: [{input: 04, motor: 2, at_least: 2}]}\n"));
    plant_rig_program(&rig, 1, '1', "S100 F5 R");
    plant_rig_program(&rig, 3, '2', "S100 F5 R");
    plant_rig_run(&rig, 1000000);
    ck_assert(plant_position(rig.sim.unit[0].plant, 1, &position));
    ck_assert_int_eq(position, 35);
    ck_assert_ptr_null(rig.sim.unit[1].plant);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&rig.sim, 2))), 0);
    ck_assert_uint_eq(rkm04_inputs(rkm04_of(sim_core(&rig.sim, 3))), 8);
}
END_TEST

START_TEST(with_several_units_the_file_must_say_which)
{
    ck_assert(!plant_rig_begin(&rig, "3,5", "motors: {1: }"));
    ck_assert_str_eq(rig.errors, "plant:1:1: error: expected units: there are 2 on the bus\n");
    ck_assert(!plant_rig_configure(&rig, "units: {4: {motors: {1: }}}"));
    ck_assert_str_eq(rig.errors, "plant:1:9: error: expected 3 or 5, found \"4\"\n");
    ck_assert(!plant_rig_configure(&rig, "units: {3: {motors: {1: }}, 5: {motor: 1}}"));
    ck_assert_str_eq(rig.errors, "plant:1:33: error: expected motors or switches, found \"motor\"; did you mean `motors'?\n");
    ck_assert_ptr_null(rig.sim.unit[0].plant);
}
END_TEST

START_TEST(a_motor_that_only_follows_needs_no_more_than_its_number)
{
    ck_assert(plant_rig_begin(&rig, "1", "motors:\n  1:\n  2: ~\n  3: {}\n"));
    ck_assert_int_eq(true_position(&rig, 1) + true_position(&rig, 2) + true_position(&rig, 3), 0);
    ck_assert(plant_rig_configure(&rig, "{\"motors\": {\"4\": null}}"));
    ck_assert_int_eq(true_position(&rig, 4), 0);
}
END_TEST

/* ---- Files ---------------------------------------------------------------------------------------------------------- */

START_TEST(a_plant_that_is_refused_leaves_the_one_before_in_place)
{
    ck_assert(plant_rig_begin(&rig, "1", "motors: {1: {offset: 7}}"));
    ck_assert(!plant_rig_configure(&rig, "motors: {1: {offset: x}}"));
    ck_assert_int_eq(true_position(&rig, 1), 7);
    ck_assert_str_eq(rig.sim.plant_text, "motors: {1: {offset: 7}}");
}
END_TEST

#define MOTOR(text) "motors: {1: {" text "}}"
#define SWITCH(text) "switches: [{input: 01, motor: 1, " text "}]"

static const struct {
    const char *text, *said;
} refused[] = {
    {"[]", "1:1: error: expected a plant: motors and switches"},
    {"motor: 1", "1:1: error: expected units, motors or switches, found \"motor\"; did you mean `motors'?"},
    {"units: {1: {}}\nmotors: {}", "2:1: error: expected units, found \"motors\""},
    {"units: 1", "1:8: error: expected plants by unit, as in {3: {motors: …, switches: …}}"},
    {"units: {1: x}", "1:12: error: expected motors and switches"},
    {"motors: []", "1:9: error: expected motors by number, as in {1: {offset: 0}}"},
    {"motors: {5: {}}", "1:10: error: expected 1, 2, 3 or 4, found \"5\""},
    {"motors: {1: 5}", "1:13: error: expected a motor, as in {offset: 0}"},
    {MOTOR("ofset: 1"), "1:14: error: expected offset, stops, turn, stall, jam or missing_lead,"
     " found \"ofset\"; did you mean `offset'?"},
    {MOTOR("offset: 1.5"), "1:22: error: expected the offset, a whole number -1000000000000..1000000000000, found 1.5"},
    {MOTOR("turn: 1"), "1:20: error: expected the steps per turn, a whole number 2..1000000000000, found 1"},
    {MOTOR("turn: 100, stops: {low: 1}"), "1:20: error: expected turn or stops: a turntable has no end"},
    {MOTOR("missing_lead: 2"), "1:28: error: expected whether a lead is missing, true or false, found 2"},
    {MOTOR("stops: 5"), "1:21: error: expected the end stops, as in {low: -50, high: 20000}"},
    {MOTOR("stops: {top: 5}"), "1:22: error: expected low or high, found \"top\""},
    {MOTOR("stops: {low: 5, high: 4}"), "1:21: error: expected a lower end stop that is not above the upper one"},
    {MOTOR("stops: {low: 5}"), "1:13: error: expected a motor between its end stops, found it at 0 (counter 0, offset 0)"},
    {MOTOR("jam: 5s"), "1:19: error: expected a jam, as in {from: 2s, to: 2500ms}"},
    {MOTOR("jam: [{from: 5}]"),
     "1:27: error: expected the beginning of the jam, a time with its unit, such as 250us, 1500ms or 2.5s, found 5"},
    {MOTOR("jam: {from: 5s, to: 5s}"), "1:19: error: expected a jam that ends after it begins"},
    {MOTOR("jam: [{}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}]"),
     "1:84: error: expected at most 16 jams of a motor"},
    {MOTOR("stall: 5"),
     "1:21: error: expected the limits of the motor, as in {start: 500, limit: [{speed: 4000, acceleration: 20000}]}"},
    {MOTOR("stall: {start: 5}"),
     "1:21: error: expected start and limit, as in {start: 500, limit: [{speed: 4000, acceleration: 20000}]}"},
    {MOTOR("stall: {start: 0, limit: []}"),
     "1:29: error: expected the highest speed to start with, in steps/s, a whole number 1..1000000, found 0"},
    {MOTOR("stall: {start: 1, limit: []}"),
     "1:39: error: expected a list of points, as in [{speed: 4000, acceleration: 20000}]"},
    {MOTOR("stall: {start: 1, limit: [5]}"), "1:40: error: expected a point, as in {speed: 1000, acceleration: 20000}"},
    {MOTOR("stall: {start: 1, limit: [{speed: 5}]}"),
     "1:40: error: expected speed and acceleration, as in {speed: 1000, acceleration: 20000}"},
    {MOTOR("stall: {start: 1, limit: [{speed: 5, acceleration: -1}]}"),
     "1:65: error: expected an acceleration in steps/s^2, a whole number 0..1000000000, found -1"},
    {MOTOR("stall: {start: 1, limit: [{speed: 5, acceleration: 1}, {speed: 5, acceleration: 1}]}"),
     "1:77: error: expected points with speeds that increase"},
    {"switches: {}", "1:11: error: expected a list of switches"},
    {"switches: [1]", "1:12: error: expected a switch, as in {input: 01, motor: 1, at_most: 0}"},
    {"switches: [{input: 1}]", "1:12: error: expected input and motor, as in {input: 01, motor: 1, at_most: 0}"},
    {"switches: [{input: 9, motor: 1}]", "1:20: error: expected an input, a whole number 1..8, found 9"},
    {"switches: [{input: 8, motor: 0}]", "1:30: error: expected a motor, a whole number 1..4, found 0"},
    {SWITCH("on: 1"), "1:34: error: expected input, motor, at_least, at_most, between, hysteresis, bounce or normally_closed,"
                      " found \"on\""},
    {SWITCH("bounce: 1s"), "1:12: error: expected one of at_least, at_most and between: [low, high]"},
    {SWITCH("at_least: 1, at_most: 4"), "1:12: error: expected one of at_least, at_most and between: [low, high]"},
    {SWITCH("between: 1"), "1:43: error: expected two positions, as in [100, 120]"},
    {SWITCH("between: [1, 2, 3]"), "1:43: error: expected two positions, as in [100, 120]"},
    {SWITCH("between: [2, 1]"), "1:43: error: expected the lower position first"},
    {SWITCH("at_most: 1, hysteresis: -1"), "1:12: error: expected a hysteresis of 0 or more steps"},
    {SWITCH("at_most: 1, bounce: 1000001us"), "1:12: error: expected a switch that bounces for at most 1s"},
    {SWITCH("at_most: 1, bounce: fast"),
     "1:54: error: expected the bounce time, a time with its unit, such as 250us, 1500ms or 2.5s, found fast"},
    {SWITCH("at_most: 1, normally_closed: maybe"),
     "1:63: error: expected whether it opens when it is actuated, true or false, found maybe"},
    {MOTOR("turn: 100") "\n" SWITCH("at_most: 100"), "2:12: error: expected positions of a turntable, 0..99"},
    {MOTOR("turn: 100") "\n" SWITCH("between: [5, 44], hysteresis: 30"),
     "2:12: error: expected a smaller hysteresis: with this one the switch is always actuated"},
};

START_TEST(what_is_wrong_is_said_with_its_place)
{
    char expected[400];
    ck_assert(!plant_rig_begin(&rig, "1", refused[_i].text));
    snprintf(expected, sizeof expected, "plant:%s\n", refused[_i].said);
    ck_assert_str_eq(rig.errors, expected);
    ck_assert_ptr_null(rig.sim.unit[0].plant);
}
END_TEST

START_TEST(a_plant_has_at_most_32_switches)
{
    char text[3000] = "switches:\n";
    for (unsigned i = 0; i < 33; i++)
        strcat(text, "  - {input: 01, motor: 1, at_most: 0}\n");
    ck_assert(!plant_rig_begin(&rig, "1", text));
    ck_assert_str_eq(rig.errors, "plant:34:5: error: expected at most 32 switches\n");
}
END_TEST

/* Whatever it is, it is taken and can run, or refused with a message (the sanitizers look). */
START_TEST(files_with_something_changed_are_taken_or_refused_with_a_message)
{
    static const char good[] = "motors:\n"
                               "  1: {offset: -5, stops: {low: -50, high: 2000}, jam: [{from: 2s, to: 2500ms}]}\n"
                               "  2: {turn: 3200, stall: {start: 500, limit: [{speed: 4000, acceleration: 9}]}}\n"
                               "switches:\n"
                               "  - {input: 01, motor: 1, at_most: 0, hysteresis: 2, bounce: 2ms}\n"
                               "  - {input: 02, motor: 2, between: [3190, 10], normally_closed: yes}\n";
    static const char *const other[] = {"", " ", "\n", "-", "0", "9", ":", "]", "}", "[", "{", "'", "99999999999", "~", "\xc3"};
    ck_assert(plant_rig_begin(&rig, "1", good));
    size_t taken = 0;
    for (size_t at = 0; at < sizeof good - 1; at++) {
        for (size_t i = 0; i < COUNT(other); i++) {
            char text[sizeof good + 20];
            snprintf(text, sizeof text, "%.*s%s%s", (int)at, good, other[i], good + at + 1);
            taken += plant_rig_configure(&rig, text);
        }
        plant_rig_program(&rig, 1, '0', "\\ S400 F3 R");
        plant_rig_run(&rig, 20000);
        ck_assert(plant_rig_configure(&rig, NULL));
        sim_power(&rig.sim, 1, true);
    }
    ck_assert_uint_gt(taken, 100);
}
END_TEST

static Suite *plant_read_suite(void)
{
    Suite *suite = suite_create("plant_read");
    TCase *units = tcase_create("units");
    tcase_add_checked_fixture(units, NULL, teardown);
    tcase_add_test(units, with_several_units_each_has_its_own_plant);
    tcase_add_test(units, with_several_units_the_file_must_say_which);
    tcase_add_test(units, a_motor_that_only_follows_needs_no_more_than_its_number);
    suite_add_tcase(suite, units);

    TCase *files = tcase_create("files");
    tcase_set_timeout(files, 60);
    tcase_add_checked_fixture(files, NULL, teardown);
    tcase_add_test(files, a_plant_that_is_refused_leaves_the_one_before_in_place);
    tcase_add_loop_test(files, what_is_wrong_is_said_with_its_place, 0, COUNT(refused));
    tcase_add_test(files, a_plant_has_at_most_32_switches);
    tcase_add_test(files, files_with_something_changed_are_taken_or_refused_with_a_message);
    suite_add_tcase(suite, files);
    return suite;
}

int main(void)
{
    SRunner *runner = srunner_create(plant_read_suite());
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    if (failed > 0)
        puts("one test case alone: CK_RUN_CASE=units|files ./test_plant_read");
    return failed > 0;
}
