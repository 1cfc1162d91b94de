/* SPDX-License-Identifier: MIT */
/* test_plant_coils.c: motors whose coils the CIB module drives (BT4): all modes, both drives, wrong wiring. */
#include <check.h>
#include <string.h>

#include "command/command.h"
#include "core/rig.h"
#include "sim/sim.h"

static struct sim sim;

static json_t *command(const char *method, const char *params)
{
    struct refusal refusal;
    json_t *json = json_loads(params, 0, NULL), *result = sim_command(&sim, method, json, &refusal);
    ck_assert_msg(result != NULL, "%s %s: %s", method, params, refusal.text);
    json_decref(json);
    return result;
}

/* Drive A, 1, or B, 2, of a module in a mode; motor 1 and 2 with these leads. */
static void begin(unsigned mode, const char *coils)
{
    struct sim_config config = {.device = device_kind_named("cib"), .timed = true, .seed = 1, .nodes = {.count = 1, .node = {1}}};
    char params[300];
    memset(&sim, 0, sizeof sim);
    ck_assert(sim_begin(&sim, &config));
    snprintf(params, sizeof params, "{\"setup\": {\"drive_a\": {\"mode\": %u}, \"drive_b\": {\"mode\": %u}}}", mode, mode);
    json_decref(command("cib.config.put", params));
    json_decref(command("cib.apply", "{}"));
    snprintf(params, sizeof params, "{\"plant\": {\"motors\": {\"1\": {\"coils\": %s}, \"2\": {\"coils\": %s}}}}", coils, coils);
    json_decref(command("plant.set", params));
}

static int64_t move_by(unsigned drive, int pulses)
{
    char params[120];
    int64_t position;
    snprintf(params, sizeof params, "{\"drive\": \"%s\", \"command\": 102, \"p1\": %d, \"p2\": 500}", drive == 1 ? "a" : "b",
             pulses);
    json_decref(command("cib.command", params));
    sim_advance(&sim, sim_now(&sim) + 2000000);
    ck_assert(plant_position(sim.unit[0].plant, drive, &position));
    return position;
}

static const unsigned modes[] = {16, 17, 20, 21, 32, 33};

START_TEST(motor_follows_its_drive_in_every_mode)
{
    begin(modes[_i], "[1, 2, 3, 4]");
    for (unsigned drive = 1; drive <= 2; drive++) {
        ck_assert_int_eq(move_by(drive, 101), 101);
        ck_assert_int_eq(move_by(drive, -150), -49);
        ck_assert_int_eq(sim_axis(&sim, 1, drive).position, -49);
    }
    sim_end(&sim);
}
END_TEST

/* The first pulse back shows the last row but one (BT3). */
START_TEST(first_pulse_back_turns_back)
{
    begin(modes[_i], "[1, 2, 3, 4]");
    ck_assert_int_eq(move_by(1, -3), -3);
    sim_end(&sim);
}
END_TEST

START_TEST(swapped_phase_turns_back_and_a_missing_one_does_not_turn)
{
    begin(modes[_i], "[3, 2, 1, 4]");
    ck_assert_int_eq(move_by(2, 100), -100);
    sim_end(&sim);
    begin(modes[_i], "[1, 0, 3, 4]");
    int64_t position = move_by(1, 400);
    ck_assert_msg(position >= -8 && position <= 8, "mode %u: the motor is at %d", modes[_i], (int)position);
    sim_end(&sim);
}
END_TEST

static Suite *plant_coils_suite(void)
{
    Suite *suite = suite_create("plant_coils");
    TCase *all = tcase_create("all");
    tcase_add_loop_test(all, motor_follows_its_drive_in_every_mode, 0, 6);
    tcase_add_loop_test(all, first_pulse_back_turns_back, 0, 6);
    tcase_add_loop_test(all, swapped_phase_turns_back_and_a_missing_one_does_not_turn, 0, 6);
    suite_add_tcase(suite, all);
    return suite;
}

int main(void)
{
    return rig_run(plant_coils_suite(), "./test_plant_coils");
}
