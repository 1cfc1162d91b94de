/* SPDX-License-Identifier: MIT */
/* test_control_unit.c: what the control socket does to a unit and shows of it, on a line without a socket: state, di.set, reset,
 * power, switch. One test case alone: CK_RUN_CASE=state ./test_control_unit */
#include <check.h>
#include <stdlib.h>
#include <string.h>

#include "device/rkm04_device.h"
#include "plant/plant_rig.h"
#include "record/record.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define SECOND UINT64_C(1000000)

static struct plant_rig rig;
static json_t *state;

static void setup(void)
{
    ck_assert(plant_rig_begin(&rig, "1", NULL));
    ck_assert(snapshots_attach(&rig.sim));
    state = NULL;
}

static void teardown(void)
{
    json_decref(state);
    plant_rig_end(&rig);
}

static void program(const char *text)
{
    plant_rig_program(&rig, 1, '1', text);
}

static void run(uint64_t ticks)
{
    plant_rig_run(&rig, ticks);
}

/* A member of the unit's state, as text. */
static const char *unit(const char *member)
{
    static char text[2000];
    struct refusal refusal;
    json_decref(state);
    state = sim_command(&rig.sim, "state", NULL, &refusal);
    ck_assert_ptr_nonnull(state);
    const json_t *value = json_object_get(state, member);
    ck_assert_msg(value != NULL, "there is no %s", member);
    char *dump = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_SORT_KEYS);
    snprintf(text, sizeof text, "%s", dump);
    free(dump);
    return text;
}

/* The same of motor 1. */
static const char *motor(const char *member)
{
    static char text[2000];
    unit("motors");
    const json_t *value = json_object_get(json_array_get(json_object_get(state, "motors"), 0), member);
    ck_assert_msg(value != NULL, "there is no %s", member);
    char *dump = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_SORT_KEYS);
    snprintf(text, sizeof text, "%s", dump);
    free(dump);
    return text;
}

static const char *command(const char *method, const char *params)
{
    return plant_rig_command(&rig, method, params);
}

/* ---- What a motor waits for ----------------------------------------------------------------------------------------- */

static const struct {
    const char *program;
    uint64_t ticks;
    const char *lone; /* a message of its own after that; NULL: none */
    uint64_t after;   /* ticks after it */
    const char *state, *waits_for;
} waits[] = {
    {"", 5000, NULL, 0, "\"idle\"", "null"},
    {"O05 R", 5000, NULL, 0, "\"wait\"", "\"DI 05 to be 1\""},
    {"T81 Z81", 5000, NULL, 0, "\"wait\"", "\"VAR 81 to be 0\""},
    {"W500", 100500, NULL, 0, "\"dwell\"", "\"the end of W500: 401 ms left\""},
    {"W500", 100500, "K", 2000, "\"held\"", "\"C75 to resume the dwell (400 ms left), or new commands\""},
    {"O01", 2500, "K", 2000, "\"held\"", "\"C75 to resume, or new commands\""},
    {"S100 F1000 R", 1000000, NULL, 0, "\"moving\"", "\"the end of R: 792 of 1000 steps done\""},
    {"S100 F1000 R", 1000000, "K", 2000, "\"moving\"", "\"the end of the stop ramp, to hold\""},
    {"S100 V100 F9 R", 30000, "K", 50000, "\"held\"", "\"C75 to resume the motion (3 steps done), or new commands\""},
    {"G+", 5000, NULL, 0, "\"moving\"", "\"K, or a guard M, N, X: the motion is endless\""},
    {"(03", 5000, NULL, 0, "\"moving\"", "\"DI 03 to be 1\""},
    {"[ R", 5000, NULL, 0, "\"block\"", "\"the ] of its block\""},
    {"J9", 5000, NULL, 0, "\"wait\"", "\"label 9 to arrive\""},
    {"I01L17", 5000, NULL, 0, "\"wait\"", "\"label 17 to arrive\""},
    {"E", 5000, NULL, 0, "\"fault\"", "\"\\\\: fault no_loop\""},
};

START_TEST(the_state_says_what_a_motor_waits_for)
{
    program(waits[_i].program);
    run(waits[_i].ticks);
    if (waits[_i].lone) {
        program(waits[_i].lone);
        run(waits[_i].after);
    }
    ck_assert_str_eq(motor("waits_for"), waits[_i].waits_for);
    ck_assert_str_eq(motor("state"), waits[_i].state);
}
END_TEST

START_TEST(C6_a_program_that_x_has_ended_waits_for_commands)
{
    program("X02 O01");
    run(5000);
    command("di.set", "{\"di\":{\"2\":1}}");
    run(2000);
    ck_assert_str_eq(motor("state"), "\"ended\"");
    ck_assert_str_eq(motor("waits_for"), "\"new commands: ended by X\"");
    ck_assert_str_eq(motor("command"), "null");
}
END_TEST

/* ---- What else there is --------------------------------------------------------------------------------------------- */

START_TEST(C5_the_state_shows_armed_guards)
{
    program("M03 N5 X08 O01");
    run(5000);
    ck_assert_str_eq(motor("guards"), "{\"m\":3,\"n\":5,\"x\":8}");
    program("U");
    command("di.set", "{\"mask\":1}");
    run(3000);
    ck_assert_str_eq(motor("guards"), "{\"m\":null,\"n\":null,\"x\":8}");
}
END_TEST

START_TEST(C7_the_state_shows_loops_and_calls)
{
    program("L3 L5 '7 @7 O01");
    run(6000);
    ck_assert_str_eq(motor("loops"), "[{\"left\":3,\"start\":1},{\"left\":5,\"start\":2}]");
    ck_assert_str_eq(motor("calls"), "[4]");
    ck_assert_str_eq(motor("index"), "5");
    ck_assert_str_eq(motor("command"), "\"O01\"");
    ck_assert_str_eq(motor("memory"), "{\"commands\":5,\"of\":700}");
}
END_TEST

START_TEST(C11_the_state_shows_functions_and_simulation_mode)
{
    program("T40 T51 T58 T41");
    run(6000);
    ck_assert_str_eq(motor("functions"), "[40,51,58]");
    ck_assert_str_eq(unit("simulation"), "true");
}
END_TEST

START_TEST(P7_the_state_shows_the_profile_of_the_manuals_figure)
{
    program("S100 V500 A2000 F2000 Y V2000 F2000 Y V500 F5000 Y V3000 F3000 Y V1500 F2000 Y V1500 F2000 Y V500 F2000 Y R");
    run(SECOND);
    const char *text = motor("profile");
    ck_assert_msg(strncmp(text, "[[1,100],[61,500],[2001,500],", 29) == 0, "%s", text);
    ck_assert_str_eq(motor("speed"), "500");
}
END_TEST

START_TEST(P7_a_request_that_waits_is_not_obeyed_by_reading_the_state)
{
    static const uint8_t get_and_reset[] = {1, 0, 2, 5, '1', 1, 0, 3, 2, '1', '\\'};
    struct sim_config config = {.unit = rkm04_device_config(&(struct rkm04_config){.framing = &rkm04_plain})};
    plant_rig_end(&rig);
    memset(&rig, 0, sizeof rig);
    ck_assert(node_list_read(&config.nodes, "1"));
    ck_assert(sim_begin(&rig.sim, &config));
    struct rkm04_unit *core = rkm04_of(sim_core(&rig.sim, 1));
    program("S100 F1000 R");
    run(SECOND);
    rkm04_receive(core, get_and_reset, sizeof get_and_reset); /* the second one waits for the end of the answer */
    ck_assert(core->waiting);
    ck_assert_str_eq(motor("profile"), "[[1,100],[248,1000],[753,1000],[1000,0]]");
    ck_assert(core->waiting);
    ck_assert_str_eq(motor("state"), "\"moving\"");
}
END_TEST

START_TEST(the_state_shows_counter_and_true_position_side_by_side)
{
    ck_assert_str_eq(motor("true_position"), "null");
    plant_rig_configure(&rig, "motors: {1: {offset: 20}}");
    program("S100 F10 R");
    run(SECOND);
    ck_assert_str_eq(motor("position"), "10");
    ck_assert_str_eq(motor("true_position"), "30");
}
END_TEST

START_TEST(U5_the_state_shows_what_is_in_flash)
{
    uint8_t answer[4];
    program("T03");
    ck_assert_str_eq(motor("slot"), "\"empty\"");
    ck_assert_uint_eq(rkm04_exchange(rkm04_of(sim_core(&rig.sim, 1)), (const uint8_t *)"\3\61", 2, answer, sizeof answer), 3);
    ck_assert_str_eq(motor("slot"), "\"stored\"");
    command("reset", NULL);
    run(2000);
    ck_assert_str_eq(motor("slot"), "\"loaded\"");
    ck_assert_str_eq(unit("do"), "4");
}
END_TEST

/* ---- The program ---------------------------------------------------------------------------------------------------- */

START_TEST(C2_the_program_of_a_motor_is_told_with_the_place_of_its_first_command)
{
    ck_assert_str_eq(command("motor.program", "{\"motor\":2}"),
                     "{\"commands\":[],\"first\":1,\"motor\":2,\"of\":700,\"t_us\":0}");
    program("S100 V1000F5 R L17");
    ck_assert_str_eq(command("motor.program", "{\"motor\":1}"),
                     "{\"commands\":[\"S100\",\"V1000\",\"F5\",\"R\",\"L17\"],\"first\":1,\"motor\":1,\"of\":700,\"t_us\":0}");
    ck_assert_str_eq(command("motor.program", "{\"motor\":0}"), "-32602 motor: expected a whole number from 1 to 4");
    ck_assert_str_eq(command("motor.program", "{}"), "-32602 motor: expected a whole number from 1 to 4");
    ck_assert_str_eq(command("motor.program", "{\"motor\":1,\"place\":1}"),
                     "-32602 unknown parameter `place': expected motor, unit");
}
END_TEST

/* The place of what is executed is found in the list, however often the ring has been filled. */
START_TEST(C10_the_first_command_of_a_full_memory_is_the_oldest_one)
{
    for (unsigned i = 0; i < 800; i++) {
        rkm04_set_command(rkm04_of(sim_core(&rig.sim, 1)), '1', i < 799 ? "T01" : "O05", 3, NULL); /* from 701 on: flag 3 */
        run(2000);
    }
    ck_assert_str_eq(motor("command"), "\"O05\"");
    struct refusal refusal;
    json_t *params = json_pack("{s:i}", "motor", 1), *told = sim_command(&rig.sim, "motor.program", params, &refusal);
    const json_t *commands = json_object_get(told, "commands");
    long long first = json_integer_value(json_object_get(told, "first")), index = atoll(motor("index"));
    ck_assert_uint_eq(json_array_size(commands), 700);
    ck_assert_int_eq(first, 101);
    ck_assert_str_eq(json_string_value(json_array_get(commands, (size_t)((index - first + 700) % 700))), "O05");
    json_decref(params);
    json_decref(told);
}
END_TEST

/* ---- Inputs --------------------------------------------------------------------------------------------------------- */

static const struct {
    const char *params, *answer;
} inputs_given[] = {
    {"{\"di\":{\"1\":1,\"08\":true}}", "{\"di\":129,\"overridden\":[],\"t_us\":0}"},
    {"{\"mask\":255}", "{\"di\":255,\"overridden\":[],\"t_us\":0}"},
    {"{\"mask\":256}", "-32602 mask: expected a whole number from 0 to 255"},
    {"{\"di\":{\"0\":1}}", "-32602 di: unknown input `0': expected 1 to 8"},
    {"{\"di\":{\"008\":1}}", "-32602 di: unknown input `008': expected 1 to 8"},
    {"{\"di\":{\"3\":2}}", "-32602 di: input 3: expected 0 or 1"},
    {"{\"di\":{\"3\":\"1\"}}", "-32602 di: input 3: expected 0 or 1"},
    {"{\"di\":{\"3\":1,\"03\":0}}", "-32602 di: input 3 is named twice"},
    {"{\"di\":{}}", "-32602 expected either di, an object as in {\"3\": 1, \"08\": 0}, or mask, a number"},
    {"{\"di\":{\"3\":1},\"mask\":1}", "-32602 expected either di, an object as in {\"3\": 1, \"08\": 0}, or mask, a number"},
    {"{}", "-32602 expected either di, an object as in {\"3\": 1, \"08\": 0}, or mask, a number"},
    {"{\"di\":{\"3\":1},\"unit\":2}", "-32602 unit: there is no such unit: expected one of 1"},
    {"{\"dI\":{\"3\":1}}", "-32602 unknown parameter `dI': expected di, mask, unit; did you mean `di'?"},
};

START_TEST(U2_inputs_are_set_one_or_several)
{
    ck_assert_str_eq(command("di.set", inputs_given[_i].params), inputs_given[_i].answer);
    ck_assert_uint_eq(inputs(&rig), strncmp(inputs_given[_i].answer, "-32602", 6) == 0 ? 0 : _i == 0 ? 129 : 255);
}
END_TEST

START_TEST(inputs_not_named_stay)
{
    command("di.set", "{\"mask\":15}");
    ck_assert_str_eq(command("di.set", "{\"di\":{\"2\":0,\"5\":1}}"), "{\"di\":29,\"overridden\":[],\"t_us\":0}");
}
END_TEST

START_TEST(an_input_that_the_plant_drives_is_told_of)
{
    plant_rig_configure(&rig, "{motors: {1: }, switches: [{input: 02, motor: 1, at_most: -1}]}");
    ck_assert_str_eq(command("di.set", "{\"di\":{\"2\":1,\"3\":1}}"), "{\"di\":4,\"overridden\":[2],\"t_us\":0}");
    plant_rig_configure(&rig, NULL);
    ck_assert_uint_eq(inputs(&rig), 6); /* as it was set by hand */
}
END_TEST

/* ---- Power ---------------------------------------------------------------------------------------------------------- */

START_TEST(U8_a_reset_clears_and_a_unit_without_power_cannot_be_reset)
{
    program("T03 S100 F5 R");
    run(SECOND);
    ck_assert_str_eq(command("reset", "{}"), "{\"t_us\":1000000}");
    ck_assert_str_eq(motor("position"), "0");
    ck_assert_str_eq(unit("do"), "0");
    ck_assert_str_eq(unit("since_us"), "1000000");
    command("power", "{\"on\":false}");
    ck_assert_str_eq(command("reset", "{}"), "-32000 unit 1 has no power: switch it on with power");
}
END_TEST

START_TEST(power_that_is_on_already_changes_nothing)
{
    program("S100 F5 R");
    run(SECOND);
    ck_assert_str_eq(command("power", "{\"on\":true}"), "{\"powered\":true,\"t_us\":1000000}");
    ck_assert_str_eq(motor("position"), "5");
    ck_assert_str_eq(command("power", "{\"on\":false}"), "{\"powered\":false,\"t_us\":1000000}");
    ck_assert_str_eq(command("power", "{\"on\":false}"), "{\"powered\":false,\"t_us\":1000000}");
    ck_assert_str_eq(unit("powered"), "false");
    ck_assert_str_eq(command("power", "{\"on\":true}"), "{\"powered\":true,\"t_us\":1000000}");
    ck_assert_str_eq(motor("position"), "0");
    ck_assert_str_eq(command("power", "{\"on\":1}"), "-32602 on: expected true or false");
    ck_assert_str_eq(command("power", "{}"), "-32602 on: expected true or false");
}
END_TEST

START_TEST(U4_the_address_switch_is_read_at_power_up)
{
    ck_assert_str_eq(command("switch", "{\"node\":9}"), "{\"node\":1,\"switch\":9,\"t_us\":0}");
    ck_assert_str_eq(unit("node"), "1");
    ck_assert_str_eq(command("reset", "{}"), "{\"t_us\":0}");
    ck_assert_str_eq(unit("node"), "9");
    ck_assert_str_eq(unit("unit"), "\"1\""); /* its name */
    ck_assert_str_eq(command("switch", "{\"node\":16,\"reset\":true}"), "{\"node\":16,\"switch\":16,\"t_us\":0}");
    ck_assert_str_eq(command("switch", "{\"node\":17}"), "-32602 node: expected a whole number from 1 to 16");
    ck_assert_str_eq(command("switch", "{\"node\":0}"), "-32602 node: expected a whole number from 1 to 16");
    ck_assert_str_eq(command("switch", "{\"node\":1,\"reset\":1}"), "-32602 reset: expected true or false");
}
END_TEST

START_TEST(U4_with_the_power_off_the_switch_waits_for_it)
{
    command("power", "{\"on\":false}");
    ck_assert_str_eq(command("switch", "{\"node\":4,\"reset\":true}"), "{\"node\":1,\"switch\":4,\"t_us\":0}");
    ck_assert_str_eq(unit("powered"), "false");
    command("power", "{\"on\":true}");
    ck_assert_str_eq(unit("node"), "4");
}
END_TEST

START_TEST(U4_a_snapshot_remembers_the_switch)
{
    command("snapshot", "{\"name\":\"before\"}");
    command("switch", "{\"node\":4,\"reset\":true}");
    command("restore", "{\"name\":\"before\"}");
    ck_assert_str_eq(unit("node"), "1");
    ck_assert_str_eq(unit("switch"), "1");
    command("reset", NULL);
    ck_assert_str_eq(unit("node"), "1");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("control_unit");
    TCase *seen = tcase_create("state"), *hands = tcase_create("hands");
    tcase_add_checked_fixture(seen, setup, teardown);
    tcase_add_loop_test(seen, the_state_says_what_a_motor_waits_for, 0, (int)COUNT(waits));
    tcase_add_test(seen, C6_a_program_that_x_has_ended_waits_for_commands);
    tcase_add_test(seen, C5_the_state_shows_armed_guards);
    tcase_add_test(seen, C7_the_state_shows_loops_and_calls);
    tcase_add_test(seen, C11_the_state_shows_functions_and_simulation_mode);
    tcase_add_test(seen, P7_the_state_shows_the_profile_of_the_manuals_figure);
    tcase_add_test(seen, P7_a_request_that_waits_is_not_obeyed_by_reading_the_state);
    tcase_add_test(seen, the_state_shows_counter_and_true_position_side_by_side);
    tcase_add_test(seen, U5_the_state_shows_what_is_in_flash);
    tcase_add_test(seen, C2_the_program_of_a_motor_is_told_with_the_place_of_its_first_command);
    tcase_add_test(seen, C10_the_first_command_of_a_full_memory_is_the_oldest_one);
    tcase_add_checked_fixture(hands, setup, teardown);
    tcase_add_loop_test(hands, U2_inputs_are_set_one_or_several, 0, (int)COUNT(inputs_given));
    tcase_add_test(hands, inputs_not_named_stay);
    tcase_add_test(hands, an_input_that_the_plant_drives_is_told_of);
    tcase_add_test(hands, U8_a_reset_clears_and_a_unit_without_power_cannot_be_reset);
    tcase_add_test(hands, power_that_is_on_already_changes_nothing);
    tcase_add_test(hands, U4_the_address_switch_is_read_at_power_up);
    tcase_add_test(hands, U4_with_the_power_off_the_switch_waits_for_it);
    tcase_add_test(hands, U4_a_snapshot_remembers_the_switch);
    suite_add_tcase(suite, seen);
    suite_add_tcase(suite, hands);
    SRunner *runner = srunner_create(suite);
    srunner_run_all(runner, CK_ENV);
    int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed != 0;
}
