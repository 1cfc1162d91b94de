/* SPDX-License-Identifier: MIT */
/* test_cib_device.c: the CIB module as a device: what traces see, injected faults, snapshots, power, conditions, methods. */
#include <check.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cib_bus.h"
#include "condition/condition.h"
#include "core/rig.h"
#include "device/cib_device.h"

#define READ_TYPE "01 04 00 30 00 01 31 C5"
#define TYPE "01 04 02 08 08 BF 36"

static struct cib_bus bus;
static char seen[65536];

static void see(void *context, const struct watch_event *event)
{
    size_t length = strlen(seen);
    (void)context;
    if (event->kind == WATCH_VALUE)
        snprintf(seen + length, sizeof seen - length, "%" PRIu64 " pwm%u %" PRId32 "\n", event->tick, event->number,
                 event->value);
    else if (event->kind != WATCH_BYTE && event->kind != WATCH_MESSAGE)
        snprintf(seen + length, sizeof seen - length, "%" PRIu64 " %s %u %" PRId32 "\n", event->tick,
                 watch_kind_name((enum watch_kind)event->kind), event->motor, event->value);
}

static struct watcher watcher = {.kinds = WATCH_ALL, .on_event = see};

static void begin(void)
{
    cib_bus_begin(&bus, "1", false, NULL);
    seen[0] = '\0';
}

static void end(void)
{
    cib_bus_end(&bus);
}

static json_int_t state_number(const char *name)
{
    json_t *state = cib_bus_command(&bus, "state", "{}");
    json_int_t value = json_integer_value(json_object_get(state, name));
    json_decref(state);
    return value;
}

/* ---- Traces -------------------------------------------------------------------------------------------------------------- */

/* Pulses as steps, the pattern of the phases as outputs, MCSTAT as variables: row 1, 2, 3 of mode 20 are 3, 6, C. */
START_TEST(a_trace_has_pulses_phases_and_status)
{
    sim_watch(&bus.sim, &watcher);
    cib_bus_to(&bus, 500);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"A\", \"command\": 102, \"p1\": 3, \"p2\": 100}");
    cib_bus_to(&bus, 40000);
    ck_assert_str_eq(seen, "500 command 1 102\n500 variables 0 2081\n"
                           "1000 motion 1 1\n"
                           "11000 step 1 1\n11000 outputs 0 3\n"
                           "21000 step 1 2\n21000 outputs 0 6\n"
                           "31000 step 1 3\n31000 outputs 0 12\n31000 motion 1 0\n31000 variables 0 2088\n");
    sim_unwatch(&bus.sim, &watcher);
}
END_TEST

static double state_position(void)
{
    return sim_axis(&bus.sim, 1, 1).position;
}

/* A plan of drive A from now on. */
static size_t plan_of_a(struct device_plan_point *point)
{
    return cib_device.plan(sim_core(&bus.sim, 1), 1, point, DEVICE_PLAN_POINTS);
}

/* 3000 pulses at 500/s: up to 500 from the start speed, on, down to it at the last pulse, which comes at 7 334 335. */
START_TEST(the_plan_of_a_motion_leads_to_its_last_pulse)
{
    struct device_plan_point point[DEVICE_PLAN_POINTS];
    ck_assert_uint_eq(plan_of_a(point), 0);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"A\", \"command\": 102, \"p1\": 3000, \"p2\": 500}");
    cib_bus_to(&bus, 2000);
    for (uint64_t tick = 500000; tick <= 7000000; tick += 500000) {
        cib_bus_to(&bus, tick);
        size_t count = plan_of_a(point);
        ck_assert_uint_ge(count, 3);
        ck_assert(point[0].us == (double)tick);
        ck_assert_double_eq_tol(point[0].position, state_position(), 1.0);
        ck_assert_double_eq_tol(point[count - 1].us, 7334335, 2.0);
        ck_assert_double_eq_tol(point[count - 1].position, 3000, 1e-6);
        ck_assert(point[count - 1].speed == 0);
    }
    ck_assert_double_le(point[0].speed, 500.001);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"A\", \"command\": 101, \"p1\": -100, \"p2\": 500}");
    cib_bus_to(&bus, 7001000);
    cib_bus_to(&bus, 7001500);
    size_t count = plan_of_a(point);
    uint64_t turn = (uint64_t)point[count - 1].us;
    ck_assert_double_gt(point[0].speed, 0);
    cib_bus_to(&bus, turn + 500000);
    ck_assert_uint_ge(count = plan_of_a(point), 2);
    ck_assert_double_lt(point[0].speed, 0);
    ck_assert_double_eq_tol(point[count - 1].position, -100, 1e-6);
    cib_bus_to(&bus, 60000000);
    ck_assert_uint_eq(plan_of_a(point), 0);
    ck_assert(state_position() == -100);
}
END_TEST

/* Duties when they are written, by a host or by APPLY, which has all of them 0 again. */
START_TEST(a_trace_has_the_duties_of_pwm)
{
    cib_bus_do(&bus, "cib.config.put", "{\"setup\": {\"do1-2\": {\"use\": \"pwm\"}, \"do3-4\": {\"use\": \"do\"}}}");
    cib_bus_do(&bus, "cib.apply", "{}");
    watcher.kinds = WATCH_BIT(WATCH_VALUE);
    sim_watch(&bus.sim, &watcher);
    cib_bus_to(&bus, 900);
    cib_bus_do(&bus, "cib.pwm", "{\"output\": 1, \"duty\": 2500}");
    cib_bus_do(&bus, "cib.pwm", "{\"output\": 2, \"duty\": 10000}");
    cib_bus_do(&bus, "cib.pwm", "{\"output\": 2, \"duty\": 10000}");
    cib_bus_do(&bus, "snapshot", "{\"name\": \"a\"}");
    cib_bus_to(&bus, 2600);
    cib_bus_do(&bus, "cib.apply", "{}");
    cib_bus_to(&bus, 2700);
    cib_bus_do(&bus, "restore", "{\"name\": \"a\"}");
    cib_bus_to(&bus, 2800);
    ck_assert_str_eq(seen, "900 pwm1 2500\n900 pwm2 10000\n2600 pwm1 0\n2600 pwm2 0\n2700 pwm1 2500\n2700 pwm2 10000\n");
    sim_unwatch(&bus.sim, &watcher);
    watcher.kinds = WATCH_ALL;
}
END_TEST

/* PWM1 with a period of 1000 and a duty of 25 %: levels of the output, edge by edge, while a watcher wants pulses. */
START_TEST(a_trace_has_the_edges_of_pwm)
{
    cib_bus_do(&bus, "cib.config.put", "{\"setup\": {\"do1-2\": {\"use\": \"pwm\"}, \"do3-4\": {\"use\": \"do\"}}}");
    cib_bus_do(&bus, "cib.apply", "{}");
    cib_bus_do(&bus, "cib.pwm", "{\"output\": 1, \"duty\": 2500}");
    cib_bus_to(&bus, 900);
    sim_watch(&bus.sim, &watcher);
    cib_bus_to(&bus, 2600);
    ck_assert_str_eq(seen, "1000 outputs 0 1\n1250 outputs 0 0\n2000 outputs 0 1\n2250 outputs 0 0\n");
    sim_unwatch(&bus.sim, &watcher);
}
END_TEST

START_TEST(a_refused_command_is_a_fault_until_the_next_good_one)
{
    struct refusal refusal;
    sim_watch(&bus.sim, &watcher);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"B\", \"command\": 105, \"p1\": 1001}");
    cib_bus_to(&bus, 10);
    ck_assert_msg(strstr(seen, "0 fault 2 4\n") != NULL, "%s", seen);
    json_t *text = json_pack("{s:i, s:s}", "motor", 2, "fault", "maximum");
    struct condition *condition = condition_read(&bus.sim, text, &refusal);
    ck_assert_ptr_nonnull(condition);
    ck_assert(condition_holds(condition));
    condition_free(condition);
    json_decref(text);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"B\", \"command\": 0}");
    cib_bus_to(&bus, 20);
    ck_assert_msg(strstr(seen, "0 fault 2 0\n") != NULL, "%s", seen);
    sim_unwatch(&bus.sim, &watcher);
}
END_TEST

/* ---- Plants (BT4) -------------------------------------------------------------------------------------------------------- */

static json_int_t true_position(void)
{
    json_t *state = cib_bus_command(&bus, "state", "{}");
    json_int_t value =
        json_integer_value(json_object_get(json_array_get(json_object_get(state, "motors"), 0), "true_position"));
    json_decref(state);
    return value;
}

/* Drive A moves 80 pulses forward; returns where the motor is then. */
static json_int_t move_80(unsigned mode, const char *coils)
{
    char params[256];
    snprintf(params, sizeof params, "{\"setup\": {\"drive_a\": {\"mode\": %u}}}", mode);
    cib_bus_do(&bus, "cib.config.put", params);
    cib_bus_do(&bus, "cib.apply", "{}");
    snprintf(params, sizeof params, "{\"plant\": {\"motors\": {\"1\": {\"coils\": %s}}}}", coils);
    cib_bus_do(&bus, "plant.set", params);
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"A\", \"command\": 102, \"p1\": 80, \"p2\": 100}");
    cib_bus_to(&bus, sim_now(&bus.sim) + 2000000);
    return true_position();
}

START_TEST(bt4_a_motor_follows_the_field_of_its_coils_in_every_mode)
{
    static const unsigned modes[] = {16, 17, 20, 21, 32, 33};
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++)
        ck_assert_msg(move_80(modes[i], "[1, 2, 3, 4]") == 80, "mode %u: %d", modes[i], (int)true_position());
}
END_TEST

START_TEST(bt4_swapped_leads_turn_it_back_and_a_missing_one_keeps_it)
{
    json_int_t back = move_80(32, "[3, 2, 1, 4]");
    ck_assert_msg(back >= -81 && back <= -76, "swapped: %d", (int)back);
    json_int_t missing = move_80(32, "[1, 2, 0, 0]");
    ck_assert_msg(missing >= -8 && missing <= 8, "missing: %d", (int)missing);
}
END_TEST

/* ---- What goes wrong ---------------------------------------------------------------------------------------------------- */

START_TEST(a_check_value_can_be_made_wrong)
{
    cib_bus_do(&bus, "fault.inject", "{\"kind\": \"wrong_fcs\", \"count\": 1}");
    cib_bus_expect(&bus, READ_TYPE, "01 04 02 08 08 BE 36");
    cib_bus_expect(&bus, READ_TYPE, TYPE);
}
END_TEST

START_TEST(power_is_lost_with_what_the_host_applied)
{
    cib_bus_do(&bus, "cib.config.put", "{\"setup\": {\"do5-8\": {\"use\": \"do\"}}}");
    cib_bus_do(&bus, "cib.apply", "{}");
    cib_bus_do(&bus, "cib.do", "{\"outputs\": {\"5\": 1}}");
    ck_assert_int_eq(state_number("do"), 0x10);
    cib_bus_do(&bus, "power", "{\"on\": false}");
    cib_bus_expect(&bus, READ_TYPE, "");
    cib_bus_expect_refusal(&bus, "cib.status", "{}", "has no power");
    cib_bus_do(&bus, "power", "{\"on\": true}");
    cib_bus_to(&bus, 10000);
    cib_bus_expect(&bus, READ_TYPE, TYPE);
    ck_assert_int_eq(state_number("do"), 0);
    cib_bus_expect_checked(&bus, "01 04 01 03 00 01", "01 04 02 00 02");
}
END_TEST

START_TEST(a_snapshot_brings_everything_back)
{
    cib_bus_do(&bus, "cib.command", "{\"drive\": \"A\", \"command\": 102, \"p1\": 300, \"p2\": 500}");
    cib_bus_to(&bus, 200000);
    cib_bus_send(&bus, "01 04 00 30"); /* half a request */
    cib_bus_do(&bus, "snapshot", "{\"name\": \"here\"}");
    cib_bus_to(&bus, 201000);
    unsigned position = cib_bus_input(&bus, 0x14);
    cib_bus_to(&bus, 3000000);
    ck_assert_uint_eq(cib_bus_input(&bus, 0x14), 300);
    cib_bus_do(&bus, "restore", "{\"name\": \"here\"}");
    cib_bus_expect(&bus, "00 01 31 C5", TYPE);
    cib_bus_to(&bus, sim_now(&bus.sim) + 1000);
    ck_assert_uint_eq(cib_bus_input(&bus, 0x14), position);
}
END_TEST

/* ---- Methods ------------------------------------------------------------------------------------------------------------ */

START_TEST(wrong_parameters_of_methods_are_refused)
{
    static const char *const wrong[][3] = {
        {"cib.command", "{}", "drive: expected"},
        {"cib.command", "{\"drive\": \"A\"}", "command: expected a number from 0 to 65535"},
        {"cib.command", "{\"drive\": \"A\", \"command\": 101, \"p1\": 2147483648}", "p1: expected"},
        {"cib.command", "{\"drive\": \"A\", \"command\": 101, \"p2\": -1}", "p2: expected"},
        {"cib.status", "{\"drive\": 1}", "drive: expected"},
        {"cib.do", "{\"outputs\": {\"9\": 1}}", "outputs: expected"},
        {"cib.do", "{\"outputs\": {\"1\": 2}}", "outputs: expected"},
        {"cib.pwm", "{\"output\": 1}", "duty: expected"},
        {"cib.pwm", "{\"output\": 9, \"duty\": 1}", "output: expected"},
        {"cib.config.put", "{}", "expected a configuration"},
        {"cib.config.put", "{\"setup\": {\"do1-2\": 3}}", "do1-2: expected an object"},
        {"cib.config.put", "{\"setup\": {\"do1-2\": {\"period\": -1}}}", "do1-2.period: wrong value"},
        {"cib.config.put", "{\"setup\": {\"do1-3\": {\"use\": \"do\"}}}", "do1-3.use: unknown entry"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        cib_bus_expect_refusal(&bus, wrong[i][0], wrong[i][1], wrong[i][2]);
}
END_TEST

START_TEST(a_configuration_that_is_put_is_a_proposal)
{
    json_t *result =
        cib_bus_command(&bus, "cib.config.put", "{\"setup\": {\"drive_a\": {\"mode\": 18}, \"pulse\": {\"pwm3\": 0}}}");
    json_t *mode = json_object_get(json_object_get(json_object_get(result, "proposal"), "drive_a"), "mode");
    ck_assert_int_eq(json_integer_value(mode), 18);
    json_decref(result);
    cib_bus_expect_checked(&bus, "01 03 01 0B 00 01", "01 03 02 00 FB");
    cib_bus_expect_checked(&bus, "01 04 01 10 00 01", "01 04 02 00 14");
    result = cib_bus_command(&bus, "cib.apply", "{}");
    ck_assert_int_eq(json_integer_value(json_object_get(result, "result")), 0x110);
    ck_assert_str_eq(json_string_value(json_object_get(result, "wrong")), "drive_a.mode");
    json_decref(result);
}
END_TEST

START_TEST(settings_are_the_same_after_a_recording)
{
    struct device_config config = {.node = 1}, again = {.node = 1};
    char error[DEVICE_ERROR_SIZE];
    static const char *const pairs[][2] = {{"firmware", "1.1"}, {"idle-off", "500"}, {"comm-timeout", "77"},
                                           {"brake-error", "-20"}, {"acc-unit", "100"}, {"silence", "5000"}};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++)
        ck_assert(device_option_named(&cib_device, pairs[i][0])->read(&config, pairs[i][1], error));
    json_t *head = json_object();
    cib_device.put_settings(&config, head);
    for (const char *const *name = cib_device.settings; *name; name++)
        ck_assert_msg(cib_device.read_setting(&again, *name, json_object_get(head, *name), error), "%s", error);
    json_decref(head);
    ck_assert_mem_eq(&config, &again, sizeof config);
    ck_assert_ptr_null(cib_device.unlike(&config, &again));
    ck_assert(device_option_named(&cib_device, "idle-off")->read(&again, "0", error));
    ck_assert_str_eq(cib_device.unlike(&config, &again), "idle_off");
}
END_TEST

static Suite *device_suite(void)
{
    Suite *suite = suite_create("cib_device");
    TCase *one = tcase_create("one module");
    tcase_add_checked_fixture(one, begin, end);
    tcase_add_test(one, a_trace_has_pulses_phases_and_status);
    tcase_add_test(one, a_trace_has_the_edges_of_pwm);
    tcase_add_test(one, a_trace_has_the_duties_of_pwm);
    tcase_add_test(one, the_plan_of_a_motion_leads_to_its_last_pulse);
    tcase_add_test(one, a_refused_command_is_a_fault_until_the_next_good_one);
    tcase_add_test(one, bt4_a_motor_follows_the_field_of_its_coils_in_every_mode);
    tcase_add_test(one, bt4_swapped_leads_turn_it_back_and_a_missing_one_keeps_it);
    tcase_add_test(one, a_check_value_can_be_made_wrong);
    tcase_add_test(one, power_is_lost_with_what_the_host_applied);
    tcase_add_test(one, a_snapshot_brings_everything_back);
    tcase_add_test(one, wrong_parameters_of_methods_are_refused);
    tcase_add_test(one, a_configuration_that_is_put_is_a_proposal);
    tcase_add_test(one, settings_are_the_same_after_a_recording);
    suite_add_tcase(suite, one);
    return suite;
}

int main(void)
{
    return rig_run(device_suite(), "./test_cib_device");
}
