/* SPDX-License-Identifier: MIT */
/* test_condition.c: conditions to wait for: what they read, when they hold, what they say. One case alone:
 * CK_RUN_CASE=CASE ./test_condition */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "condition/condition.h"
#include "core/rig.h"
#include "device/rkm04_device.h"

static struct sim *sim;
static struct condition *condition;
static struct refusal refusal;

static void begin(const char *nodes, bool timed)
{
    struct sim_config config = {.timed = timed, .turnaround = SEGMENT_TURNAROUND};
    ck_assert(node_list_read(&config.nodes, nodes));
    sim = calloc(1, sizeof *sim);
    ck_assert_ptr_nonnull(sim);
    ck_assert(sim_begin(sim, &config));
}

static void setup(void)
{
    begin("1", false);
}

static void setup_two(void)
{
    begin("3,5", true);
}

static void teardown(void)
{
    condition_free(condition);
    condition = NULL;
    sim_end(sim);
    free(sim);
}

static void program(unsigned number, char motor, const char *text)
{
    ck_assert_int_eq(rkm04_set_command(rkm04_of(sim_core(sim, number)), motor, text, strlen(text), NULL), 0);
}

/* Of motor 1. */
static int32_t position(void)
{
    struct rkm04_motor_state state;
    rkm04_motor_state(rkm04_of(sim_core(sim, 1)), 1, &state);
    return state.position;
}

/* Read a condition and arm it. */
static void wait_for(const char *text)
{
    json_error_t error;
    json_t *json = json_loads(text, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(json != NULL, "%s: %s", text, error.text);
    condition_free(condition);
    condition = condition_read(sim, json, &refusal);
    ck_assert_msg(condition != NULL, "%s: %s", text, refusal.text);
    json_decref(json);
    condition_arm(condition);
}

/* It comes to hold at this tick, not before. */
static void expect_at(const char *text, uint64_t tick)
{
    wait_for(text);
    ck_assert_msg(condition_run(condition, 1000 * SECOND), "%s never held", text);
    ck_assert_msg(sim_now(sim) == tick, "%s held at %llu, not %llu", text, (unsigned long long)sim_now(sim),
                  (unsigned long long)tick);
}

static void expect_text(const char *text, const char *said)
{
    wait_for(text);
    char *is = condition_text(condition);
    ck_assert_str_eq(is, said);
    free(is);
}

static void expect_refused(const char *text, const char *why)
{
    json_t *json = json_loads(text, JSON_DECODE_ANY, NULL);
    ck_assert_msg(json != NULL, "%s", text);
    struct condition *read = condition_read(sim, json, &refusal);
    json_decref(json);
    ck_assert_msg(read == NULL, "%s was taken", text);
    ck_assert_int_eq(refusal.code, REFUSED_PARAMS);
    ck_assert_msg(strstr(refusal.text, why) != NULL, "%s: refused with: %s", text, refusal.text);
}

/* ---- When it holds -------------------------------------------------------------------------------------------------- */

START_TEST(a_position_is_there_one_tick_after_its_pulse)
{
    program(1, '1', "S100 F100 R");
    uint64_t end = 3 * MS + move_ticks(100, 1000, 2000, 100); /* S F R */
    wait_for("{\"motor\": 1, \"position\": 1}");
    ck_assert(condition_run(condition, SECOND));
    uint64_t first = sim_now(sim);
    ck_assert_uint_eq(first, 3 * MS + 9161 + 1); /* 100 t + 1000 t^2 = 1 */
    ck_assert_int_eq(position(), 1);
    expect_at("{\"motor\": 1, \"position\": 100}", end + 1);
}
END_TEST

START_TEST(a_motor_is_idle_when_its_last_command_has_been_executed)
{
    program(1, '1', "S100 F100 R");
    wait_for("{\"motor\": 1, \"state\": \"idle\"}");
    ck_assert(!condition_holds(condition));
    uint64_t end = 3 * MS + move_ticks(100, 1000, 2000, 100);
    expect_at("{\"motor\": 1, \"state\": \"idle\"}", slot_behind(end) + 1);
}
END_TEST

START_TEST(all_motors_are_idle_when_the_last_one_is)
{
    program(1, '1', "W10");
    program(1, '4', "W700");
    expect_at("{\"idle\": true, \"motor\": 1}", 11 * MS + 1);
    expect_at("{\"idle\": true}", 701 * MS + 1);
}
END_TEST

START_TEST(outputs_variables_and_inputs_are_seen_to_the_tick)
{
    program(1, '2', "T03 W5 T81 O08 C03");
    expect_at("{\"do\": {\"03\": 1}}", 1 * MS + 1);
    expect_at("{\"var\": {\"81\": 1}, \"do\": {\"3\": true, \"04\": 0}}", 7 * MS + 1);
    sim_advance(sim, 20 * MS + 700);
    sim_set_di(sim, 1, 0x80);
    expect_at("{\"di\": {\"08\": 1}}", 20 * MS + 700);
    expect_at("{\"do\": {\"03\": 0}}", 22 * MS + 1); /* O in 21, C in 22 */
}
END_TEST

START_TEST(C7_a_fault_can_be_waited_for)
{
    program(1, '3', "E");
    expect_at("{\"motor\": 3, \"fault\": \"no_loop\", \"state\": \"fault\", \"led\": \"off\"}", 1 * MS + 1);
    wait_for("{\"motor\": 3, \"idle\": true}");
    ck_assert(!condition_run(condition, SECOND)); /* a motor in fault is not idle */
}
END_TEST

START_TEST(another_state_can_be_waited_for)
{
    program(1, '1', "S100 V1000 A2000 F5000 R");
    expect_at("{\"motor\": 1, \"state\": {\"!=\": \"idle\"}}", 0); /* it is ready */
    wait_for("{\"motor\": 1, \"state\": {\"==\": \"moving\"}, \"fault\": {\"==\": null}}");
    ck_assert(condition_run(condition, 100 * SECOND));
    wait_for("{\"motor\": 1, \"state\": {\"!=\": \"moving\"}}");
    ck_assert(condition_run(condition, 100 * SECOND));
    ck_assert_int_eq(sim_axis(sim, 1, 1).position, 5000);
    wait_for("{\"motor\": 1, \"led\": {\"!=\": \"blink\"}}");
    ck_assert(condition_run(condition, 100 * SECOND));
    expect_refused("{\"motor\": 1, \"state\": {\">\": \"idle\"}}", "expected == or != before a name, found \">\"");
    expect_refused("{\"motor\": 1, \"state\": {\"!=\": \"asleep\"}}", "expected one of idle, ready, moving");
    expect_refused("{\"motor\": 1, \"state\": {}}", "expected one of idle, ready, moving");
}
END_TEST

START_TEST(time_comes_of_itself)
{
    expect_at("{\"t\": \"2.5s\"}", 2500 * MS);
    expect_at("{\"t\": 2500001}", 2500001);
    expect_at("{\"t\": {\">\": 3000000}}", 3000001);
    expect_at("{\"t\": 5}", 3000001); /* it is over */
}
END_TEST

START_TEST(all_and_any_of_several)
{
    program(1, '0', "F10 R");
    program(1, '2', "T01");
    uint64_t end = 2 * MS + move_ticks(100, 1000, 2000, 10);
    expect_at("{\"any\": [{\"motor\": 1, \"position\": 1000}, {\"motor\": 2, \"position\": {\">=\": 10}}]}", end + 1);
    expect_at("{\"all\": [{\"any\": [{\"do\": {\"01\": 1}}]}, {\"motor\": 1, \"position\": {\">\": 5, \"<\": 11}}]}",
              slot_behind(end) + 1);
}
END_TEST

START_TEST(what_never_comes_ends_at_the_limit)
{
    wait_for("{\"motor\": 1, \"position\": 1}");
    ck_assert_uint_eq(condition_next(condition), RKM04_NEVER);
    ck_assert(!condition_run(condition, 7 * SECOND));
    ck_assert_uint_eq(sim_now(sim), 7 * SECOND);
    ck_assert(!condition_run(condition, RKM04_NEVER)); /* nothing will ever happen: it does not wait without end */
    ck_assert_uint_eq(sim_now(sim), 7 * SECOND);
}
END_TEST

START_TEST(a_step_never_leaps_past_what_was_waited_for)
{
    program(1, '1', "S100 F50 R");
    wait_for("{\"motor\": 1, \"position\": 20}");
    while (!condition_step(condition, SECOND))
        ck_assert_int_lt(position(), 20);
    ck_assert_int_eq(position(), 20);
}
END_TEST

START_TEST(power_is_checked)
{
    wait_for("{\"unit\": 5, \"powered\": false}");
    ck_assert(!condition_holds(condition));
    sim_power(sim, 2, false);
    ck_assert(condition_holds(condition));
}
END_TEST

START_TEST(a_message_can_be_waited_for_when_its_last_byte_has_passed)
{
    static const uint8_t request[] = {0x7E, 3, 0, 4, '1', 0x79, 0x9E, 0x7E}, wrong[] = {0x7E, 3, 0, 4, '1', 0, 0, 0x7E};
    sim_queue_bytes(sim, request, sizeof request, 0);
    expect_at("{\"message\": {\"number\": 4, \"motor\": 1, \"from\": \"master\"}}", (8 * 3125 + 5) / 6);
    wait_for("{\"message\": {\"number\": 5, \"from\": \"unit\"}}");
    ck_assert(!condition_run(condition, SECOND));
    sim_queue_bytes(sim, request, sizeof request, SECOND);
    expect_at("{\"message\": {\"from\": \"3\"}}", SECOND + (8 * 3125 + 521 * 6 + 19 * 3125 + 5) / 6);
    wait_for("{\"message\": {\"from\": \"3\"}}");
    ck_assert(!condition_run(condition, 2 * SECOND)); /* it is over */
    sim_queue_bytes(sim, wrong, sizeof wrong, 2 * SECOND);
    expect_at("{\"message\": {\"dropped\": true}}", 2 * SECOND + (8 * 3125 + 5) / 6);
}
END_TEST

/* ---- What it says --------------------------------------------------------------------------------------------------- */

START_TEST(the_text_names_what_is_wanted_and_what_there_is)
{
    program(1, '1', "\\C100 =1200");
    sim_advance(sim, 10 * MS);
    expect_text("{\"motor\": 1, \"position\": {\">=\": 5000}}", "motor 1 position >= 5000 (is 1200)");
    expect_text("{\"do\": {\"3\": 1}}", "DO 03 == 1 (is 0)");
    expect_text("{\"motor\": 2, \"state\": \"moving\", \"led\": \"on\"}",
                "motor 2 state == moving (is idle) and motor 2 led == on (is off)");
    expect_text("{\"any\": [{\"t\": \"2.5s\"}, {\"idle\": false}]}", 
                "t >= 2.500000 s (is 0.010000 s) or idle == false (is true)");
    expect_text("{\"message\": {\"number\": 2, \"from\": \"master\", \"motor\": 1}}",
                "a message 2 for motor 1 from the host (none has passed)");
}
END_TEST

START_TEST(what_is_wanted_and_what_is_found_can_be_told_apart)
{
    wait_for("{\"motor\": 1, \"position\": {\">=\": 1, \"<\": 9}, \"any\": [{\"do\": {\"01\": 1}}, {\"di\": {\"01\": 1}}]}");
    char *wanted = condition_wanted_text(condition), *found = condition_found_text(condition);
    ck_assert_str_eq(wanted, "motor 1 position >= 1 and motor 1 position < 9 and (DO 01 == 1 or DI 01 == 1)");
    ck_assert_str_eq(found, "motor 1 position 0, DO 01 0, DI 01 0");
    free(wanted);
    free(found);
}
END_TEST

START_TEST(with_several_units_the_text_names_them)
{
    expect_text("{\"unit\": \"5\", \"motor\": 1, \"fault\": null}", "unit 5 motor 1 fault == none (is none)");
}
END_TEST

/* ---- What is refused ------------------------------------------------------------------------------------------------ */

START_TEST(wrong_conditions_are_refused_with_what_was_expected)
{
    expect_refused("5", "expected an object");
    expect_refused("{}", "nothing to wait for");
    expect_refused("{\"motor\": 1}", "nothing to wait for");
    expect_refused("{\"position\": 1}", "motor");
    expect_refused("{\"motor\": 5, \"position\": 1}", "1 to 4");
    expect_refused("{\"motor\": 1, \"position\": \"far\"}", "a whole number");
    expect_refused("{\"motor\": 1, \"position\": {\"=>\": 1}}", "found \"=>\"");
    expect_refused("{\"motor\": 1, \"position\": {}}", "found {}");
    expect_refused("{\"motor\": 1, \"state\": \"asleep\"}", "expected one of idle, ready, moving");
    expect_refused("{\"motor\": 1, \"led\": 1}", "expected one of off, on, blink");
    expect_refused("{\"motor\": 1, \"fault\": \"none\", \"speed\": 1}", "unknown condition \"speed\"");
    expect_refused("{\"do\": {\"09\": 1}}", "01 to 08");
    expect_refused("{\"var\": {\"8\": 1}}", "80 to 95");
    expect_refused("{\"di\": {\"01\": 2}}", "0 or 1");
    expect_refused("{\"di\": {}}", "expected numbers with levels");
    expect_refused("{\"t\": \"2.5\"}", "a time");
    expect_refused("{\"all\": []}", "a list of conditions");
    expect_refused("{\"any\": [{\"t\": 1}, 7]}", "expected an object");
    expect_refused("{\"message\": {\"from\": \"nobody\"}}", "from");
    expect_refused("{\"message\": {\"number\": 256}}", "0 to 255");
    expect_refused("{\"message\": {\"length\": 2}}", "length");
    expect_refused("{\"unit\": 2, \"idle\": true}", "no such unit");
}
END_TEST

START_TEST(a_condition_within_conditions_has_an_end)
{
    char text[4000] = "";
    for (int depth = 0; depth < 100; depth++)
        strcat(text, "{\"all\": [");
    strcat(text, "{\"t\": 1}");
    for (int depth = 0; depth < 100; depth++)
        strcat(text, "]}");
    expect_refused(text, "nested deeper than");
}
END_TEST

START_TEST(a_condition_asks_for_256_things_at_most)
{
    char text[8000] = "{\"any\": [", *end = text + strlen(text);
    for (unsigned i = 0; i < 127; i++)
        end += sprintf(end, "{\"t\": %u},", i);
    strcpy(end, "{\"t\": 1}]}"); /* 128 lists with one each would be 256, and the outer one is one more */
    expect_refused(text, "at most 256 conditions in all");
    strcpy(end - 1, "]}");
    json_t *json = json_loads(text, 0, NULL);
    struct condition *read = condition_read(sim, json, &refusal);
    ck_assert_msg(read != NULL, "%s", refusal.text);
    condition_free(read);
    json_decref(json);
}
END_TEST

START_TEST(with_several_units_one_has_to_be_named)
{
    expect_refused("{\"idle\": true}", "expected one of 3, 5");
}
END_TEST

static Suite *condition_suite(void)
{
    Suite *suite = suite_create("condition");

    TCase *holds = tcase_create("holds");
    tcase_add_checked_fixture(holds, setup, teardown);
    tcase_add_test(holds, a_position_is_there_one_tick_after_its_pulse);
    tcase_add_test(holds, a_motor_is_idle_when_its_last_command_has_been_executed);
    tcase_add_test(holds, all_motors_are_idle_when_the_last_one_is);
    tcase_add_test(holds, outputs_variables_and_inputs_are_seen_to_the_tick);
    tcase_add_test(holds, C7_a_fault_can_be_waited_for);
    tcase_add_test(holds, another_state_can_be_waited_for);
    tcase_add_test(holds, time_comes_of_itself);
    tcase_add_test(holds, all_and_any_of_several);
    tcase_add_test(holds, what_never_comes_ends_at_the_limit);
    tcase_add_test(holds, a_step_never_leaps_past_what_was_waited_for);
    suite_add_tcase(suite, holds);

    TCase *says = tcase_create("says");
    tcase_add_checked_fixture(says, setup, teardown);
    tcase_add_test(says, the_text_names_what_is_wanted_and_what_there_is);
    tcase_add_test(says, what_is_wanted_and_what_is_found_can_be_told_apart);
    tcase_add_test(says, wrong_conditions_are_refused_with_what_was_expected);
    tcase_add_test(says, a_condition_within_conditions_has_an_end);
    tcase_add_test(says, a_condition_asks_for_256_things_at_most);
    suite_add_tcase(suite, says);

    TCase *units = tcase_create("units");
    tcase_add_checked_fixture(units, setup_two, teardown);
    tcase_add_test(units, power_is_checked);
    tcase_add_test(units, a_message_can_be_waited_for_when_its_last_byte_has_passed);
    tcase_add_test(units, with_several_units_the_text_names_them);
    tcase_add_test(units, with_several_units_one_has_to_be_named);
    suite_add_tcase(suite, units);
    return suite;
}

int main(void)
{
    return rig_run(condition_suite(), "./test_condition");
}
